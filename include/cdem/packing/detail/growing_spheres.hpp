#pragma once

/// @file
/// Event-driven dynamics of hard spheres whose radii grow.

#include <cdem/packing/detail/cell_grid.hpp>
#include <cdem/packing/detail/event_calendar.hpp>
#include <cdem/packing/detail/near_neighbours.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace cdem::packing::detail {

/// How two growing spheres near each other: after the time t their centres' distance squared less the sum of their
/// radii squared is a t^2 + 2 b t + c.
struct Approach {
  double a, b, c;

  /// @param d  from one centre to the other      @param w  rate of d
  /// @param S  sum of the radii                  @param G  rate of S, not negative
  Approach(const Vec3& d, const Vec3& w, double S, double G)
      : a(w.squaredNorm() - G * G), b(d.dot(w) - S * G), c(d.squaredNorm() - S * S) {}

  /// Time until they touch, the smallest root t >= 0 at which the surfaces approach, written without cancellation;
  /// infinity if there is none.
  ///
  /// Spheres that touch or overlap by rounding (c <= 0) collide at once if they approach (b < 0), and are let go if
  /// they part.
  double time_to_contact() const {
    const double discriminant = b * b - a * c;
    const double root = std::sqrt(std::max(discriminant, 0.0));
    if (b < 0) {
      const double time = std::max(c, 0.0) / (root - b);
      return discriminant >= 0 || c <= 0 ? time : EventCalendar::never;
    }
    // The surfaces part; they meet again only if growth outruns them.
    return a < 0 ? (b + root) / -a : EventCalendar::never;
  }
};

/// Time until a growing sphere reaches its shell from inside; infinity if it never does.
///
/// Smallest t > 0 at which |y + v t| = room - g t.
/// @param y     from the shell's centre to the sphere's     @param v  rate of y
/// @param room  the shell's radius minus the sphere's       @param g  rate of the sphere's radius, not negative
inline double time_to_shell(const Vec3& y, const Vec3& v, double room, double g) {
  const double a = v.squaredNorm() - g * g;
  const double b = y.dot(v) + room * g;
  const double c = y.squaredNorm() - room * room;
  if (c >= 0 || room <= 0)
    return 0;
  const double root = std::sqrt(std::max(b * b - a * c, 0.0));
  if (b > 0)
    return -c / (b + root);
  return a > 0 ? (root - b) / a : EventCalendar::never;
}

/// Sums over the collisions of a period, from which its pressure follows.
struct CollisionSums {
  std::uint64_t events = 0;     ///< collisions, renewals of lists and second looks
  std::uint64_t collisions = 0; ///< with spheres and walls
  double duration = 0;
  double virial = 0; ///< sum of exchanged momentum times distance of contact
  double action = 0; ///< integral of the kinetic energy over time

  /// Reduced pressure PV/(NkT) = 1 + virial/(2 integral of E_kin dt), the virial theorem with NkT = 2 E_kin/3; each
  /// exchange of momentum J counts J times the distance between the centres, or J times the radius at a wall.
  /// Infinity if no time has passed.
  double reduced_pressure() const { return 1 + virial / (2 * action); }

  friend CollisionSums operator+(CollisionSums a, const CollisionSums& b) {
    a.events += b.events;
    a.collisions += b.collisions;
    a.duration += b.duration;
    a.virial += b.virial;
    a.action += b.action;
    return a;
  }
};

/// Notices that time has come to a standstill: rounding near contact can make a few spheres collide again and again
/// without time passing.
///
/// A cycle has a fixed number of events, and the time it takes shrinks slowly. One that takes less than a thousandth of
/// the last sound cycle's time hesitates (the caller shrinks the radii by a rounding or two and tries again); after
/// twenty in a row the system is stalled.
class StallWatch {
public:
  enum class Verdict : std::uint8_t { advances, hesitates, stalled };

  /// @param duration  time that passed in the cycle
  Verdict judge(double duration) {
    if (duration > 1e-3 * sound_duration_) {
      sound_duration_ = duration;
      hesitations_ = 0;
      return Verdict::advances;
    }
    return ++hesitations_ < 20 ? Verdict::hesitates : Verdict::stalled;
  }

private:
  double sound_duration_ = 0;
  int hesitations_ = 0;
};

