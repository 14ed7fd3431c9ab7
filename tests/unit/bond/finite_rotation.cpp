#include <cdem/bond/bond_forces.hpp>
#include <cdem/bond/finite_rotation.hpp>
#include <cdem/integrate/critical_time_step.hpp>
#include <cdem/integrate/dynamic_relaxation.hpp>
#include <cdem/integrate/velocity_verlet.hpp>

#include <doctest/doctest.h>

#include <numbers>

#include "body.hpp"

namespace {

using namespace cdem;
using body::Body;
using body::evaluated;
using body::SpatialField;
using std::numbers::pi;
using Law = bond::FiniteRotation<bond::Beam<>>;
using Forces = bond::BondForces<Law>;

const bond::Beam<> beam({.materials = {{1, 0.6}, {30, 0.4}}});

/// Turns a body about an axis through the origin by `angle`, in `steps` accepted one by one.
SpatialField turned(Forces& forces, const Body& body, const Vec3& axis, double angle, int steps) {
  core::ThreadPool pool;
  SpatialField motion(body.particles.size()), force;
  for (int step = 1; step <= steps; ++step) {
    const double now = angle * step / steps;
    for (std::size_t i = 0; i < motion.size(); ++i) {
      const Vec3& x = body.particles.position[i];
      motion[i].linear() = Eigen::AngleAxisd(now, axis) * x - x;
      motion[i].angular() = now * axis;
    }
    forces.advance(motion, force, pool);
  }
  return motion;
}

/// The same bodies in the same places, numbered from the other end.
Body reversed(const Body& body) {
  const auto last = static_cast<ParticleIndex>(body.particles.size() - 1);
  Body other = body;
  std::vector<std::tuple<ParticleIndex, ParticleIndex, Vec3>> bonds;
  for (std::size_t i = 0; i <= last; ++i) {
    other.particles.position[i] = body.particles.position[last - i];
    other.particles.radius[i] = body.particles.radius[last - i];
    other.particles.phase[i] = body.particles.phase[last - i];
  }
  for (BondIndex b = 0; b < body.network.size(); ++b)
    bonds.emplace_back(last - body.network.second[b], last - body.network.first[b], -body.network.branch[b]);
  std::sort(bonds.begin(), bonds.end(), [](const auto& a, const auto& b) {
    return std::pair(std::get<0>(a), std::get<1>(a)) < std::pair(std::get<0>(b), std::get<1>(b));
  });
  for (BondIndex b = 0; b < body.network.size(); ++b)
    std::tie(other.network.first[b], other.network.second[b], other.network.branch[b]) = bonds[b];
  return other;
}

/// Slender chain along x of `count` beams of length 1, r_mu = 0.2, E = 1, as particles and its beams' section.
struct Cantilever {
  static constexpr double section_radius = 0.1;
  static constexpr double area = pi * section_radius * section_radius;
  static constexpr double rigidity = 0.25 * area * section_radius * section_radius; ///< E I
  Body body;
  bond::Beam<> beam{{.materials = {{1, 0.2}}}};
  explicit Cantilever(std::size_t count) : body(body::row(count + 1, Vec3::UnitX(), 1, 0.5)) {}
};

} // namespace

TEST_CASE("forces are minus the gradient of the energy and balance, however far the ends have turned") {
  const Body random = body::random_body(30, 3);
  Forces forces(Law(beam), random.particles, random.network);
  core::ThreadPool pool;
  SpatialField motion = turned(forces, random, Vec3(1, 2, 2) / 3, 4.0, 8);
  const SpatialField shake = body::random_motion(30, 0.2, 4);
  for (std::size_t i = 0; i < 30; ++i)
    for (int dof = 0; dof < 6; ++dof)
      motion[i][dof] += 0.3 * shake[i][dof];
  SpatialField force;
  forces.advance(motion, force, pool); // gradients by rotations are taken from the accepted orientations
  double scale = 0;
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  for (std::size_t i = 0; i < 30; ++i) {
    sum += force[i].linear();
    moment +=
        force[i].angular() + (random.particles.position[i] + motion[i].linear()).cross(force[i].linear());
    scale += force[i].linear().norm();
  }
  CHECK(body::gradient_error(forces, motion, 1e-5) < 1e-8);
  CHECK(sum.norm() < 1e-13 * scale);
  CHECK(moment.norm() < 1e-13 * scale * 3); // arms of up to 3
}

