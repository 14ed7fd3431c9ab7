#include <cdem/integrate/dynamic_relaxation.hpp>
#include <cdem/integrate/static_multigrid.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <limits>

#include "sample.hpp"

namespace {

using namespace sample;
using core::Interrupted;
using core::InvalidInput;
using core::NotReached;
using integrate::DynamicRelaxation;
using integrate::Problem;
using particles::Motion;

/// Solves a body on one thread.
struct Solution {
  Motion motion;
  DynamicRelaxation::Report report;
};
template <class Forces>
Solution solve(const Problem<Forces>& problem, DynamicRelaxation::Parameters parameters = {},
               int threads = 1) {
  core::ThreadPool pool(threads);
  Solution solution{Motion::at_rest(problem.forces.particle_count()), {}};
  solution.report = DynamicRelaxation(parameters).solve(problem, solution.motion, pool);
  return solution;
}

/// The unknowns of a problem, as a vector, for checks by dense algebra.
struct Unknowns {
  std::vector<std::pair<std::size_t, int>> list; ///< particle, degree of freedom

  template <class Forces>
  explicit Unknowns(const Problem<Forces>& problem) {
    std::vector<char> held(6 * problem.forces.particle_count(), 0);
    for (const auto& constraint : problem.constraints.list())
      held[6 * constraint.particle + constraint.dof] = 1;
    for (std::size_t k = 0; k < held.size(); ++k)
      if (!held[k])
        list.emplace_back(k / 6, static_cast<int>(k % 6));
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(list.size()); }
  Eigen::VectorXd of(const Field& field) const {
    Eigen::VectorXd vector(size());
    for (Eigen::Index k = 0; k < size(); ++k)
      vector[k] = field[list[static_cast<std::size_t>(k)].first][list[static_cast<std::size_t>(k)].second];
    return vector;
  }
  double& at(Field& field, Eigen::Index k) const {
    return field[list[static_cast<std::size_t>(k)].first][list[static_cast<std::size_t>(k)].second];
  }
};

/// Load and internal forces on the unknowns.
template <class Forces>
Eigen::VectorXd out_of_balance(const Problem<Forces>& problem, const Unknowns& unknowns,
                               const Field& displacement) {
  core::ThreadPool pool;
  Field force(displacement.size());
  problem.forces.evaluate(displacement, force, pool);
  return unknowns.of(force) +
         (problem.load ? unknowns.of(*problem.load) : Eigen::VectorXd::Zero(unknowns.size()));
}

Field prescribed_motion(const particles::Constraints& constraints, std::size_t count) {
  Field field(count);
  for (const auto& constraint : constraints.list())
    field[constraint.particle][constraint.dof] = constraint.rate;
  return field;
}

/// Newton's method with the stiffness by central differences of the forces; one step is exact for linear forces.
template <class Forces>
Field newton(const Problem<Forces>& problem, double length, int iterations, double difference) {
  const Unknowns unknowns(problem);
  Field field = prescribed_motion(problem.constraints, problem.forces.particle_count());
  for (int iteration = 0; iteration < iterations; ++iteration) {
    Eigen::MatrixXd stiffness(unknowns.size(), unknowns.size());
    for (Eigen::Index k = 0; k < unknowns.size(); ++k) {
      const double here = unknowns.at(field, k);
      const double step =
          unknowns.list[static_cast<std::size_t>(k)].second < 3 ? difference : difference / length;
      unknowns.at(field, k) = here + step;
      const Eigen::VectorXd ahead = out_of_balance(problem, unknowns, field);
      unknowns.at(field, k) = here - step;
      stiffness.col(k) = (out_of_balance(problem, unknowns, field) - ahead) / (2 * step);
      unknowns.at(field, k) = here;
    }
    const Eigen::VectorXd change = stiffness.llt().solve(out_of_balance(problem, unknowns, field));
    for (Eigen::Index k = 0; k < unknowns.size(); ++k)
      unknowns.at(field, k) += change[k];
  }
  return field;
}

/// Largest difference of two displacements over the largest of the second, rotations times `length`.
double difference(const Field& a, const Field& b, double length) {
  double gap = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    gap = std::max(
        {gap, (a[i].linear() - b[i].linear()).norm(), length * (a[i].angular() - b[i].angular()).norm()});
    size = std::max({size, b[i].linear().norm(), length * b[i].angular().norm()});
  }
  return gap / size;
}