/// Hard spheres of equal mass in the unit cube, radius_i(t) = size_i * scale(t), scale growing linearly in time.
///
/// Each sphere has a local time: an event moves only the spheres it concerns (Lubachevsky 1991). A sphere knows its
/// next event alone: a collision, the moment it reaches its shell (its list is renewed), or a second look, when the
/// partner of its collision has been hit by another before. Time starts at 0 in every cycle, so that its resolution
/// follows the shrinking gaps.
///
/// Collisions are elastic in the frame of the moving surfaces: the approach v_n - G of a pair turns into its
/// opposite, so that spheres part faster than they grow and energy rises; begin_cycle() takes it out again.
class GrowingSpheres {
public:
  /// @param centres     in the unit cube, none closer than the sum of the radii
  /// @param sizes       radii at scale 1, mean 1/2: the scale is the mean diameter
  /// @param velocities  any unit; begin_cycle() scales them
  /// @param scale       to begin with
  GrowingSpheres(const std::vector<Vec3>& centres, const std::vector<double>& sizes,
                 const std::vector<Vec3>& velocities, double scale, bool periodic)
      : bodies_(centres.size()), neighbours_(centres.size(), periodic), calendar_(centres.size()),
        near_walls_(periodic ? 0 : centres.size(), 0), scale_(scale), periodic_(periodic) {
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      bodies_[i] = {centres[i], velocities[i], 0, sizes[i]};
  }

  std::size_t size() const noexcept { return bodies_.size(); }
  /// Mean diameter at the time of the last event.
  double scale() const noexcept { return scale_at(now_); }
  const CollisionSums& sums() const noexcept { return sums_; }

  /// Centre of a sphere; valid after synchronise().
  const Vec3& centre(std::size_t sphere) const { return bodies_[sphere].centre; }
  const Vec3& velocity(std::size_t sphere) const { return bodies_[sphere].velocity; }
  double radius(std::size_t sphere) const { return bodies_[sphere].size * scale(); }

  /// Sum of v.v/2 over the spheres.
  double kinetic_energy() const {
    return std::accumulate(bodies_.begin(), bodies_.end(), 0.0, [](double sum, const Body& body) {
      return sum + body.velocity.squaredNorm() / 2;
    });
  }

  /// Brings all spheres to the present and sets the clock to 0. run() cannot go on before the next begin_cycle().
  void synchronise() {
    for (Body& body : bodies_) {
      body.centre += body.velocity * (now_ - body.time);
      body.time = 0;
    }
    scale_ = scale_at(now_);
    now_ = 0;
  }

  /// Shrinks all radii by a relative amount, to get out of a place where rounding has the better of the dynamics.
  void shrink(double relative) { scale_ *= 1 - relative; }

  /// Starts anew from the synchronised state with sums at zero.
  /// @param growth  rate of the mean diameter; the velocities are scaled to a thermal speed sqrt(kT/m) of 1
  /// @param skin    room that a sphere is given in a new shell. All lists are rebuilt, and the spheres sorted by
  ///                place, when it is below three quarters of the last one
  /// @param interval  expected time between two events of the whole system
  void begin_cycle(double growth, double skin, double interval) {
    const double thermal = std::sqrt(2 * kinetic_energy() / (3 * static_cast<double>(size())));
    for (Body& body : bodies_)
      body.velocity /= thermal;
    growth_ = growth;
    energy_ = 1.5 * static_cast<double>(size());
    sums_ = {};
    if (skin < 0.75 * listed_skin_) {
      listed_skin_ = skin;
      skin_ = skin;
      sort_by_place();
      rebuild_lists();
    }
    skin_ = std::min(skin, listed_skin_);
    calendar_.restart(interval);
    for (ParticleIndex i = 0; i < size(); ++i)
      predict(i);
  }

  /// Handles up to `events` events.
  /// @param final_scale  stops at the moment when the mean diameter is this; no event after it is handled
  /// @return             whether that moment was reached
  bool run(std::uint64_t events, double final_scale) {
    const double end = growth_ > 0 ? std::max((final_scale - scale_) / growth_, 0.0) : EventCalendar::never;
    for (; events > 0; --events) {
      const ParticleIndex sphere = calendar_.earliest();
      const double time = calendar_.time(sphere);
      if (!(time < end)) {
        pass_time(end);
        return true;
      }
      pass_time(time);
      ++sums_.events;
      handle(sphere, calendar_.partner(sphere));
    }
    return false;
  }

private:
  /// What predictions read of a sphere: one cache line.
  struct alignas(64) Body {
    Vec3 centre; ///< at its local time
    Vec3 velocity;
    double time; ///< its local time
    double size; ///< radius at scale 1
  };

  // Partners that are no spheres.
  static constexpr ParticleIndex second_look = no_sphere;
  static constexpr ParticleIndex own_shell = no_sphere - 1;
  static constexpr ParticleIndex first_wall = no_sphere - 8; ///< plus 2 axis, plus 1 for the upper wall

