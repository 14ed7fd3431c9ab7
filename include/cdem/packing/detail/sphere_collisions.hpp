#pragma once

/// @file
/// The events of growing hard spheres: which comes next, and what it does.

#include <cdem/packing/detail/approach.hpp>
#include <cdem/packing/detail/collision_sums.hpp>
#include <cdem/packing/detail/event_calendar.hpp>
#include <cdem/packing/detail/near_neighbours.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace cdem::packing::detail {

/// A stretch of the spheres in their order, which follows space; beyond the last comes the first.
struct Zone {
  ParticleIndex first = 0, count = 0, all = 0;

  /// How many spheres come before it, counted from the zone's first.
  ParticleIndex place(ParticleIndex sphere) const {
    return sphere >= first ? sphere - first : sphere + (all - first);
  }
  bool holds(ParticleIndex sphere) const { return place(sphere) < count; }
};

/// One thread's work in a window of time.
struct alignas(128) Worker { // none shares a cache line with another
  // What has to be put back if the window is to be done again.
  struct SavedEvent {
    double next;
    ParticleIndex sphere, partner;
  };
  struct SavedPath {
    Vec3 origin, velocity;
    ParticleIndex sphere;
  };
  /// Alone: every event in the order of time. First: events whose surroundings are in the zone, the others are put
  /// off. Second: those that were put off, in a zone about the border of two of the first.
  enum class Turn : std::uint8_t { alone, first, second };

  Turn turn = Turn::alone;
  std::size_t lane = 0; ///< of the calendar
  Zone zone;
  /// First turn: nothing waits from the one place of the zone to before the other.
  ParticleIndex free_begin = 0, free_end = 0;
  /// First turn: an event between these places needs no note. Second turn: there all that happened was noted.
  ParticleIndex inner_begin = 0, inner_end = 0;
  bool noted = false;                 ///< whether the event in hand needs a note for the second turn
  double now = 0, end = 0;            ///< time of the event in hand; end of the window
  double per_window = 0;              ///< 1 / length of the window
  std::vector<Appointment> due;       ///< appointments of the window, sorted
  std::vector<Appointment> sudden;    ///< the same that were made within it: a heap
  std::vector<Appointment> put_off;   ///< left to the second turn
  std::vector<ParticleIndex> waiting; ///< spheres put off, and their neighbours
  std::vector<ParticleIndex> leaving; ///< spheres that reach their shell in this window
  std::vector<SavedEvent> saved_events;
  std::vector<SavedPath> saved_paths;
  std::vector<double> times;        ///< scratch of predictions
  std::vector<Appointment> scratch; ///< of sorting
  std::vector<std::uint32_t> ends;  ///< of sorting
  WindowSums sums;
  bool conflict = false; ///< the window has to be done again by one thread
};

/// Hard spheres of equal mass in the unit cube, radius_i(t) = size_i * scale(t), and their next events.
///
/// A sphere knows its next event alone: a collision, the moment it reaches its shell (its list is renewed), or a
/// second look, when the partner of its collision has had another before. Every own event brings a sphere to its time.
class SphereCollisions {
public:
  // Partners that are no spheres.
  static constexpr ParticleIndex second_look = no_sphere;
  static constexpr ParticleIndex own_shell = no_sphere - 1;
  static constexpr ParticleIndex first_wall = no_sphere - 8; ///< plus 2 axis, plus 1 for the upper wall

  static constexpr bool is_sphere(ParticleIndex partner) { return partner < first_wall; }

  SphereCollisions(std::size_t spheres, bool periodic)
      : bodies(spheres), partners(spheres, second_look), neighbours(spheres, periodic),
        near_walls_(periodic ? 0 : spheres, 0), periodic_(periodic) {}

  Event event_of(ParticleIndex i) const { return {bodies[i].next, partners[i]}; }
  void set_event(ParticleIndex i, const Event& event) {
    bodies[i].next = event.time;
    partners[i] = event.partner;
  }

  double scale_at(double time) const { return scale + growth * time; }

