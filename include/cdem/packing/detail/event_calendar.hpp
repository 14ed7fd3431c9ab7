#pragma once

/// @file
/// Events of an event-driven simulation, kept by the day on which they fall.

#include <cdem/packing/detail/sphere_state.hpp>

#include <algorithm>
#include <cstdint>
#include <utility>
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

/// Sorts appointments that are spread over [start, start + 1/rate): a few to a box each, then within the boxes.
/// @param scratch  memory of the last call        @complexity  linear, unless nearly all fall together
inline void sort_by_time(std::vector<Appointment>& appointments, double start, double rate,
                         std::vector<Appointment>& scratch, std::vector<std::uint32_t>& ends) {
  const std::size_t count = appointments.size(), boxes = count / 2;
  if (count < 48 || !(rate > 0))
    return std::sort(appointments.begin(), appointments.end());
  const double boxes_per_time = rate * static_cast<double>(boxes), last = static_cast<double>(boxes - 1);
  const auto box_of = [&](const Appointment& a) {
    return static_cast<std::uint32_t>(std::clamp((a.time - start) * boxes_per_time, 0.0, last));
  };
  ends.assign(boxes + 1, 0);
  for (const Appointment& a : appointments)
    ++ends[box_of(a) + 1];
  for (std::size_t box = 0; box < boxes; ++box)
    ends[box + 1] += ends[box];
  scratch.resize(count);
  for (const Appointment& a : appointments)
    scratch[ends[box_of(a)]++] = a;
  appointments.swap(scratch);
  for (std::size_t box = 0, first = 0; box < boxes; first = ends[box++])
    if (ends[box] - first > 1)
      std::sort(appointments.begin() + static_cast<std::ptrdiff_t>(first),
                appointments.begin() + static_cast<std::ptrdiff_t>(ends[box]));
}

/// Spheres sorted by the time of their next event into days of equal length (a calendar queue, Brown 1988). Nothing is
/// taken out when an event changes: the sphere is entered at its new day too, and when the old one comes, its time
/// tells that it is not due. So nothing is read to write, and a day is read from one end to the other.
///
/// The calendar has several lanes, one for each thread that writes. Its days are used again once they have passed; what
/// is further than a year ahead stands aside and is looked through twice a year.
/// @complexity  constant time per add(); about four entries of 4 bytes a sphere
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
      for (auto& spheres_of_day : lane.days)
        spheres_of_day.clear();
      lane.far.clear();
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

  /// Today's spheres in a lane. Those whose event has changed are not due, and one may be there twice.
  const std::vector<ParticleIndex>& today_of(std::size_t lane) const {
    return lanes_[lane].days[today_ & (days_ - 1)];
  }

  /// Goes on to the next day. Today's spheres are taken out.
  void next_day() {
    for (Lane& lane : lanes_)
      lane.days[today_ & (days_ - 1)].clear();
    ++today_;
    if ((today_ & (days_ / 2 - 1)) != 0)
      return;
    for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
      std::vector<Appointment> far;
      far.swap(lanes_[lane].far);
      for (const Appointment& appointment : far)
        enter(lane, appointment, today_);
    }
  }

private:
  struct alignas(64) Lane {
    std::vector<std::vector<ParticleIndex>> days;
    std::vector<Appointment> far; ///< a year ahead, or more
  };

  void enter(std::size_t lane, const Appointment& appointment, std::uint64_t first) {
    if (!(appointment.time < never))
      return;
    const double day = std::min(appointment.time * days_per_time_, 0x1p52);
    auto number = static_cast<std::uint64_t>(day);
    if (appointment.time >= day_ * static_cast<double>(number + 1)) // by a rounding
      ++number;
    number = std::max(number, first);
    if (number < today_ + days_)
      lanes_[lane].days[number & (days_ - 1)].push_back(appointment.sphere);
    else
      lanes_[lane].far.push_back(appointment);
  }

  std::vector<Lane> lanes_;
  std::size_t days_ = 0; ///< of a year, a power of two
  double day_ = 1, days_per_time_ = 1;
  std::uint64_t today_ = 0;
};

} // namespace cdem::packing::detail
