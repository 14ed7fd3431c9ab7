// Collisions near jamming: the library on one thread and two, beside a plain event loop written by hand.
//
// All sides start from the same packing, grown fast to a reduced pressure of 1000, and go on at a growth rate of 0.1; the
// library from the same state in each iteration. Arguments: particles, threads. Counters: million collisions a second,
// ns a collision.

#include <cdem/packing/detail/growing_spheres.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>

#include <benchmark/benchmark.h>

#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <vector>

namespace {

using namespace cdem;

struct Start {
  std::vector<Vec3> centres, velocities;
  std::vector<double> sizes;
  double scale = 0;
};

const Start& start(std::int64_t particles) {
  static std::map<std::int64_t, Start> starts;
  Start& start = starts[particles];
  if (!start.centres.empty())
    return start;
  const auto packing = packing::LubachevskyStillinger({.particles = static_cast<std::uint32_t>(particles),
                                                       .density = 0.74,
                                                       .cov = 0,
                                                       .growth_rate = 0.3,
                                                       .pressure_limit = 1000,
                                                       .side = 1})
                           .pack();
  core::Random random(1);
  start.centres = packing.particles.position;
  start.scale = 2 * packing.report.mean_radius * (1 - 1e-12);
  start.sizes.assign(start.centres.size(), 0.5);
  for (std::size_t i = 0; i < start.sizes.size(); ++i)
    start.velocities.emplace_back(random.normal(), random.normal(), random.normal());
  return start;
}

constexpr double growth = 0.1, interval_guess = 2e-3; // of the mean diameter over the thermal speed, a sphere

void count(benchmark::State& state, std::uint64_t collisions) {
  const auto all = static_cast<double>(collisions);
  state.counters["Mcollisions/s"] = benchmark::Counter(1e-6 * all, benchmark::Counter::kIsRate);
  state.counters["ns"] =
      benchmark::Counter(1e-9 * all, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["particles"] = static_cast<double>(state.range(0));
}

void near_jamming(benchmark::State& state) {
  const Start& from = start(state.range(0));
  const auto spheres_count = from.sizes.size();
  core::ThreadPool pool(static_cast<int>(state.range(1)));
  packing::detail::GrowingSpheres prepared(from.centres, from.sizes, from.velocities, from.scale, true);
  double interval = interval_guess * from.scale / static_cast<double>(spheres_count);
  const auto cycle = [&](packing::detail::GrowingSpheres& spheres) {
    spheres.begin_cycle(growth, 0.02 * spheres.scale(), interval, pool);
    spheres.run(3 * spheres_count, 1, pool);
    spheres.synchronise();
  };
  cycle(prepared); // to an interval that is known, and to lists
  interval = prepared.sums().duration / static_cast<double>(prepared.sums().events);
  std::uint64_t collisions = 0;
  for (auto _ : state) {
    state.PauseTiming();
    packing::detail::GrowingSpheres spheres = prepared;
    state.ResumeTiming();
    cycle(spheres);
    collisions += spheres.sums().collisions;
  }
  count(state, collisions);
}

/// The plain loop: every sphere flies at once from event to event in a binary heap; all lists are rebuilt together
/// when the fastest sphere may have left its shell.
class PlainLoop {
public:
  PlainLoop(const Start& from)
      : centre_(from.centres), velocity_(from.velocities), time_(from.sizes.size(), 0),
        stamp_(from.sizes.size(), 0), list_(from.sizes.size()), diameter_(from.scale) {
    rebuild();
  }

  void collide(std::uint64_t wanted) {
    for (std::uint64_t done = 0; done < wanted;) {
      const Meeting meeting = heap_.top();
      heap_.pop();
      if (meeting.stamp_i != stamp_[meeting.i] || meeting.stamp_j != stamp_[meeting.j])
        continue;
      if (meeting.time > valid_until_) {
        now_ = valid_until_;
        rebuild();
        continue;
      }
      now_ = meeting.time;
      move(meeting.i);
      move(meeting.j);
      Vec3 normal = image(centre_[meeting.j] - centre_[meeting.i]);
      normal.normalize();
      const double momentum = std::max(growth - normal.dot(velocity_[meeting.j] - velocity_[meeting.i]), 0.0);
      velocity_[meeting.i] -= momentum * normal;
      velocity_[meeting.j] += momentum * normal;
      fastest_ = std::max({fastest_, velocity_[meeting.i].norm(), velocity_[meeting.j].norm()});
      valid_until_ = std::min(valid_until_, listed_ + room_ / fastest_);
      ++stamp_[meeting.i];
      ++stamp_[meeting.j];
      predict(meeting.i);
      predict(meeting.j);
      ++done;
    }
  }

private:
  struct Meeting {
    double time;
    std::uint32_t i, j, stamp_i, stamp_j;
    bool operator<(const Meeting& other) const { return time > other.time; }
  };

  static Vec3 image(const Vec3& d) { return d - d.array().round().matrix(); }

  void move(std::uint32_t i) {
    centre_[i] += velocity_[i] * (now_ - time_[i]);
    time_[i] = now_;
  }

  void rebuild() {
    fastest_ = 0;
    for (std::uint32_t i = 0; i < centre_.size(); ++i) {
      move(i);
      centre_[i] -= centre_[i].array().floor().matrix();
      fastest_ = std::max(fastest_, velocity_[i].norm());
      list_[i].clear();
    }
    room_ = 0.02 * diameter_;
    listed_ = now_;
    valid_until_ = now_ + room_ / fastest_;
    const double reach = diameter_ * 1.03 + 2 * room_;
    const auto cells = static_cast<int>(1 / reach);
    std::vector<std::vector<std::uint32_t>> cell(
        static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
    const auto number = [&](int x, int y, int z) {
      const auto wrap = [&](int a) { return static_cast<std::size_t>((a + cells) % cells); };
      return (wrap(z) * static_cast<std::size_t>(cells) + wrap(y)) * static_cast<std::size_t>(cells) +
             wrap(x);
    };
    const auto at = [&](double x) { return std::min(static_cast<int>(x * cells), cells - 1); };
    for (std::uint32_t i = 0; i < centre_.size(); ++i) {
      const Vec3& c = centre_[i];
      for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
          for (int x = -1; x <= 1; ++x)
            for (const std::uint32_t j : cell[number(at(c[0]) + x, at(c[1]) + y, at(c[2]) + z)])
              if (image(centre_[j] - c).squaredNorm() < reach * reach) {
                list_[i].push_back(j);
                list_[j].push_back(i);
              }
      cell[number(at(c[0]), at(c[1]), at(c[2]))].push_back(i);
    }
    heap_ = {};
    for (std::uint32_t i = 0; i < centre_.size(); ++i)
      predict(i);
  }

  void predict(std::uint32_t i) {
    const Vec3 centre = centre_[i] + velocity_[i] * (now_ - time_[i]);
    const double sum = diameter_ + growth * now_;
    for (const std::uint32_t j : list_[i]) {
      const Vec3 d = image(centre_[j] + velocity_[j] * (now_ - time_[j]) - centre),
                 w = velocity_[j] - velocity_[i];
      const double a = w.squaredNorm() - growth * growth, b = d.dot(w) - sum * growth;
      const double c = d.squaredNorm() - sum * sum, discriminant = b * b - a * c;
      double time = std::numeric_limits<double>::infinity();
      if (b < 0 && (discriminant >= 0 || c <= 0))
        time = std::max(c, 0.0) / (std::sqrt(std::max(discriminant, 0.0)) - b);
      else if (b >= 0 && a < 0)
        time = -(b + std::sqrt(discriminant)) / a;
      if (now_ + time <= valid_until_)
        heap_.push({now_ + time, i, j, stamp_[i], stamp_[j]});
    }
    heap_.push({std::nextafter(valid_until_, 1e300), i, i, stamp_[i], stamp_[i]}); // the lists' end
  }

  std::vector<Vec3> centre_, velocity_;
  std::vector<double> time_;
  std::vector<std::uint32_t> stamp_;
  std::vector<std::vector<std::uint32_t>> list_;
  std::priority_queue<Meeting> heap_;
  double diameter_, now_ = 0, valid_until_ = 0, listed_ = 0, room_ = 0, fastest_ = 0;
};

void raw_plain_loop(benchmark::State& state) {
  const Start& from = start(state.range(0));
  PlainLoop loop(from);
  std::uint64_t collisions = 0;
  for (auto _ : state) {
    loop.collide(2 * from.sizes.size());
    collisions += 2 * from.sizes.size();
  }
  count(state, collisions);
}

} // namespace

BENCHMARK(raw_plain_loop)
    ->Arg(10000)
    ->Arg(100000)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(near_jamming)
    ->ArgsProduct({{10000, 100000, 1000000}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

BENCHMARK_MAIN();