TEST_CASE("a body turned by more than a full turn has no force in it, and feels as it did at rest") {
  const Body random = body::random_body(200, 5);
  Forces forces(Law(beam), random.particles, random.network);
  const Vec3 axis = Vec3(-2, 1, 2) / 3;
  const SpatialField shake = body::random_motion(200, 1e-4, 6);
  SpatialField little = shake;
  for (auto& spatial : little)
    spatial.angular() *= 1e-4;
  const SpatialField expected = evaluated(forces, little);
  const SpatialField motion = turned(forces, random, axis, 7.5, 40);
  const Mat3 rotation = Eigen::AngleAxisd(7.5, axis).toRotationMatrix();
  double rest = 0, worst = 0, largest = 0;
  SpatialField shaken = motion;
  for (std::size_t i = 0; i < 200; ++i) {
    shaken[i].linear() += rotation * little[i].linear();
    shaken[i].angular() += rotation * little[i].angular();
  }
  const SpatialField still = evaluated(forces, motion), found = evaluated(forces, shaken);
  for (std::size_t i = 0; i < 200; ++i) {
    rest = std::max({rest, still[i].linear().norm(), still[i].angular().norm()});
    largest = std::max({largest, expected[i].linear().norm(), expected[i].angular().norm()});
    worst = std::max({worst, (found[i].linear() - rotation * expected[i].linear()).norm(),
                      (found[i].angular() - rotation * expected[i].angular()).norm()});
  }
  CHECK(rest < 1e-10 * largest);
  CHECK(worst < 1e-9 * largest);
  CHECK(forces.orientation(7).angularDistance(Eigen::Quaterniond(rotation)) < 1e-12);
}

TEST_CASE("small motions give what the law gives, to first order") {
  const Body random = body::random_body(100, 7);
  const Forces forces(Law(beam), random.particles, random.network);
  const bond::BondForces linear(beam, random.particles, random.network);
  double error[2];
  for (double size : {1e-3, 1e-4}) {
    SpatialField motion = body::random_motion(100, 1, 8), expected;
    for (auto& spatial : motion) {
      spatial.linear() *= size;
      spatial.angular() *= size;
    }
    core::ThreadPool pool;
    linear.evaluate(motion, expected, pool);
    error[size < 5e-4] = (body::flat(evaluated(forces, motion)) - body::flat(expected)).norm() / size;
  }
  CHECK(error[0] / error[1] == doctest::Approx(10).epsilon(0.02));
}

TEST_CASE("whose number is lower does not matter") {
  const Body random = body::random_body(100, 9), other = reversed(random);
  const Forces forces(Law(beam), random.particles, random.network),
      swapped(Law(beam), other.particles, other.network);
  const SpatialField motion = body::random_motion(100, 0.3, 10);
  const SpatialField force = evaluated(forces, motion),
                     same = evaluated(swapped, SpatialField(motion.rbegin(), motion.rend()));
  double worst = 0;
  for (std::size_t i = 0; i < 100; ++i)
    for (int dof = 0; dof < 6; ++dof)
      worst = std::max(worst, std::abs(force[i][dof] - same[99 - i][dof]));
  CHECK(worst < 1e-14 * body::flat(force).lpNorm<Eigen::Infinity>());
}

TEST_CASE("the tangent is the symmetric part of the derivative of the forces") {
  const Body random = body::random_body(20, 11);
  Forces forces(Law(beam), random.particles, random.network);
  core::ThreadPool pool;
  SpatialField motion = body::random_motion(20, 0.2, 12), force;
  forces.advance(motion, force, pool);
  const Eigen::MatrixXd tangent = body::dense_stiffness(forces.tangent(motion, pool));
  Eigen::MatrixXd slope(120, 120);
  for (Eigen::Index column = 0; column < 120; ++column) {
    double& moved = motion[static_cast<std::size_t>(column / 6)][static_cast<int>(column % 6)];
    const double here = moved;
    moved = here + 1e-5;
    slope.col(column) = -body::flat(evaluated(forces, motion));
    moved = here - 1e-5;
    slope.col(column) = (slope.col(column) + body::flat(evaluated(forces, motion))) / 2e-5;
    moved = here;
  }
  const double scale = tangent.lpNorm<Eigen::Infinity>();
  CHECK((tangent - tangent.transpose()).lpNorm<Eigen::Infinity>() < 1e-13 * scale);
  CHECK((tangent - 0.5 * (slope + slope.transpose())).lpNorm<Eigen::Infinity>() < 1e-8 * scale);
  for (ParticleIndex i = 0; i < 20; i += 5)
    CHECK((forces.tangent(motion, pool).diagonal_block(i) - tangent.block<6, 6>(6 * i, 6 * i)).norm() <
          1e-13 * scale);
}

