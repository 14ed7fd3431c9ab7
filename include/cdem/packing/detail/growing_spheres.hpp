#pragma once

/// @file
/// Event-driven dynamics of hard spheres whose radii grow, on one thread or several.

#include <cdem/core/parallel.hpp>
#include <cdem/packing/detail/sphere_collisions.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace cdem::packing::detail {

/// Hard spheres of equal mass in the unit cube, radius_i(t) = size_i * scale(t), scale growing linearly in time.
///
/// An event moves only the spheres it concerns (Lubachevsky 1991). Time starts at 0 in every cycle, so that its
/// resolution follows the shrinking gaps.
///
/// Collisions are elastic in the frame of the moving surfaces: the approach v_n - G of a pair turns into its
/// opposite, so that spheres part faster than they grow and energy rises; begin_cycle() takes it out again.
///
/// Events are handled window by window, a window being a day of the calendar in which a small part of the spheres has
/// an event. One thread handles them in the order of time. Several give the same bytes: each takes a zone of the cube
/// and handles the events whose surroundings lie in it; those nearer to a border, and what may follow from them, are
/// put off and handled after it in zones about the borders. An event that then finds a neighbour further in time than
/// itself has been overtaken: the window is put back and handled by one thread. So the order in which events are
/// handled is never one that could be told from the order of time.
class GrowingSpheres {
public:
  /// What lasts from window to window. The same state goes on to the same bytes.
  struct State {
    SphereArray<Body> bodies;
    SphereArray<ParticleIndex> partners;
    SphereArray<Shell> shells;
    CollisionSums sums;
    double scale = 0, growth = 0, energy = 0, skin = 0, listed_skin = never, window = 0;
    std::uint64_t today = 0;
  };

  /// @param centres     in the unit cube, none closer than the sum of the radii
  /// @param sizes       radii at scale 1, mean 1/2: the scale is the mean diameter
  /// @param velocities  any unit; begin_cycle() scales them
  /// @param scale       to begin with
  GrowingSpheres(const std::vector<Vec3>& centres, const std::vector<double>& sizes,
                 const std::vector<Vec3>& velocities, double scale, bool periodic)
      : spheres_(centres.size(), periodic), periodic_(periodic) {
    spheres_.scale = scale;
    for (std::size_t i = 0; i < size(); ++i)
      spheres_.bodies[i] = {centres[i], never, velocities[i], sizes[i]};
  }

  /// Goes on from a state.
  GrowingSpheres(State state, bool periodic, core::ThreadPool& pool)
      : spheres_(state.bodies.size(), periodic), sums_(state.sums), energy_(state.energy),
        listed_skin_(state.listed_skin), window_(state.window), periodic_(periodic) {
    spheres_.bodies = std::move(state.bodies);
    spheres_.partners = std::move(state.partners);
    spheres_.scale = state.scale;
    spheres_.growth = state.growth;
    spheres_.skin = state.skin;
    for (ParticleIndex i = 0; i < size() && !periodic; ++i)
      spheres_.note_walls(i, state.shells[i]);
    spheres_.neighbours.rebuild(std::move(state.shells));
    open_calendar(state.today, pool);
  }

  std::size_t size() const noexcept { return spheres_.bodies.size(); }
  /// Mean diameter at the time reached.
  double scale() const noexcept { return spheres_.scale_at(now_); }
  const CollisionSums& sums() const noexcept { return sums_; }
  /// Whether the last run() gave up because time did not pass. Only synchronise() may follow.
  bool stuck() const noexcept { return stuck_; }
  /// Windows of this cycle that were done again by one thread.
  std::uint64_t repeated_windows() const noexcept { return repeated_; }

  /// Centre of a sphere; valid after synchronise().
  const Vec3& centre(std::size_t sphere) const { return spheres_.bodies[sphere].origin; }
  const Vec3& velocity(std::size_t sphere) const { return spheres_.bodies[sphere].velocity; }
  double radius(std::size_t sphere) const { return spheres_.bodies[sphere].size * scale(); }