  static constexpr bool is_sphere(ParticleIndex partner) { return partner < first_wall; }

  double scale_at(double time) const { return scale_ + growth_ * time; }

  void pass_time(double time) {
    // A time a rounding before the last one is the same time.
    const double step = std::max(time - now_, 0.0);
    sums_.duration += step;
    sums_.action += energy_ * step;
    now_ = std::max(time, now_);
  }

  void advance(Body& body) const {
    body.centre += body.velocity * (now_ - body.time);
    body.time = now_;
  }

  /// Asks for the memory that predict() is going to read, so that its delays overlap.
  void fetch_neighbours(ParticleIndex i) const {
    for (const ParticleIndex j : neighbours_.of(i))
      __builtin_prefetch(&bodies_[j]);
  }

  void handle(ParticleIndex i, ParticleIndex partner) {
    fetch_neighbours(i);
    if (is_sphere(partner))
      fetch_neighbours(partner);
    calendar_.schedule(i, EventCalendar::never, second_look);
    if (is_sphere(partner)) {
      calendar_.schedule(partner, EventCalendar::never, second_look);
      collide(bodies_[i], bodies_[partner]);
      predict(i);
      predict(partner);
      return;
    }
    if (partner == own_shell)
      renew(i);
    else if (partner != second_look)
      bounce(bodies_[i], partner - first_wall);
    predict(i);
  }

  /// Two spheres of equal mass: the relative normal velocity v_n becomes 2 G - v_n.
  void collide(Body& a, Body& b) {
    advance(a);
    advance(b);
    Vec3 normal = b.centre - a.centre;
    if (periodic_)
      normal = nearest_image(normal);
    normal.normalize();
    const double size = a.size + b.size;
    const double parting = size * growth_;
    const double momentum = std::max(parting - normal.dot(b.velocity - a.velocity), 0.0);
    a.velocity -= momentum * normal;
    b.velocity += momentum * normal;
    account(momentum, size * scale_at(now_), parting);
  }

  void bounce(Body& body, ParticleIndex wall) {
    advance(body);
    const int axis = static_cast<int>(wall / 2);
    const double inward = wall % 2 == 0 ? 1 : -1;
    const double parting = body.size * growth_;
    const double momentum = std::max(2 * (parting - inward * body.velocity[axis]), 0.0);
    body.velocity[axis] += inward * momentum;
    account(momentum, body.size * scale_at(now_), parting);
  }

  void account(double momentum, double distance, double parting) {
    ++sums_.collisions;
    sums_.virial += momentum * distance;
    energy_ += momentum * parting; // the work of the growing surfaces
  }

  Shell new_shell(ParticleIndex i) {
    Body& body = bodies_[i];
    if (periodic_)
      for (int k = 0; k < 3; ++k)
        body.centre[k] -= std::floor(body.centre[k]);
    const Shell shell{body.centre, body.size * scale_at(now_) + skin_};
    if (!periodic_) {
      std::uint8_t walls = 0;
      for (int k = 0; k < 3; ++k)
        walls = static_cast<std::uint8_t>(walls | (shell.centre[k] < shell.radius) << 2 * k |
                                          (1 - shell.centre[k] < shell.radius) << (2 * k + 1));
      near_walls_[i] = walls;
    }
    return shell;
  }

  void renew(ParticleIndex i) {
    advance(bodies_[i]);
    neighbours_.renew(i, new_shell(i));
  }

  void rebuild_lists() {
    std::vector<Shell> shells(size());
    for (ParticleIndex i = 0; i < size(); ++i)
      shells[i] = new_shell(i);
    neighbours_.rebuild(std::move(shells));
  }

  /// Spheres that are near in space become near in memory.
  void sort_by_place() {
    std::vector<std::pair<std::size_t, ParticleIndex>> places(size());
    for (ParticleIndex i = 0; i < size(); ++i) {
      Vec3 centre = bodies_[i].centre;
      if (periodic_)
        for (int k = 0; k < 3; ++k)
          centre[k] -= std::floor(centre[k]);
      places[i] = {neighbours_.grid().cell_of(centre), i};
    }
    std::sort(places.begin(), places.end());
    std::vector<Body> sorted(size());
    for (std::size_t i = 0; i < size(); ++i)
      sorted[i] = bodies_[places[i].second];
    bodies_.swap(sorted);
  }