  /// Handles an appointment at its time, unless it is out of date. A collision of two spheres is handled at the
  /// appointment of either.
  void handle(Worker& w, const Appointment& appointment) {
    const ParticleIndex i = appointment.sphere;
    if (bodies[i].next != appointment.time)
      return;
    w.now = std::max(w.now, appointment.time);
    w.noted = false;
    if (w.turn == Worker::Turn::first && !may_be_first(w, i))
      return put_off(w, appointment);
    ParticleIndex partner = partners[i];
    if (is_sphere(partner)) {
      if (w.turn != Worker::Turn::alone && !w.zone.holds(partner)) // a former neighbour
        return w.turn == Worker::Turn::first ? put_off(w, appointment) : void(w.conflict = true);
      if (bodies[partner].next != appointment.time || partners[partner] != i) {
        if (w.turn == Worker::Turn::first)
          note(w, partner);
        partner = second_look;
      } else if (w.turn == Worker::Turn::first && !may_be_first(w, partner))
        return put_off(w, appointment);
    }
    if (w.turn != Worker::Turn::alone && !prepare(w, i, partner))
      return;
    ++w.sums.events;
    set_event(i, {});
    if (is_sphere(partner)) {
      set_event(partner, {});
      collide(w, bodies[i], bodies[partner]);
      predict(w, i);
      predict(w, partner);
      return;
    }
    if (partner == own_shell)
      neighbours.renew(i, new_shell(i, w.now));
    else if (partner != second_look)
      bounce(w, bodies[i], partner - first_wall);
    predict(w, i);
  }

  /// Gives a sphere a new list of neighbours, and a new event.
  void renew(Worker& w, ParticleIndex i) {
    set_event(i, {});
    neighbours.renew(i, new_shell(i, w.now));
    predict(w, i);
  }

  /// A sphere's next event, if those of the others are as they are; the sphere is at time `now`.
  Event next_event(ParticleIndex i, double now, std::vector<double>& times) const {
    return find_next(i, now, times);
  }

  /// The room in which a sphere may move from `now` on; its centre is brought back into the cube.
  Shell new_shell(ParticleIndex i, double now) {
    Body& body = bodies[i];
    Vec3 centre = body.centre_at(now);
    if (periodic_)
      for (int k = 0; k < 3; ++k) {
        const double periods = std::floor(centre[k]);
        centre[k] -= periods;
        body.origin[k] -= periods;
      }
    const Shell shell{centre, body.size * scale_at(now) + skin};
    if (!periodic_)
      note_walls(i, shell);
    return shell;
  }

  void note_walls(ParticleIndex i, const Shell& shell) {
    std::uint8_t walls = 0;
    for (int k = 0; k < 3; ++k)
      walls = static_cast<std::uint8_t>(walls | (shell.centre[k] < shell.radius) << 2 * k |
                                        (1 - shell.centre[k] < shell.radius) << (2 * k + 1));
    near_walls_[i] = walls;
  }

  /// Asks for the memory that the appointments after the k-th are going to read: in steps, since each place is known
  /// from what was read at another.
  /// @param k  from -reach on, so that the first appointments are asked for as well
  [[gnu::always_inline]] void fetch_ahead(const std::vector<Appointment>& appointments,
                                          std::ptrdiff_t k) const {
    const auto count = static_cast<std::ptrdiff_t>(appointments.size());
    const auto has = [&](std::ptrdiff_t place) { return place >= 0 && place < count; };
    const auto sphere = [&](std::ptrdiff_t place) {
      return appointments[static_cast<std::size_t>(place)].sphere;
    };
    if (has(k + reach)) {
      const ParticleIndex i = sphere(k + reach);
      __builtin_prefetch(&partners[i], 1);
      __builtin_prefetch(&bodies[i], 1);
      neighbours.fetch(i);
    }
    if (has(k + 16)) {
      const ParticleIndex i = sphere(k + 16);
      neighbours.fetch_long(i);
      if (const ParticleIndex j = partners[i]; is_sphere(j) && j > i)
        neighbours.fetch(j);
    }
    if (has(k + 10)) {
      const ParticleIndex i = sphere(k + 10), j = partners[i];
      if (!is_sphere(j) || j > i) { // else the partner's appointment does it
        fetch_surroundings(i);
        if (is_sphere(j))
          neighbours.fetch_long(j);
      }
    }
    if (has(k + 6)) {
      const ParticleIndex i = sphere(k + 6), j = partners[i];
      if (is_sphere(j) && j > i)
        fetch_surroundings(j);
    }
  }

  static constexpr std::ptrdiff_t reach = 24; ///< of fetch_ahead()