/// Held on the left, pulled along x on the right by 10 um, with loads on all particles when asked for.
Body pulled_body(int edge, std::uint64_t seed, bool loaded) {
  Body body = lattice_body(edge, seed, true);
  for (std::size_t i = 0; i < body.size(); ++i)
    if (body.net.particles.position[i].x() > (edge - 1.5) * 1e-3)
      body.constraints.add({static_cast<ParticleIndex>(i), 0, 1e-5});
  if (loaded) {
    core::Random random(seed + 1);
    body.load.resize(body.size());
    for (auto& load : body.load) {
      load.linear() = random_vector(random, 1);
      load.angular() = random_vector(random, 1e-3);
    }
  }
  return body;
}

/// Springs between neighbours and to the ground that stiffen with stretch: force k (s + (s/d)^2 s), s the stretch.
/// Written for this test: it is all that DynamicRelaxation may ask of forces.
struct StiffeningSprings {
  const Network& net;
  double stiffness = 1e6; ///< N/m
  double ground = 1e4;    ///< N/m, to each particle's place, so that nothing is loose
  double scale = 1e-6;    ///< d, m

  std::size_t particle_count() const { return net.particles.size(); }
  double stretch(BondIndex b, const Field& u) const {
    return net.bonds.branch[b].normalized().dot(u[net.bonds.second[b]].linear() -
                                                u[net.bonds.first[b]].linear());
  }
  void evaluate(const Field& u, Field& force, core::ThreadPool&) const {
    for (std::size_t i = 0; i < u.size(); ++i) {
      force[i] = {};
      force[i].linear() = -ground * u[i].linear();
    }
    for (BondIndex b = 0; b < net.bonds.size(); ++b) {
      const double s = stretch(b, u), ratio = s / scale;
      const Vec3 pull = stiffness * s * (1 + ratio * ratio) * net.bonds.branch[b].normalized();
      force[net.bonds.first[b]].linear() += pull;
      force[net.bonds.second[b]].linear() -= pull;
    }
  }
  double elastic_energy(const Field& u, core::ThreadPool&) const {
    double sum = 0;
    for (const auto& entry : u)
      sum += 0.5 * ground * entry.linear().squaredNorm();
    for (BondIndex b = 0; b < net.bonds.size(); ++b) {
      const double s = stretch(b, u), ratio = s / scale;
      sum += stiffness * s * s * (0.5 + 0.25 * ratio * ratio);
    }
    return sum;
  }
  Eigen::Matrix<double, 6, 6> diagonal_block(ParticleIndex i) const {
    Eigen::Matrix<double, 6, 6> block = Eigen::Matrix<double, 6, 6>::Zero();
    block.topLeftCorner<3, 3>() = ground * Mat3::Identity();
    for (BondIndex b = 0; b < net.bonds.size(); ++b)
      if (net.bonds.first[b] == i || net.bonds.second[b] == i) {
        const Vec3 n = net.bonds.branch[b].normalized();
        block.topLeftCorner<3, 3>() += stiffness * n * n.transpose();
      }
    return block;
  }
};
static_assert(integrate::InternalForces<StiffeningSprings>);

/// A Problem of the stiffening springs and all that it refers to.
struct StiffeningBody {
  Network net;
  StiffeningSprings forces{net};
  particles::Inertia inertia;
  particles::Constraints constraints = {};

