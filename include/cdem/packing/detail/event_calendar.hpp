#pragma once

/// @file
/// Events of an event-driven simulation, kept by the day on which they fall.

#include <cdem/packing/detail/sphere_state.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace cdem::packing::detail {

/// When a sphere asked to be looked at. Out of date, and to be passed over, if its event has changed since.
struct Appointment {
  double time;
  ParticleIndex sphere;

  /// The order in which events are handled.
  friend bool operator<(const Appointment& a, const Appointment& b) {
    return a.time < b.time || (a.time == b.time && a.sphere < b.sphere);
  }
};

/// Appointments sorted by time into days of equal length (a calendar queue, Brown 1988). Nothing is taken out when an
/// event changes: a new appointment is written at the end of its day, and the old one is found out of date when its
/// day comes. So nothing is read to write, and a day is read from one end to the other.
///
/// The calendar has several lanes, one for each thread that writes. Days of later years lie among those of this year.
/// @complexity  constant time per add(); about four appointments of 16 bytes a sphere
class EventCalendar {
public:
  /// Starts without appointments. A year is long enough for nearly all events to fall into it.
  /// @param day     length of a day        @param spheres_per_day  spheres that have an event in a day
  /// @param today   number of the first day
  void restart(std::size_t lanes, double day, std::size_t spheres, std::size_t spheres_per_day,
               std::uint64_t today) {
    days_per_time_ = 1 / day;
    day_ = day;
    std::size_t days = 16;
    while (days * spheres_per_day < 4 * spheres)
      days *= 2;
    if (lanes_.size() != lanes || days != days_) {
      lanes_.clear();
      lanes_.resize(lanes);
    }
    days_ = days;
    for (Lane& lane : lanes_) {
      lane.days.resize(days);
      for (auto& appointments : lane.days)
        appointments.clear();
    }
    today_ = today;
  }

  std::size_t lanes() const noexcept { return lanes_.size(); }
  std::uint64_t today() const noexcept { return today_; }
  double start_of_today() const { return day_ * static_cast<double>(today_); }
  double end_of_today() const { return day_ * static_cast<double>(today_ + 1); }

  /// Enters an appointment after today.
  void add_later(std::size_t lane, const Appointment& appointment) { enter(lane, appointment, today_ + 1); }
  /// Enters an appointment today or later, between two days' work.
  void add(std::size_t lane, const Appointment& appointment) { enter(lane, appointment, today_); }

  /// Today's appointments in a lane, with some of later years.
  const std::vector<Appointment>& today_of(std::size_t lane) const {
    return lanes_[lane].days[today_ & (days_ - 1)];
  }

  /// Takes today's appointments out of a lane.
  void close_today(std::size_t lane) {
    auto& appointments = lanes_[lane].days[today_ & (days_ - 1)];
    const double end = end_of_today();
    std::erase_if(appointments, [end](const Appointment& a) { return a.time < end; });
  }
  void next_day() { ++today_; }

private:
  struct alignas(64) Lane {
    std::vector<std::vector<Appointment>> days;
  };

  void enter(std::size_t lane, const Appointment& appointment, std::uint64_t first) {
    if (!(appointment.time < never))
      return;
    const double day = std::min(appointment.time * days_per_time_, 0x1p52);
    auto number = static_cast<std::uint64_t>(day);
    if (appointment.time >= day_ * static_cast<double>(number + 1)) // by a rounding
      ++number;
    number = std::max(number, first);
    lanes_[lane].days[number & (days_ - 1)].push_back(appointment);
  }

  std::vector<Lane> lanes_;
  std::size_t days_ = 0; ///< of a year, a power of two
  double day_ = 1, days_per_time_ = 1;
  std::uint64_t today_ = 0;
};

} // namespace cdem::packing::detail