  SphereArray<Body> bodies;
  SphereArray<ParticleIndex> partners; ///< of the next events
  NearNeighbours neighbours;
  EventCalendar calendar;
  double scale = 0, growth = 0; ///< mean diameter at time 0, and its rate
  double skin = 0;              ///< room in a new shell
  /// [spheres] last time at which a first turn wrote or weighed a sphere's event; empty with one thread
  SphereArray<double> touched;
  SphereArray<std::uint8_t> waiting; ///< [spheres] whether a sphere or a neighbour was put off in this window

private:
  [[gnu::always_inline]] void fetch_surroundings(ParticleIndex i) const {
    for (const ParticleIndex j : neighbours.of(i))
      __builtin_prefetch(&bodies[j], 1);
  }

  /// Whether all that an event of the sphere reads and writes is in the zone and waits for nothing.
  bool may_be_first(Worker& w, ParticleIndex i) const {
    const std::span<const ParticleIndex> list = neighbours.of(i);
    const auto are_between = [&](ParticleIndex begin, ParticleIndex end) { // places of the zone
      begin += w.zone.first;
      end += w.zone.first;
      ParticleIndex furthest = i - begin;
      for (const ParticleIndex j : list)
        furthest = std::max(furthest, j - begin);
      return begin < end && furthest < end - begin;
    };
    // Far from the borders, as nearly all are, there is nothing more to read.
    if (are_between(std::max(w.inner_begin, w.free_begin), std::min(w.inner_end, w.free_end)))
      return true;
    w.noted = true;
    if (are_between(w.free_begin, w.free_end))
      return true;
    return are_between(0, w.zone.count) &&
           std::none_of(list.begin(), list.end(), [&](ParticleIndex j) { return waiting[j] != 0; });
  }

  void put_off(Worker& w, const Appointment& appointment) {
    w.put_off.push_back(appointment);
    wait(w, appointment.sphere);
    for (const ParticleIndex j : neighbours.of(appointment.sphere))
      if (w.zone.holds(j))
        wait(w, j);
  }

  void wait(Worker& w, ParticleIndex i) {
    if (std::exchange(waiting[i], std::uint8_t{1}) != 0)
      return;
    w.waiting.push_back(i);
    const ParticleIndex place = w.zone.place(i);
    if (place < w.zone.count / 2)
      w.free_begin = std::max(w.free_begin, place + 1);
    else
      w.free_end = std::min(w.free_end, place);
  }

  /// Notes for the second turn that a sphere's event was written or weighed now.
  void note(const Worker& w, ParticleIndex i) {
    const ParticleIndex place = w.zone.place(i);
    if (place < w.inner_begin || place >= w.inner_end)
      touched[i] = w.now;
  }

  /// Saves what the event is going to change. @return false, and a conflict, if the event cannot be handled here
  bool prepare(Worker& w, ParticleIndex i, ParticleIndex partner) {
    const bool second = w.turn == Worker::Turn::second;
    if (partner == own_shell || (second && !may_be_second(w, i)) ||
        (second && is_sphere(partner) && !may_be_second(w, partner))) {
      w.conflict = true;
      return false;
    }
    save(w, i, true);
    if (is_sphere(partner))
      save(w, partner, true);
    return true;
  }

  /// Whether the surroundings are in the zone and have done nothing in the first turn that was later than now.
  bool may_be_second(const Worker& w, ParticleIndex i) const {
    const auto untouched = [&](ParticleIndex j) {
      const ParticleIndex place = w.zone.place(j);
      return place >= w.inner_begin && place < w.inner_end && touched[j] < w.now;
    };
    const std::span<const ParticleIndex> list = neighbours.of(i);
    return untouched(i) && std::all_of(list.begin(), list.end(), untouched);
  }

  /// @param moves  whether the sphere's path will change too
  void save(Worker& w, ParticleIndex i, bool moves) {
    w.saved_events.push_back({bodies[i].next, i, partners[i]});
    if (moves)
      w.saved_paths.push_back({bodies[i].origin, bodies[i].velocity, i});
    if (w.turn == Worker::Turn::first)
      note(w, i);
  }

  /// Two spheres of equal mass: the relative normal velocity v_n becomes 2 G - v_n.
  void collide(Worker& w, Body& a, Body& b) const {
    Vec3 normal = b.centre_at(w.now) - a.centre_at(w.now);
    if (periodic_)
      normal = nearest_image(normal);
    normal /= std::sqrt(normal.squaredNorm());
    const double size = a.size + b.size;
    const double parting = size * growth;
    const double momentum = std::max(parting - normal.dot(b.velocity - a.velocity), 0.0);
    a.push(-momentum * normal, w.now);
    b.push(momentum * normal, w.now);
    account(w, momentum, size, parting);
  }