TEST_CASE("an end moment rolls a cantilever into a circle") {
  // M = 2 pi E I/L. Exact: a circle of circumference L; a chain of N beams: its polygon, at order 1/N^2.
  double error[2];
  int level = 0;
  for (const std::size_t count : {16u, 32u}) {
    const Cantilever chain(count);
    const double length = static_cast<double>(count);
    Forces forces(Law(chain.beam), chain.body.particles, chain.body.network);
    particles::Constraints clamp;
    for (std::uint8_t dof = 0; dof < 6; ++dof)
      clamp.add({0, dof, 0});
    const auto inertia = particles::solid_spheres(chain.body.particles, std::vector{1.0});
    SpatialField load(count + 1);
    auto motion = particles::Motion::at_rest(count + 1);
    core::ThreadPool pool;
    for (int quarter = 1; quarter <= 4; ++quarter) {
      load[count][5] = 0.25 * quarter * 2 * pi * Cantilever::rigidity / length;
      integrate::DynamicRelaxation({.relative_residual = 1e-8})
          .solve(integrate::Problem<Forces>{forces, inertia, clamp, &load}, motion, pool);
    }
    const double n = length, side = 2 * pi / n;
    CHECK((motion.displacement[count].linear() + length * Vec3::UnitX()).norm() < 1e-4 * length);
    CHECK(motion.displacement[count][5] == doctest::Approx(2 * pi).epsilon(1e-4));
    const double height = motion.displacement[count / 2][1]; // of the middle: the circle's diameter
    CHECK(height == doctest::Approx(1 / std::sin(0.5 * side)).epsilon(1e-4));
    error[level++] = std::abs(height - length / pi) / (length / pi);
  }
  CHECK(error[0] / error[1] == doctest::Approx(4).epsilon(0.05));
}

TEST_CASE("a column buckles at Euler's load") {
  // Clamped at one end: P = pi^2 E I/(4 L^2). Straight and compressed, its stiffness is positive below and not above.
  double error[2];
  int level = 0;
  for (const std::size_t count : {10u, 20u}) {
    const Cantilever column(count);
    const Forces forces(Law(column.beam), column.body.particles, column.body.network);
    core::ThreadPool pool;
    const double length = static_cast<double>(count);
    const double euler = pi * pi * Cantilever::rigidity / (4 * length * length);
    const auto stands = [&](double load) {
      SpatialField motion(count + 1);
      for (std::size_t i = 0; i <= count; ++i)
        motion[i][0] = -load / Cantilever::area * static_cast<double>(i);
      const Eigen::MatrixXd stiffness = body::dense_stiffness(forces.tangent(motion, pool));
      const Eigen::Index free = stiffness.rows() - 6;
      return stiffness.bottomRightCorner(free, free).llt().info() == Eigen::Success; // positive
    };
    double below = 0.5 * euler, above = 2 * euler;
    REQUIRE(stands(below));
    REQUIRE_FALSE(stands(above));
    while (above - below > 1e-7 * euler)
      (stands(0.5 * (below + above)) ? below : above) = 0.5 * (below + above);
    error[level++] = below / euler - 1;
  }
  CHECK(std::abs(error[0]) < 0.01);
  CHECK(std::abs(error[1]) < 0.0025);
}

TEST_CASE("a body spins freely through full turns: energy and angular momentum are kept, and its orientation "
          "is right") {
  const Body random = body::random_body(24, 13);
  Forces forces(Law(beam), random.particles, random.network);
  const auto inertia = particles::solid_spheres(random.particles, std::vector{1.0, 1.0});
  const particles::Constraints none;
  const integrate::Problem<Forces> problem{forces, inertia, none};
  core::ThreadPool pool;
  auto motion = particles::Motion::at_rest(24);
  const Vec3 spin = 0.02 * Vec3(2, -1, 2) / 3;
  for (std::size_t i = 0; i < 24; ++i) {
    motion.velocity[i].linear() = spin.cross(random.particles.position[i]);
    motion.velocity[i].angular() = spin;
  }
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < 24; ++i)
      sum += inertia.mass[i] * (random.particles.position[i] + motion.displacement[i].linear())
                                   .cross(Vec3(motion.velocity[i].linear())) +
             inertia.moment[i] * motion.velocity[i].angular();
    return sum;
  };
  const Vec3 before = momentum();
  const double kinetic = integrate::kinetic_energy(inertia, motion.velocity, pool);
  const double time_step = 0.5 * integrate::critical_time_step(forces, inertia).time_step;
  const auto steps = static_cast<std::uint64_t>(std::ceil(2.2 * pi / spin.norm() / time_step)); // 1.1 turns
  double worst = 0;
  integrate::VelocityVerlet({.time_step = time_step})
      .run(problem, motion, steps, pool, [&](const integrate::Step& step) {
        if (step.motion.step % 100 == 0)
          worst = std::max(worst, std::abs(integrate::energy_ledger(problem, step.motion, pool).imbalance()));
        return true;
      });
  CHECK(worst < 1e-5 * kinetic);
  CHECK((momentum() - before).norm() < 1e-12 * before.norm());
}