  explicit StiffeningBody(int edge, double pull) : net(shaken_lattice(edge, 21)) {
    inertia = particles::solid_spheres(net.particles, std::vector<double>{1.0, 1.0});
    for (std::size_t i = 0; i < net.particles.size(); ++i)
      for (std::uint8_t dof = 0; dof < 3; ++dof) {
        const double x = net.particles.position[i].x();
        if (x < 0.5e-3)
          constraints.add({static_cast<ParticleIndex>(i), dof, 0});
        else if (x > (edge - 1.5) * 1e-3 && dof == 0)
          constraints.add({static_cast<ParticleIndex>(i), dof, pull});
      }
  }
  Problem<StiffeningSprings> problem() const { return {forces, inertia, constraints}; }
};

} // namespace

TEST_CASE("constraints and loads: the solution of the dense system") {
  for (const bool loaded : {false, true}) {
    CAPTURE(loaded);
    const Body body = pulled_body(3, 1, loaded);
    const auto [motion, report] = solve(body.problem());
    CHECK(report.ending == integrate::Ending::tolerance);
    CHECK(report.relative_residual <= 1e-8);
    CHECK(report.retakes == 0); // the blocks bound the step for linear forces
    CHECK(report.evaluations == report.steps + report.peaks + 1);
    CHECK(difference(motion.displacement, newton(body.problem(), 1e-3, 1, 1e-6), 1e-3) < 1e-6);
    CHECK(motion.time == 0);
    CHECK(motion.step == 0);
  }
}

TEST_CASE("the same solution as StaticMultigrid, and a guess is refined") {
  const Body body = pulled_body(7, 2, true);
  core::ThreadPool pool;
  Motion reference = Motion::at_rest(body.size());
  integrate::StaticMultigrid({.relative_residual = 1e-10}).solve(body.problem(), reference, pool);
  const auto [motion, report] = solve(body.problem());
  CHECK(difference(motion.displacement, reference.displacement, 1e-3) < 1e-6);
  // what is left out of balance, against what was: by the definition, forces alone
  const Unknowns unknowns(body.problem());
  const auto norm = [&](const Field& field) {
    return out_of_balance(body.problem(), unknowns, field).norm();
  };
  CHECK(norm(motion.displacement) < 3e-8 * norm(prescribed_motion(body.constraints, body.size())));

  Motion again = reference;
  const auto refined = DynamicRelaxation().solve(body.problem(), again, pool);
  CHECK(refined.steps == 0);
  CHECK(refined.evaluations == 2);
  CHECK(same_bytes(again.displacement, reference.displacement));
}

TEST_CASE("forces that stiffen: equilibrium by Newton's method, and the least of the potential energy") {
  // at 10 um a neighbour's spring would be 100 times as stiff as at rest: the step must shrink on the way
  const StiffeningBody body(4, 1e-5);
  const auto [motion, report] = solve(body.problem(), {.relative_residual = 1e-10});
  CHECK(report.retakes > 0);
  const Unknowns unknowns(body.problem());
  const auto norm = [&](const Field& field) {
    return out_of_balance(body.problem(), unknowns, field).norm();
  };
  CHECK(norm(motion.displacement) < 1.01e-10 * norm(prescribed_motion(body.constraints, motion.size())));

  // the springs leave rotations free: hold them for Newton's method
  StiffeningBody held = body;
  for (std::size_t i = 0; i < motion.size(); ++i)
    for (std::uint8_t dof = 3; dof < 6; ++dof)
      held.constraints.add({static_cast<ParticleIndex>(i), dof, 0});
  const Problem<StiffeningSprings> problem{body.forces, body.inertia, held.constraints};
  CHECK(difference(motion.displacement, newton(problem, 1e-3, 25, 1e-10), 1e-3) < 1e-6);

  core::ThreadPool pool;
  core::Random random(5);
  const double energy = body.forces.elastic_energy(motion.displacement, pool);
  for (int trial = 0; trial < 20; ++trial) {
    Field other = motion.displacement;
    for (const auto& [particle, dof] : unknowns.list)
      if (dof < 3)
        other[particle][dof] += random.uniform(-1e-7, 1e-7);
    CHECK(body.forces.elastic_energy(other, pool) > energy);
  }
}