  void bounce(Worker& w, Body& body, ParticleIndex wall) const {
    const int axis = static_cast<int>(wall / 2);
    const double inward = wall % 2 == 0 ? 1 : -1;
    const double parting = body.size * growth;
    const double momentum = std::max(2 * (parting - inward * body.velocity[axis]), 0.0);
    Vec3 change = Vec3::Zero();
    change[axis] = inward * momentum;
    body.push(change, w.now);
    account(w, momentum, body.size, parting);
  }

  void account(Worker& w, double momentum, double size, double parting) const {
    const double work = momentum * parting; // of the growing surfaces
    ++w.sums.collisions;
    w.sums.virial.add(momentum * size * (scale_at(w.now) / scale));
    w.sums.work.add(work);
    w.sums.heat.add(work * std::max((w.end - w.now) * w.per_window, 0.0));
  }

  Event find_next(ParticleIndex i, double now, std::vector<double>& times) const {
    const Body& a = bodies[i];
    const Vec3 centre = a.centre_at(now);
    Event best = event_of(i);
    const std::span<const ParticleIndex> list = neighbours.of(i);
    if (times.size() < list.size() + 4)
      times.resize(2 * list.size() + 16);
    const Present present{now, scale_at(now), growth, periodic_};
    if (!list.empty()) {
      const Soonest soonest = contact_times(bodies.data(), list, a, centre, present, times.data());
      if (now + soonest.time < best.time)
        best = {now + soonest.time, list[soonest.place]};
    }
    if (!periodic_ && near_walls_[i])
      for (ParticleIndex wall = 0; wall < 6; ++wall)
        if (near_walls_[i] >> wall & 1)
          if (const double time = now + time_to_wall(a, centre, wall, present.scale); time < best.time)
            best = {time, first_wall + wall};
    const Shell& shell = neighbours.shell(i);
    const Vec3 y = centre - shell.centre;
    const double room = shell.radius - a.size * present.scale;
    const double shrinking = a.size * growth;
    if (!stays_inside(y, a.velocity, room, shrinking, best.time - now))
      if (const double time = now + time_to_shell(y, a.velocity, room, shrinking); time < best.time)
        best = {time, own_shell};
    return best;
  }

  /// Finds a sphere's next event and takes a partner away from its former one.
  void predict(Worker& w, ParticleIndex i) {
    const Event next = find_next(i, w.now, w.times);
    if (w.noted) {
      const std::span<const ParticleIndex> list = neighbours.of(i);
      for (std::size_t k = 0; k < list.size(); ++k)
        if (w.now + w.times[k] <= next.time) // whose events were weighed
          note(w, list[k]);
    }
    if (!(next.time < bodies[i].next))
      return;
    schedule(w, i, next);
    if (is_sphere(next.partner)) {
      if (w.turn != Worker::Turn::alone)
        save(w, next.partner, false);
      schedule(w, next.partner, {next.time, i});
    }
  }

  void schedule(Worker& w, ParticleIndex i, const Event& event) {
    set_event(i, event);
    if (event.time < w.end) {
      w.sudden.push_back({event.time, i});
      std::push_heap(w.sudden.begin(), w.sudden.end(), later);
    } else
      calendar.add_later(w.lane, {event.time, i});
  }

public:
  static bool later(const Appointment& a, const Appointment& b) { return b < a; }

private:
  /// Whether the sphere is inside its shell after `time`; then it has been all along, since a cone is convex.
  static bool stays_inside(const Vec3& y, const Vec3& v, double room, double shrinking, double time) {
    const double left = room - shrinking * time;
    return left > 0 && (y + v * time).squaredNorm() < left * left;
  }

  double time_to_wall(const Body& body, const Vec3& centre, ParticleIndex wall, double scale_now) const {
    const int axis = static_cast<int>(wall / 2);
    const double distance = wall % 2 == 0 ? centre[axis] : 1 - centre[axis];
    const double speed = wall % 2 == 0 ? body.velocity[axis] : -body.velocity[axis];
    const double approach = body.size * growth - speed;
    return approach > 0 ? std::max(distance - body.size * scale_now, 0.0) / approach : never;
  }

  /// [spheres] bit 2 axis (+ 1: upper) of each wall inside the shell; walled only
  std::vector<std::uint8_t> near_walls_;
  bool periodic_;
};

} // namespace cdem::packing::detail
