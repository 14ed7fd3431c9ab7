// Stress and couple stress of a body of 100,000 particles by every estimator: seconds on one thread and on two, whether both gave the
// same bytes, and how far the sum of V sigma is from that of f (x) d. With a file's name, also the cells of that mesh (Gmsh's, of the
// unit cube).
//
//     bench.stress_estimators [MESH.msh]

#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/io/gmsh.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/packing/tiled.hpp>
#include <cdem/simulation/specimen.hpp>
#include <cdem/stress/closure.hpp>
#include <cdem/stress/coarse_graining.hpp>
#include <cdem/stress/halo.hpp>
#include <cdem/stress/love_weber.hpp>
#include <cdem/stress/tessellation/polyhedra.hpp>
#include <cdem/stress/tessellation/tetrahedra.hpp>
#include <cdem/stress/tessellation/wedges.hpp>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>

#include "../common/sample.hpp"

namespace {

using namespace cdem;
using namespace cdem::stress::tessellation;

/// 5 x 5 x 5 copies of a packing of 800 in the cube of side 1, and what its bonds carry in a random motion.
struct Body {
  core::ThreadPool one{1}, two{2};
  simulation::Specimen specimen;
  std::vector<Vec3> forces, moments;
  Mat3 moment = Mat3::Zero(); ///< sum of f (x) d

  Body() {
    const auto tile =
        packing::LubachevskyStillinger({.particles = 800, .cov = 0.3, .growth_rate = 0.1, .seed = 1})
            .pack({});
    const double side = 5 * tile.box.size().x();
    particles::ParticleSet spheres;
    for (int copy = 0; copy < 125; ++copy)
      for (std::size_t i = 0; i < tile.particles.size(); ++i) {
        const Vec3 shift = Vec3(copy % 5, copy / 5 % 5, copy / 25) / 5;
        spheres.position.push_back(tile.box.wrap(tile.particles.position[i]) / side + shift);
        spheres.radius.push_back(tile.particles.radius[i] / side);
        spheres.phase.push_back(0);
      }
    specimen = simulation::make_specimen(spheres, geometry::Box::cube(1, false), bench::coordination, two);
    const bond::LinearForces law(bench::alumina(), specimen.particles, specimen.network);
    const auto motion = bench::random_motion(specimen.particles.size());
    for (std::size_t b = 0; b < specimen.network.size(); ++b) {
      const bond::BondLoad load = law.load(b, motion);
      forces.push_back(load.force);
      moments.push_back(0.5 * (load.moment_first - load.moment_second));
      moment += load.force * specimen.network.branch[b].transpose();
    }
  }
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool same_bytes(const std::vector<Mat3>& a, const std::vector<Mat3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Mat3)) == 0;
}

/// One line of the table. `make` builds the estimator: its seconds are reported apart.
template <class Make>
void measure(Body& body, const char* name, bool adds_up, Make&& make) {
  auto start = std::chrono::steady_clock::now();
  const auto estimator = make();
  const double set_up = seconds_since(start);
  const stress::BondLoads loads(body.forces, body.moments);
  const auto estimate = [&](core::ThreadPool& pool, double& seconds) {
    start = std::chrono::steady_clock::now();
    auto field = estimator.estimate(body.specimen.particles, body.specimen.network, loads, pool);
    seconds = seconds_since(start);
    return field;
  };
  double on_one = 0, on_two = 0;
  const auto one = estimate(body.one, on_one), two = estimate(body.two, on_two);
  const bool same = same_bytes(one.stress, two.stress) && same_bytes(one.couple_stress, two.couple_stress);
  std::printf("%-38s %8zu %9.3f %9.3f %9.3f %6s", name, one.size(), set_up, on_one, on_two,
              same ? "yes" : "NO");
  if (adds_up)
    std::printf(" %9.1e",
                (stress::moment_of_stress(one) + one.outside - body.moment).norm() / body.moment.norm());
  std::printf("\n");
  std::fflush(stdout);
}

void run(const char* mesh_file) {
  Body body;
  std::printf("%zu particles, %zu bonds with moments\n\n%-38s %8s %9s %9s %9s %6s %9s\n",
              body.specimen.particles.size(), body.specimen.network.size(), "estimator", "places",
              "set up, s", "1 core, s", "2 cores", "same?", "closure");
  const geometry::Box& box = body.specimen.box;
  const Hexahedra grid(box, {28, 28, 28});
  const auto love_weber = [](auto&& cells) {
    return stress::LoveWeber<std::decay_t<decltype(cells)>>(std::forward<decltype(cells)>(cells));
  };
  measure(body, "Love-Weber, hexahedra", true, [&] { return love_weber(Hexahedra(grid)); });
  measure(body, "Love-Weber, wedges", true, [&] { return love_weber(Wedges(grid)); });
  measure(body, "Love-Weber, tetrahedra", true, [&] { return love_weber(Tetrahedra(grid)); });
  measure(body, "Love-Weber, hexahedra as a mesh", true,
          [&] { return love_weber(Polyhedra(mesh_of(grid))); });
  measure(body, "Love-Weber, wedges as a mesh", true,
          [&] { return love_weber(Polyhedra(mesh_of(Wedges(grid)))); });
  measure(body, "Love-Weber, tetrahedra as a mesh", true,
          [&] { return love_weber(Polyhedra(mesh_of(Tetrahedra(grid)))); });
  if (mesh_file)
    measure(body, "Love-Weber, mesh of the file", true,
            [&] { return love_weber(Polyhedra(io::read_gmsh(mesh_file))); });

  const double radius =
      std::cbrt(80 * 3 / (4 * std::numbers::pi * static_cast<double>(body.specimen.particles.size())));
  core::Random random(2);
  std::vector<Vec3> points;
  for (int n = 0; n < 10'000; ++n)
    points.push_back({random.uniform(), random.uniform(), random.uniform()});
  const Hexahedra places(box, {50, 50, 50});
  measure(body, "halo, balls of 80 particles", false, [&] { return stress::Halo(points, radius, box); });
  measure(body, "coarse graining, Lucy of that radius", false,
          [&] { return stress::CoarseGraining<>(places, stress::Lucy(radius)); });
  measure(body, "coarse graining, Gaussian as wide", false,
          [&] { return stress::CoarseGraining(places, stress::Gaussian(radius / std::sqrt(12.0))); });
}

} // namespace

int main(int argc, char** argv) {
  try {
    run(argc > 1 ? argv[1] : nullptr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench.stress_estimators: %s\n", error.what());
    return 2;
  }
}