  /// Sum of v.v/2 over the spheres.
  double kinetic_energy() const {
    return std::accumulate(
        spheres_.bodies.begin(), spheres_.bodies.end(), 0.0,
        [](double sum, const Body& body) { return sum + body.velocity.squaredNorm() / 2; });
  }

  /// Brings all spheres to the present and sets the clock to 0. run() cannot go on before the next begin_cycle().
  void synchronise() {
    for (Body& body : spheres_.bodies)
      body.origin = body.centre_at(now_);
    spheres_.scale = spheres_.scale_at(now_);
    now_ = 0;
  }

  /// Shrinks all radii by a relative amount, to get out of a place where rounding has the better of the dynamics.
  void shrink(double relative) { spheres_.scale *= 1 - relative; }

  /// Starts anew from the synchronised state with sums at zero.
  /// @param growth  rate of the mean diameter; the velocities are scaled to a thermal speed sqrt(kT/m) of 1
  /// @param skin    room that a sphere is given in a new shell. All lists are rebuilt, and the spheres sorted by
  ///                place, when it is below three quarters of the last one
  /// @param interval  expected time between two events of the whole system
  void begin_cycle(double growth, double skin, double interval, core::ThreadPool& pool) {
    const double thermal = std::sqrt(2 * kinetic_energy() / (3 * static_cast<double>(size())));
    for (Body& body : spheres_.bodies)
      body.velocity /= thermal;
    spheres_.growth = growth;
    energy_ = 1.5 * static_cast<double>(size());
    sums_ = {};
    if (skin < 0.75 * listed_skin_) {
      listed_skin_ = skin;
      spheres_.skin = skin;
      sort_by_place();
      rebuild_lists();
    }
    spheres_.skin = std::min(skin, listed_skin_);
    for (ParticleIndex i = 0; i < size(); ++i)
      spheres_.set_event(i, {});
    SphereArray<Event> next(size());
    core::parallel_for(pool, size(), [&](std::size_t begin, std::size_t end) {
      std::vector<double> times;
      for (std::size_t i = begin; i < end; ++i)
        next[i] = spheres_.next_event(static_cast<ParticleIndex>(i), 0, times);
    });
    for (ParticleIndex i = 0; i < size(); ++i)
      spheres_.set_event(i, next[i]);
    window_ = interval * static_cast<double>(events_per_window());
    open_calendar(0, pool);
  }
  void begin_cycle(double growth, double skin, double interval) {
    core::ThreadPool alone;
    begin_cycle(growth, skin, interval, alone);
  }

  /// Handles whole windows until there were `events` events.
  /// @param final_scale  stops at the moment when the mean diameter is this; no event after it is handled
  /// @return             whether that moment was reached
  bool run(std::uint64_t events, double final_scale, core::ThreadPool& pool) {
    const double growth = spheres_.growth;
    const double final_time = growth > 0 ? std::max((final_scale - spheres_.scale) / growth, 0.0) : never;
    for (const std::uint64_t enough = sums_.events + events; sums_.events < enough && !stuck_;) {
      const double end = std::min(spheres_.calendar.end_of_today(), final_time);
      pass_window(end, pool);
      if (!stuck_ && end == final_time)
        return true;
    }
    return false;
  }
  bool run(std::uint64_t events, double final_scale) {
    core::ThreadPool alone;
    return run(events, final_scale, alone);
  }

  /// The state between two calls of run().
  State state() const {
    return {spheres_.bodies,
            spheres_.partners,
            spheres_.neighbours.shells(),
            sums_,
            spheres_.scale,
            spheres_.growth,
            energy_,
            spheres_.skin,
            listed_skin_,
            window_,
            spheres_.calendar.today()};
  }

private:
  /// Events in a window: enough to share out among threads, and few enough for an event seldom to follow from another
  /// in the same window.
  std::size_t events_per_window() const {
    return std::clamp<std::size_t>(static_cast<std::size_t>(std::sqrt(static_cast<double>(size()))), 8, 2048);
  }

  /// A zone is several spheres thick.
  std::size_t useful_threads(const core::ThreadPool& pool) const {
    const double thick = std::cbrt(static_cast<double>(size())) / 8;
    return std::clamp<std::size_t>(static_cast<std::size_t>(thick), 1, static_cast<std::size_t>(pool.size()));
  }