  /// Finds a sphere's next event and takes a partner away from its former one.
  void predict(ParticleIndex i) {
    const Body& a = bodies_[i];
    const Vec3 centre = a.centre + a.velocity * (now_ - a.time);
    const double scale = scale_at(now_);
    double best = calendar_.time(i);
    ParticleIndex partner = second_look;

    // In two passes without branches to guess: half of the neighbours part, but which half cannot be foreseen.
    const std::span<const ParticleIndex> neighbours = neighbours_.of(i);
    if (nearing_.size() < neighbours.size())
      nearing_.resize(neighbours.size(), {{Vec3::Zero(), Vec3::Zero(), 0, 0}, no_sphere});
    std::size_t count = 0;
    for (const ParticleIndex j : neighbours) {
      const Body& b = bodies_[j];
      const Vec3 w = b.velocity - a.velocity;
      const Vec3 apart = b.centre + b.velocity * (now_ - b.time) - centre;
      const Vec3 d = periodic_ ? nearest_image(apart) : apart;
      const double size = a.size + b.size;
      // Written in place: a copy of values just stored one by one would have to wait for them.
      nearing_[count].sphere = j;
      Approach& approach = nearing_[count].approach;
      approach = Approach(d, w, size * scale, size * growth_);
      count += static_cast<std::size_t>((approach.b < 0) | (approach.a < 0));
    }
    for (std::size_t k = 0; k < count; ++k) {
      const double time = now_ + nearing_[k].approach.time_to_contact();
      if (time < best && time < calendar_.time(nearing_[k].sphere)) {
        best = time;
        partner = nearing_[k].sphere;
      }
    }
    if (!periodic_ && near_walls_[i])
      for (ParticleIndex wall = 0; wall < 6; ++wall)
        if (near_walls_[i] >> wall & 1) {
          const double time = now_ + time_to_wall(a, centre, wall, scale);
          if (time < best) {
            best = time;
            partner = first_wall + wall;
          }
        }
    const Shell& shell = neighbours_.shell(i);
    const Vec3 y = centre - shell.centre;
    const double room = shell.radius - a.size * scale;
    const double shrinking = a.size * growth_;
    if (!stays_inside(y, a.velocity, room, shrinking, best - now_)) {
      const double time = now_ + time_to_shell(y, a.velocity, room, shrinking);
      if (time < best) {
        best = time;
        partner = own_shell;
      }
    }
    if (best < calendar_.time(i))
      agree(i, partner, best);
  }

  /// Whether the sphere is inside its shell after `time`; then it has been all along, since a cone is convex.
  static bool stays_inside(const Vec3& y, const Vec3& v, double room, double shrinking, double time) {
    const double left = room - shrinking * time;
    return left > 0 && (y + v * time).squaredNorm() < left * left;
  }

  double time_to_wall(const Body& body, const Vec3& centre, ParticleIndex wall, double scale) const {
    const int axis = static_cast<int>(wall / 2);
    const double distance = wall % 2 == 0 ? centre[axis] : 1 - centre[axis];
    const double speed = wall % 2 == 0 ? body.velocity[axis] : -body.velocity[axis];
    const double approach = body.size * growth_ - speed;
    return approach > 0 ? std::max(distance - body.size * scale, 0.0) / approach : EventCalendar::never;
  }

  /// Enters the event of a sphere, and of its partner if that is a sphere; who had counted on either looks again.
  void agree(ParticleIndex i, ParticleIndex partner, double time) {
    leave_alone(i);
    calendar_.schedule(i, time, partner);
    if (is_sphere(partner)) {
      leave_alone(partner);
      calendar_.schedule(partner, time, i);
    }
  }

  void leave_alone(ParticleIndex i) {
    const ParticleIndex former = calendar_.partner(i);
    if (is_sphere(former))
      calendar_.set_partner(former, second_look);
  }

  struct Nearing {
    Approach approach;
    ParticleIndex sphere;
  };

  std::vector<Body> bodies_;
  NearNeighbours neighbours_;
  EventCalendar calendar_;
  std::vector<std::uint8_t>
      near_walls_; ///< [spheres] bit 2 axis (+ 1: upper) of each wall inside the shell; walled only
  std::vector<Nearing> nearing_; ///< scratch of predict()
  CollisionSums sums_;
  double now_ = 0;
  double scale_;                              ///< at time 0
  double growth_ = 0;                         ///< of the scale
  double energy_ = 0;                         ///< kinetic, kept up to date
  double skin_ = 0;                           ///< room in a new shell
  double listed_skin_ = EventCalendar::never; ///< skin at the last rebuild
  bool periodic_;
};

} // namespace cdem::packing::detail
