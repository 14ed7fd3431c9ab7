#pragma once

/// @file
/// Priority queue of an event-driven simulation: one next event a sphere, found and changed in constant time.

#include <cdem/packing/detail/cell_grid.hpp>

#include <algorithm>
#include <limits>
#include <vector>

namespace cdem::packing::detail {

/// One event per sphere, sorted by time into days of equal length (a calendar queue, Brown 1988; Paul 2007).
///
/// A day holds about one event, so that the earliest is found by a look at one or two. Events beyond the last
/// day of the year wait in one more list and are sorted in when the year is over.
/// @complexity  constant time per schedule() and, on average, per earliest(); 32 bytes a sphere
class EventCalendar {
public:
  static constexpr double never = std::numeric_limits<double>::infinity();

  explicit EventCalendar(std::size_t spheres) : events_(spheres) {
    std::size_t days = 16;
    while (days < 2 * spheres)
      days *= 2;
    first_.assign(days + 1, no_sphere);
  }

  /// Starts at time 0 with every sphere's event at `never`.
  /// @param interval  expected time between two events of the whole system: the length of a day
  void restart(double interval) {
    days_per_time_ = 1 / interval;
    new_year_ = 0;
    today_ = 0;
    std::fill(first_.begin(), first_.end(), no_sphere);
    for (ParticleIndex sphere = 0; sphere < events_.size(); ++sphere) {
      events_[sphere].time = never;
      events_[sphere].partner = no_sphere;
      link(sphere);
    }
  }

  double time(ParticleIndex sphere) const { return events_[sphere].time; }
  ParticleIndex partner(ParticleIndex sphere) const { return events_[sphere].partner; }

  /// Changes a sphere's event and leaves its time.
  void set_partner(ParticleIndex sphere, ParticleIndex partner) { events_[sphere].partner = partner; }

  /// Replaces a sphere's event; the time is not before that of the last earliest().
  void schedule(ParticleIndex sphere, double time, ParticleIndex partner) {
    unlink(sphere);
    events_[sphere].time = time;
    events_[sphere].partner = partner;
    link(sphere);
  }

  /// Sphere of the earliest event, which stays in the calendar.
  ParticleIndex earliest() {
    for (;;) {
      for (; today_ < late(); ++today_)
        if (first_[today_] != no_sphere)
          return earliest_of(first_[today_]);
      const ParticleIndex sphere = earliest_of(first_[late()]);
      if (events_[sphere].time == never)
        return sphere;
      start_year(events_[sphere].time);
    }
  }

private:
  struct Event {
    double time;
    ParticleIndex partner;
    ParticleIndex next, previous; ///< others of its day
    std::uint32_t day;
  };

  std::uint32_t late() const { return static_cast<std::uint32_t>(first_.size() - 1); }

  std::uint32_t day_of(double time) const {
    const double day = (time - new_year_) * days_per_time_;
    if (!(day < static_cast<double>(late())))
      return late();
    return std::max(today_, static_cast<std::uint32_t>(std::max(day, 0.0)));
  }

  void link(ParticleIndex sphere) {
    Event& event = events_[sphere];
    event.day = day_of(event.time);
    ParticleIndex& first = first_[event.day];
    event.next = first;
    event.previous = no_sphere;
    if (first != no_sphere)
      events_[first].previous = sphere;
    first = sphere;
  }

  void unlink(ParticleIndex sphere) {
    const Event& event = events_[sphere];
    if (event.next != no_sphere)
      events_[event.next].previous = event.previous;
    if (event.previous != no_sphere)
      events_[event.previous].next = event.next;
    else
      first_[event.day] = event.next;
  }

  ParticleIndex earliest_of(ParticleIndex sphere) const {
    ParticleIndex best = sphere;
    for (sphere = events_[sphere].next; sphere != no_sphere; sphere = events_[sphere].next)
      if (events_[sphere].time < events_[best].time)
        best = sphere;
    return best;
  }

  void start_year(double time) {
    new_year_ = time;
    today_ = 0;
    ParticleIndex sphere = first_[late()];
    first_[late()] = no_sphere;
    while (sphere != no_sphere) {
      const ParticleIndex next = events_[sphere].next;
      link(sphere);
      sphere = next;
    }
  }

  std::vector<Event> events_;        ///< [spheres]
  std::vector<ParticleIndex> first_; ///< [days + 1] an event of the day; the last list holds the later years
  double days_per_time_ = 1;
  double new_year_ = 0; ///< time at which the first day begins
  std::uint32_t today_ = 0;
};

} // namespace cdem::packing::detail