  /// Enters all the events, and cuts the spheres into zones. A zone has a lane of the calendar for its own spheres;
  /// further lanes are for what the second turn and one thread alone enter.
  void open_calendar(std::uint64_t today, core::ThreadPool& pool) {
    const std::size_t zones = useful_threads(pool);
    spheres_.calendar.restart(zones == 1 ? 1 : 2 * zones, window_, size(), 2 * events_per_window(), today);
    now_ = spheres_.calendar.start_of_today();
    stuck_ = false;
    repeated_ = 0;
    workers_.resize(zones);
    alone_.lane = zones == 1 ? 0 : zones;
    if (zones > 1) {
      spheres_.touched.assign(size(), -1.0);
      spheres_.waiting.assign(size(), 0);
      for (Worker& w : workers_)
        w.waiting.clear();
    }
    pool.for_each_block(zones, [&](std::size_t zone) {
      workers_[zone].lane = zone;
      for (std::size_t i = size() * zone / zones; i < size() * (zone + 1) / zones; ++i)
        spheres_.calendar.add(zone, {spheres_.bodies[i].next, static_cast<ParticleIndex>(i)});
    });
  }

  Zone zone_from(std::size_t first, std::size_t last) const {
    const std::size_t all = size();
    return {static_cast<ParticleIndex>(first % all), static_cast<ParticleIndex>(last - first),
            static_cast<ParticleIndex>(all)};
  }
  /// Spheres about a border whose first turn is noted: some layers, more than the second turn ever gets to.
  std::size_t noted_stretch() const {
    const double layer = std::pow(static_cast<double>(size()), 2.0 / 3);
    return std::min(static_cast<std::size_t>(6 * layer), size() / (2 * workers_.size()));
  }

  void set_first_zone(Worker& w) const {
    w.zone = zone_from(size() * w.lane / workers_.size(), size() * (w.lane + 1) / workers_.size());
    w.free_begin = 0;
    w.free_end = w.zone.count;
    const auto noted = static_cast<ParticleIndex>(noted_stretch());
    w.inner_begin = noted;
    w.inner_end = w.zone.count - noted;
  }

  /// Half a zone further on.
  void set_second_zone(Worker& w, std::size_t lane) const {
    const std::size_t half = size() / (2 * workers_.size());
    const std::size_t first = size() * lane / workers_.size() + half;
    const std::size_t border = size() * (lane + 1) / workers_.size();
    w.zone = zone_from(first, border + half);
    const auto noted = static_cast<ParticleIndex>(noted_stretch()),
               middle = static_cast<ParticleIndex>(border - first);
    w.inner_begin = middle - std::min(noted, middle);
    w.inner_end = std::min(middle + noted, w.zone.count);
  }

  void pass_window(double end, core::ThreadPool& pool) {
    open(alone_, Worker::Turn::alone, now_, end);
    alone_.sudden.clear();
    const std::size_t lanes = workers_.size();
    const bool shared = lanes > 1 && windows_alone_ == 0;
    if (windows_alone_ > 0)
      --windows_alone_;
    if (!shared)
      collect(alone_);
    else
      pool.for_each_block(lanes, [&](std::size_t lane) {
        open(workers_[lane], Worker::Turn::first, now_, end);
        set_first_zone(workers_[lane]);
        collect(workers_[lane]);
      });
    if (shared)
      for (const Worker& w : workers_)
        alone_.leaving.insert(alone_.leaving.end(), w.leaving.begin(), w.leaving.end());
    renew_leaving();
    if (!shared || !share(end, pool)) {
      if (shared)
        gather_due();
      sort_due(alone_);
      work_through(alone_);
    }
    close_window(end);
  }

  void open(Worker& w, Worker::Turn turn, double now, double end) {
    w.turn = turn;
    w.now = now;
    w.end = end;
    w.per_window = end > now ? 1 / (end - now) : 0;
    w.due.clear();
    w.leaving.clear();
    w.put_off.clear();
    for (const ParticleIndex i : w.waiting)
      spheres_.waiting[i] = 0;
    w.waiting.clear();
    w.saved_events.clear();
    w.saved_paths.clear();
    w.sums = {};
    w.conflict = false;
  }