TEST_CASE("the same bytes on any number of threads") {
  const Body body = pulled_body(13, 3, true);
  REQUIRE(body.size() > core::block_size);
  const auto one = solve(body.problem(), {.relative_residual = 1e-4});
  for (const int threads : {2, 3}) {
    const auto many = solve(body.problem(), {.relative_residual = 1e-4}, threads);
    CHECK(same_bytes(many.motion.displacement, one.motion.displacement));
    CHECK(many.report.steps == one.report.steps);
  }
}

TEST_CASE("rattlers stay where they are, and take no load") {
  Network net = row(4, 1e-3, 0.5e-3);
  net.particles.resize(5); // the last has no bond
  net.particles.radius[4] = 0.5e-3;
  net.bonds.particle_count = 5;
  Body body(net, beam());
  for (std::uint8_t dof = 0; dof < 6; ++dof)
    body.constraints.add({0, dof, 0});
  body.constraints.add({3, 0, 3e-6});
  const auto [motion, report] = solve(body.problem());
  CHECK(motion.displacement[1][0] == doctest::Approx(1e-6).epsilon(1e-7)); // equal springs in a row
  CHECK(motion.displacement[2][0] == doctest::Approx(2e-6).epsilon(1e-7));
  CHECK(motion.displacement[4].linear() == Vec3::Zero());
  body.load.resize(5);
  body.load[4][1] = 2;
  CHECK(message_of([&] { solve(body.problem()); }) ==
        "force on particle 4 along y = 2 is not accepted: no bond of the particle resists it: 0 is expected");
}

TEST_CASE("a body that nothing holds comes to rest under balanced loads, and runs away under others") {
  Body body(row(4, 1e-3, 0.5e-3), beam());
  body.load.resize(4);
  body.load[0][0] = -5;
  body.load[3][0] = 5;
  const auto [motion, report] = solve(body.problem(), {.max_steps = 10000});
  core::ThreadPool pool;
  for (BondIndex b = 0; b < 3; ++b)
    CHECK(body.forces.load(b, motion.displacement).force.x() == doctest::Approx(5).epsilon(1e-7));
  body.load[3][0] = 6;
  CHECK(contains(message_of<NotReached>([&] { solve(body.problem(), {.max_steps = 10000}); }),
                 "is not held against its load"));
}

TEST_CASE("nothing to do: held everywhere, or at rest without load") {
  Body body(row(2, 1e-3, 0.5e-3), beam());
  CHECK(solve(body.problem()).report.steps == 0);
  for (ParticleIndex i = 0; i < 2; ++i)
    for (std::uint8_t dof = 0; dof < 6; ++dof)
      body.constraints.add({i, dof, 1e-6 * i});
  const auto [motion, report] = solve(body.problem());
  CHECK(report.steps == 0);
  CHECK(motion.displacement[1][4] == 1e-6);
}

TEST_CASE("without load or prescribed motion, a guess relaxes to rest") {
  Body body = lattice_body(3, 6, true);
  Motion motion = shaken(body, 7);
  core::ThreadPool pool;
  const double before = body.forces.elastic_energy(motion.displacement, pool);
  const Motion start = motion;
  const auto report = DynamicRelaxation().solve(body.problem(), motion, pool);
  CHECK(report.relative_residual <= 1e-8);
  CHECK(body.forces.elastic_energy(motion.displacement, pool) < 1e-12 * before);
  CHECK(same_bytes(motion.velocity, start.velocity)); // the motion's own state is left alone
}

