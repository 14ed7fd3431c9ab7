#pragma once

// What the tests of the stress layer share: networks small enough to be made and checked by double loops.

#include <cdem/core/random.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/network/bond_network.hpp>
#include <cdem/particles/particle_set.hpp>
#include <cdem/stress/stress_estimator.hpp>

#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace sample {

using namespace cdem;

inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Particles, bonds, and a force a bond.
struct Body {
  geometry::Box box;
  particles::ParticleSet particles;
  network::BondNetwork network;
  std::vector<Vec3> forces;

  void add_particle(const Vec3& position, double radius) {
    particles.position.push_back(position);
    particles.radius.push_back(radius);
    particles.phase.push_back(0);
    network.particle_count = particles.size();
  }
  void add_bond(std::size_t first, std::size_t second, const Vec3& force) {
    network.first.push_back(static_cast<ParticleIndex>(first));
    network.second.push_back(static_cast<ParticleIndex>(second));
    network.branch.push_back(box.minimum_image(particles.position[second] - particles.position[first]));
    forces.push_back(force);
  }
  /// Sum of f (x) d over the bonds, in long double: what no tessellation may change.
  Mat3 moment() const {
    Eigen::Matrix<long double, 3, 3> sum = Eigen::Matrix<long double, 3, 3>::Zero();
    for (std::size_t b = 0; b < network.size(); ++b)
      sum += forces[b].cast<long double>() * network.branch[b].cast<long double>().transpose();
    return sum.cast<double>();
  }
  /// Sum of |f| |d|: the scale of that sum's rounding.
  double moment_scale() const {
    double sum = 0;
    for (std::size_t b = 0; b < network.size(); ++b)
      sum += forces[b].norm() * network.branch[b].norm();
    return sum;
  }
};

inline Vec3 random_vector(core::Random& random, double lower, double upper) {
  const double x = random.uniform(lower, upper);
  const double y = random.uniform(lower, upper);
  return {x, y, random.uniform(lower, upper)};
}

inline Vec3 random_point(core::Random& random, const geometry::Box& box) {
  return box.lower + box.size().cwiseProduct(random_vector(random, 0, 1));
}

/// Random points of random radii; pairs nearer than `reach` are joined by a random force.
inline Body random_body(const geometry::Box& box, std::size_t count, double reach, std::uint64_t seed) {
  core::Random random(seed);
  Body body;
  body.box = box;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 point = random_point(random, box);
    body.add_particle(point, random.uniform(0.2, 0.5) * reach);
  }
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j)
      if (box.minimum_image(body.particles.position[j] - body.particles.position[i]).norm() < reach)
        body.add_bond(i, j, random_vector(random, -1, 1));
  return body;
}

/// Periodic simple cubic lattice of spacing a, n particles along each axis; every bond across the plane normal to
/// axis k carries the traction stress.col(k) on an area a^2.
inline Body stressed_lattice(int n, double a, const Mat3& stress) {
  Body body;
  body.box = geometry::Box::cube(n * a, true);
  const auto number = [n](int i, int j, int k) {
    return static_cast<std::size_t>(i % n + n * (j % n + n * (k % n)));
  };
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        body.add_particle(a * Vec3(i + 0.5, j + 0.5, k + 0.5), a / 2);
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        body.add_bond(number(i, j, k), number(i + 1, j, k), a * a * stress.col(0));
        body.add_bond(number(i, j, k), number(i, j + 1, k), a * a * stress.col(1));
        body.add_bond(number(i, j, k), number(i, j, k + 1), a * a * stress.col(2));
      }
  return body;
}

inline bool same_bytes(const stress::StressField& a, const stress::StressField& b) {
  return a.size() == b.size() && a.volume == b.volume && a.particles == b.particles &&
         std::memcmp(a.stress.data(), b.stress.data(), a.size() * sizeof(Mat3)) == 0 &&
         std::memcmp(&a.outside, &b.outside, sizeof(Mat3)) == 0 &&
         a.couple_stress.size() == b.couple_stress.size() &&
         (a.couple_stress.empty() || std::memcmp(a.couple_stress.data(), b.couple_stress.data(),
                                                 a.couple_stress.size() * sizeof(Mat3)) == 0) &&
         std::memcmp(&a.outside_couple, &b.outside_couple, sizeof(Mat3)) == 0;
}

/// The message of the InvalidInput that action() throws; empty if it throws none.
template <class Action>
std::string refusal(Action&& action) {
  try {
    action();
  } catch (const core::InvalidInput& error) {
    return error.what();
  }
  return {};
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace sample