  /// Takes today's spheres that are due: all of them, or those of the worker's zone. Its lane of the calendar has none
  /// of another zone.
  void collect(Worker& w) {
    if (w.turn == Worker::Turn::first)
      collect(w, w.lane, true);
    for (std::size_t lane = w.turn == Worker::Turn::first ? workers_.size() : 0;
         lane < spheres_.calendar.lanes(); ++lane)
      collect(w, lane, w.turn != Worker::Turn::first);
  }

  /// @param all  whether the zone does not matter
  void collect(Worker& w, std::size_t lane, bool all) {
    constexpr std::size_t ahead = 16;
    const std::vector<ParticleIndex>& today = spheres_.calendar.today_of(lane);
    for (std::size_t k = 0; k < today.size(); ++k) {
      if (k + ahead < today.size() && (all || w.zone.holds(today[k + ahead])))
        __builtin_prefetch(&spheres_.bodies[today[k + ahead]], 1);
      const ParticleIndex i = today[k];
      if (!(all || w.zone.holds(i)) || spheres_.bodies[i].next >= w.end)
        continue;
      if (spheres_.partners[i] == SphereCollisions::own_shell)
        w.leaving.push_back(i);
      else
        w.due.push_back({spheres_.bodies[i].next, i});
    }
  }

  /// Spheres that would reach their shells in this window get new ones at its start, in the order of their numbers.
  void renew_leaving() {
    if (alone_.leaving.empty())
      return;
    std::sort(alone_.leaving.begin(), alone_.leaving.end());
    alone_.leaving.erase(std::unique(alone_.leaving.begin(), alone_.leaving.end()), alone_.leaving.end());
    for (const ParticleIndex i : alone_.leaving) {
      ++alone_.sums.events;
      spheres_.renew(alone_, i);
    }
  }

  static void sort_due(Worker& w) { sort_by_time(w.due, w.now, w.per_window, w.scratch, w.ends); }

  void work_through(Worker& w) {
    const std::uint64_t many = 1000 + 64 * static_cast<std::uint64_t>(events_per_window());
    double looked = w.now;
    std::uint64_t next_look = many;
    for (std::ptrdiff_t k = -SphereCollisions::reach; k < 0; ++k)
      spheres_.fetch_ahead(w.due, k);
    for (std::size_t next = 0; !w.conflict;) {
      if (w.sums.events > next_look) {
        // Far more events than expected: does time pass at all? Threads leave that question to one of them.
        w.conflict = w.turn != Worker::Turn::alone || (w.now - looked) * w.per_window < 1e-6;
        looked = w.now;
        next_look = w.sums.events + many;
      } else if (!w.sudden.empty() && (next == w.due.size() || w.sudden.front() < w.due[next])) {
        const Appointment appointment = w.sudden.front();
        std::pop_heap(w.sudden.begin(), w.sudden.end(), SphereCollisions::later);
        w.sudden.pop_back();
        spheres_.handle(w, appointment);
      } else if (next < w.due.size()) {
        spheres_.fetch_ahead(w.due, static_cast<std::ptrdiff_t>(next));
        spheres_.handle(w, w.due[next++]);
      } else
        return;
    }
  }