TEST_CASE("too few steps: says the residual reached, and the motion can go on") {
  const Body body = pulled_body(4, 8, false);
  core::ThreadPool pool;
  Motion motion = Motion::at_rest(body.size());
  const auto message = message_of<NotReached>(
      [&] { DynamicRelaxation({.max_steps = 20}).solve(body.problem(), motion, pool); });
  CHECK(contains(message, "dynamic relaxation: relative residual 0.0"));
  CHECK(contains(message, "after 20 steps, 1e-08 was asked for. Likely cause: more steps may suffice"));
  const auto report = DynamicRelaxation().solve(body.problem(), motion, pool);
  CHECK(report.relative_residual <= 1e-8);
}

TEST_CASE("interrupted between two steps: the motion is that of a whole step") {
  const Body body = pulled_body(4, 8, false);
  core::ThreadPool pool;
  Motion motion = Motion::at_rest(body.size()), short_of_it = motion;
  const std::atomic<bool> stop = true; // noticed after the first step
  const auto message = message_of<Interrupted>(
      [&] { DynamicRelaxation().solve(body.problem(), motion, pool, core::Monitor({}, &stop)); });
  CHECK(contains(message, "dynamic relaxation interrupted at "));
  CHECK(contains(message, "step 1, relative residual 0."));
  CHECK_THROWS_AS(DynamicRelaxation({.max_steps = 1}).solve(body.problem(), short_of_it, pool), NotReached);
  CHECK(same_bytes(motion.displacement, short_of_it.displacement));
}

TEST_CASE("forces that are not finite are reported, at once or on the way") {
  struct Broken : StiffeningSprings {
    int good; ///< evaluations before they break
    mutable int done = 0;
    Broken(const Network& network, int evaluations) : StiffeningSprings{network}, good(evaluations) {}
    void evaluate(const Field& u, Field& force, core::ThreadPool& pool) const {
      StiffeningSprings::evaluate(u, force, pool);
      if (++done > good)
        force[13][1] = std::numeric_limits<double>::quiet_NaN();
    }
  };
  const StiffeningBody body(3, 1e-6);
  core::ThreadPool pool;
  for (int good = 0; good < 10; ++good) {
    CAPTURE(good);
    const Broken broken(body.net, good);
    Motion motion = Motion::at_rest(27);
    const auto message = message_of<NotReached>([&] {
      DynamicRelaxation().solve(Problem<Broken>{broken, body.inertia, body.constraints}, motion, pool);
    });
    if (good == 0)
      CHECK(message == "dynamic relaxation: the forces at the initial displacement are not finite");
    else
      CHECK(contains(message, "Likely cause: the forces are not finite"));
    CHECK(std::isfinite(motion.displacement[13][1])); // what is left can be looked at
  }
}

TEST_CASE("bad input is refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, 1.0, -1e-8, nan})
    CHECK(message_of([&] { DynamicRelaxation relaxation({.relative_residual = bad}); }) ==
          "relative_residual of the dynamic relaxation = " + core::to_text(bad) +
              " is not accepted: a number between 0 and 1 is expected");
  CHECK(message_of([] { DynamicRelaxation relaxation({.max_steps = 0}); }) ==
        "max_steps of the dynamic relaxation = 0 is not accepted: at least 1 is expected");
  Body body = pulled_body(3, 9, true);
  core::ThreadPool pool;
  Motion motion = Motion::at_rest(body.size());
  const auto message = [&] {
    return message_of([&] { DynamicRelaxation().solve(body.problem(), motion, pool); });
  };
  SUBCASE("guess") {
    motion.displacement[2][4] = nan;
    CHECK(contains(message(), "initial displacement of particle 2, degree of freedom 4 = nan"));
  }
  SUBCASE("size of the guess") {
    motion.displacement.resize(3);
    CHECK(contains(message(), "number of entries of the initial displacement = 3"));
  }
  SUBCASE("load") {
    body.load[1][2] = nan;
    CHECK(contains(message(), "load of particle 1, degree of freedom 2 = nan"));
  }
  SUBCASE("constraint") {
    body.constraints.add({99, 0, 0});
    CHECK(contains(message(), "constrained particle = 99 is not accepted"));
  }
}