  /// Lets the threads share the window. @return  whether that went well; if not, nothing has changed
  bool share(double end, core::ThreadPool& pool) {
    const std::size_t lanes = workers_.size();
    const auto in_conflict = [](const Worker& w) { return w.conflict; };
    pool.for_each_block(lanes, [&](std::size_t lane) {
      Worker& w = workers_[lane];
      w.sudden.clear();
      for (const Appointment& a : alone_.sudden)
        if (w.zone.holds(a.sphere))
          w.due.push_back(a);
      sort_due(w);
      work_through(w);
    });
    bool bad = std::any_of(workers_.begin(), workers_.end(), in_conflict);
    second_.resize(lanes);
    if (!bad)
      pool.for_each_block(lanes, [&](std::size_t lane) {
        Worker& w = second_[lane];
        open(w, Worker::Turn::second, now_, end);
        w.sudden.clear();
        w.lane = lanes + lane;
        set_second_zone(w, lane);
        for (const Worker& first : workers_)
          for (const Appointment& a : first.put_off)
            if (w.zone.holds(a.sphere))
              w.due.push_back(a);
        sort_due(w);
        work_through(w);
      });
    if (!bad && std::any_of(second_.begin(), second_.end(), in_conflict)) {
      put_back(second_);
      bad = true;
    }
    note_trouble(bad);
    if (bad) {
      put_back(workers_);
      return false;
    }
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      alone_.sums.add(workers_[lane].sums);
      alone_.sums.add(second_[lane].sums);
    }
    return true;
  }

  /// If more than a fifth of the windows had to be repeated, sharing does not pay: a fluid, or few spheres.
  void note_trouble(bool repeated) {
    repeated_ += repeated ? 1U : 0U;
    trouble_ = repeated ? trouble_ + 4 : std::max(trouble_ - 1, 0);
    if (trouble_ > 16) {
      trouble_ = 0;
      windows_alone_ = pause_;
      pause_ = std::min(2 * pause_, 1 << 14);
    } else if (trouble_ == 0)
      pause_ = 512;
  }

  void put_back(std::vector<Worker>& workers) {
    for (Worker& w : workers) {
      for (auto saved = w.saved_events.rbegin(); saved != w.saved_events.rend(); ++saved)
        spheres_.set_event(saved->sphere, {saved->next, saved->partner});
      for (auto saved = w.saved_paths.rbegin(); saved != w.saved_paths.rend(); ++saved) {
        spheres_.bodies[saved->sphere].origin = saved->origin;
        spheres_.bodies[saved->sphere].velocity = saved->velocity;
      }
    }
  }

  /// All that is due in the window, for one worker.
  void gather_due() {
    for (const Worker& w : workers_)
      alone_.due.insert(alone_.due.end(), w.due.begin(), w.due.end());
    alone_.sudden.clear(); // the workers have them
  }

  void close_window(double end) {
    const WindowSums& window = alone_.sums;
    stuck_ = alone_.conflict;
    const double reached = stuck_ ? alone_.now : end;
    const double length = end - now_, passed = reached - now_;
    sums_.events += window.events;
    sums_.collisions += window.collisions;
    sums_.duration += passed;
    sums_.virial += window.virial.value() * spheres_.scale;
    sums_.action += energy_ * passed + window.heat.value() * length - window.work.value() * (length - passed);
    energy_ += window.work.value();
    now_ = reached;
    if (!stuck_ && reached == spheres_.calendar.end_of_today())
      spheres_.calendar.next_day();
  }

  void rebuild_lists() {
    SphereArray<Shell> shells(size());
    for (ParticleIndex i = 0; i < size(); ++i)
      shells[i] = spheres_.new_shell(i, 0);
    spheres_.neighbours.rebuild(std::move(shells));
  }

  /// Spheres that are near in space become near in memory.
  void sort_by_place() {
    std::vector<std::pair<std::size_t, ParticleIndex>> places(size());
    for (ParticleIndex i = 0; i < size(); ++i) {
      Vec3 centre = spheres_.bodies[i].origin;
      if (periodic_)
        for (int k = 0; k < 3; ++k)
          centre[k] -= std::floor(centre[k]);
      places[i] = {spheres_.neighbours.grid().cell_of(centre), i};
    }
    std::sort(places.begin(), places.end());
    SphereArray<Body> sorted(size());
    for (std::size_t i = 0; i < size(); ++i)
      sorted[i] = spheres_.bodies[places[i].second];
    spheres_.bodies.swap(sorted);
  }

  SphereCollisions spheres_;
  Worker alone_;
  std::vector<Worker> workers_, second_;
  CollisionSums sums_;
  double now_ = 0;
  double energy_ = 0;          ///< kinetic, kept up to date
  double listed_skin_ = never; ///< skin at the last rebuild
  double window_ = 1;          ///< length of a window
  std::uint64_t repeated_ = 0;
  int trouble_ = 0, windows_alone_ = 0, pause_ = 512; ///< see note_trouble()
  bool stuck_ = false;
  bool periodic_;
};

} // namespace cdem::packing::detail
