#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/bond/spring.hpp>
#include <cdem/core/random.hpp>
#include <cdem/integrate/static_multigrid.hpp>

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <numbers>
#include <optional>
#include <string>

using namespace cdem;

namespace {

/// Particles with the bonds between them, of which forces are made.
struct Body {
  particles::ParticleSet particles;
  network::BondNetwork network;

  ParticleIndex add(const Vec3& position, double radius = 0.5, PhaseIndex phase = 0) {
    particles.position.push_back(position);
    particles.radius.push_back(radius);
    particles.phase.push_back(phase);
    network.particle_count = particles.size();
    return static_cast<ParticleIndex>(particles.size() - 1);
  }
  void join(ParticleIndex first, ParticleIndex second) {
    join(first, second, particles.position[second] - particles.position[first]);
  }
  /// Bonds stay sorted by (first, second), as a network's must.
  void join(ParticleIndex first, ParticleIndex second, const Vec3& branch) {
    std::size_t place = network.size();
    while (place > 0 &&
           std::pair(network.first[place - 1], network.second[place - 1]) > std::pair(first, second))
      --place;
    const auto at = static_cast<std::ptrdiff_t>(place);
    network.first.insert(network.first.begin() + at, first);
    network.second.insert(network.second.begin() + at, second);
    network.branch.insert(network.branch.begin() + at, branch);
  }
};

/// Random points no closer than 0.8, joined where closer than 1.4, in a box of `edge`: rattlers and dangling parts
/// included.
Body random_body(std::size_t count, double edge, std::uint64_t seed) {
  core::Random random(seed);
  Body body;
  for (int attempt = 0; body.particles.size() < count && attempt < 1000000; ++attempt) {
    const Vec3 point(random.uniform(0, edge), random.uniform(0, edge), random.uniform(0, edge));
    const auto close = [&](const Vec3& other) { return (other - point).norm() < 0.8; };
    if (std::none_of(body.particles.position.begin(), body.particles.position.end(), close))
      body.add(point, random.uniform(0.35, 0.65), point.x() > edge / 2 ? 1 : 0);
  }
  REQUIRE(body.particles.size() == count);
  for (ParticleIndex i = 0; i < count; ++i)
    for (ParticleIndex j = i + 1; j < count; ++j)
      if ((body.particles.position[i] - body.particles.position[j]).norm() < 1.4)
        body.join(i, j);
  return body;
}

/// Simple cubic lattice of edge^3 particles a distance 1 apart.
Body lattice(int edge) {
  Body body;
  const auto number = [&](int x, int y, int z) {
    return static_cast<ParticleIndex>((x * edge + y) * edge + z);
  };
  for (int x = 0; x < edge; ++x)
    for (int y = 0; y < edge; ++y)
      for (int z = 0; z < edge; ++z)
        body.add(Vec3(x, y, z));
  for (int x = 0; x < edge; ++x)
    for (int y = 0; y < edge; ++y)
      for (int z = 0; z < edge; ++z) {
        if (z + 1 < edge)
          body.join(number(x, y, z), number(x, y, z + 1));
        if (y + 1 < edge)
          body.join(number(x, y, z), number(x, y + 1, z));
        if (x + 1 < edge)
          body.join(number(x, y, z), number(x + 1, y, z));
      }
  return body;
}

/// Simple cubic lattice of edge^3 particles of random radii, periodic in every direction.
Body periodic_lattice(int edge) {
  Body body;
  const auto number = [&](int x, int y, int z) {
    return static_cast<ParticleIndex>(((x % edge) * edge + y % edge) * edge + z % edge);
  };
  core::Random random(2);
  for (int i = 0; i < edge * edge * edge; ++i)
    body.add(Vec3(i / edge / edge, i / edge % edge, i % edge), random.uniform(0.3, 0.5));
  for (int x = 0; x < edge; ++x)
    for (int y = 0; y < edge; ++y)
      for (int z = 0; z < edge; ++z) {
        const ParticleIndex here = number(x, y, z);
        for (const auto& [there, branch] :
             {std::pair{number(x + 1, y, z), Vec3(1, 0, 0)}, std::pair{number(x, y + 1, z), Vec3(0, 1, 0)},
              std::pair{number(x, y, z + 1), Vec3(0, 0, 1)}})
          body.join(std::min(here, there), std::max(here, there), here < there ? branch : Vec3(-branch));
      }
  return body;
}

/// The balanced loads of a mean strain along x.
particles::SpatialField<> loads_of_strain(const bond::LinearForces& forces, double strain) {
  particles::SpatialField<> load(forces.particle_count());
  for (BondIndex b = 0; b < forces.bond_count(); ++b) {
    const Vec3 pull = forces.stiffness(b).normal * strain * forces.direction(b).x() * forces.length(b) *
                      forces.direction(b);
    load[forces.ends(b).first].linear() += pull;
    load[forces.ends(b).second].linear() -= pull;
  }
  return load;
}

bond::Beam<> beams(double youngs_modulus, double radius_ratio, double contrast = 1) {
  return bond::Beam<>({{{youngs_modulus, radius_ratio}, {youngs_modulus * contrast, radius_ratio}}, {}});
}

particles::Inertia unit_inertia(std::size_t count) {
  return {std::vector<double>(count, 1), std::vector<double>(count, 1)};
}

struct Solution {
  particles::Motion motion;
  integrate::StaticMultigrid::Report report;
};

Solution solve(const bond::LinearForces& forces, const particles::Constraints& constraints,
               const particles::SpatialField<>* load = nullptr, int threads = 1,
               integrate::StaticMultigrid::Parameters parameters = {}) {
  core::ThreadPool pool(threads);
  const auto inertia = unit_inertia(forces.particle_count());
  const integrate::Problem<bond::LinearForces> problem{forces, inertia, constraints, load};
  Solution solution{particles::Motion::at_rest(forces.particle_count()), {}};
  solution.report = integrate::StaticMultigrid(parameters).solve(problem, solution.motion, pool);
  return solution;
}

/// Message of the InvalidInput that solve() throws.
std::string refusal(const bond::LinearForces& forces, const particles::Constraints& constraints,
                    const particles::SpatialField<>* load = nullptr) {
  try {
    solve(forces, constraints, load);
  } catch (const core::InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

void hold(particles::Constraints& constraints, ParticleIndex particle) {
  for (std::uint8_t dof = 0; dof < 6; ++dof)
    constraints.add({particle, dof, 0});
}

/// Holds the particles below x = 1 along x, y, z and moves those from edge - 1 on by `pull` along x.
particles::Constraints pulled_along_x(const Body& body, double edge, double pull) {
  particles::Constraints constraints;
  for (ParticleIndex i = 0; i < body.particles.size(); ++i) {
    const double x = body.particles.position[i].x();
    if (x < 1)
      for (std::uint8_t dof = 0; dof < 3; ++dof)
        constraints.add({i, dof, 0});
    if (x >= edge - 1)
      constraints.add({i, 0, pull});
  }
  return constraints;
}

/// Stiffness matrix, column by column from the internal forces.
Eigen::MatrixXd dense_stiffness(const bond::LinearForces& forces) {
  core::ThreadPool pool;
  const auto unknowns = static_cast<Eigen::Index>(6 * forces.particle_count());
  Eigen::MatrixXd matrix(unknowns, unknowns);
  particles::SpatialField<> unit(forces.particle_count()), force(forces.particle_count());
  for (Eigen::Index column = 0; column < unknowns; ++column) {
    unit[static_cast<std::size_t>(column / 6)][static_cast<int>(column % 6)] = 1;
    forces.evaluate(unit, force, pool);
    unit[static_cast<std::size_t>(column / 6)][static_cast<int>(column % 6)] = 0;
    for (Eigen::Index row = 0; row < unknowns; ++row)
      matrix(row, column) = -force[static_cast<std::size_t>(row / 6)][static_cast<int>(row % 6)];
  }
  return matrix;
}

/// The same problem by a dense factorisation of least norm; least_norm: of a matrix that may be singular.
Eigen::VectorXd dense_solution(const bond::LinearForces& forces, const particles::Constraints& constraints,
                               const particles::SpatialField<>* load = nullptr) {
  const Eigen::MatrixXd stiffness = dense_stiffness(forces);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(stiffness.rows());
  std::vector<bool> held(static_cast<std::size_t>(u.size()), false);
  for (const auto& constraint : constraints.list()) {
    const std::size_t unknown = 6 * std::size_t{constraint.particle} + constraint.dof;
    held[unknown] = true;
    u[static_cast<Eigen::Index>(unknown)] = constraint.rate;
  }
  Eigen::VectorXd rhs = -stiffness * u;
  if (load)
    for (Eigen::Index k = 0; k < rhs.size(); ++k)
      rhs[k] += (*load)[static_cast<std::size_t>(k / 6)][static_cast<int>(k % 6)];
  std::vector<Eigen::Index> unknowns;
  for (Eigen::Index k = 0; k < u.size(); ++k)
    if (!held[static_cast<std::size_t>(k)])
      unknowns.push_back(k);
  const auto count = static_cast<Eigen::Index>(unknowns.size());
  Eigen::MatrixXd matrix(count, count);
  Eigen::VectorXd reduced(count);
  for (Eigen::Index r = 0; r < count; ++r) {
    reduced[r] = rhs[unknowns[static_cast<std::size_t>(r)]];
    for (Eigen::Index c = 0; c < count; ++c)
      matrix(r, c) = stiffness(unknowns[static_cast<std::size_t>(r)], unknowns[static_cast<std::size_t>(c)]);
  }
  const Eigen::VectorXd x = matrix.completeOrthogonalDecomposition().solve(reduced);
  for (Eigen::Index k = 0; k < count; ++k)
    u[unknowns[static_cast<std::size_t>(k)]] = x[k];
  return u;
}

Eigen::VectorXd flat(const particles::SpatialField<>& field) {
  Eigen::VectorXd u(static_cast<Eigen::Index>(6 * field.size()));
  for (Eigen::Index k = 0; k < u.size(); ++k)
    u[k] = field[static_cast<std::size_t>(k / 6)][static_cast<int>(k % 6)];
  return u;
}

double difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

} // namespace

TEST_CASE("The solution is that of a dense factorisation, whatever the contrast and the beams' slenderness") {
  const Body body = random_body(90, 4.4, 7);
  const particles::Constraints constraints = pulled_along_x(body, 4.4, 0.01);
  for (const double radius_ratio : {0.1, 0.545, 1.0})
    for (const double contrast : {1e-4, 1.0, 1e4}) {
      CAPTURE(radius_ratio);
      CAPTURE(contrast);
      const bond::LinearForces forces(beams(1e9, radius_ratio, contrast), body.particles, body.network);
      const Solution solution =
          solve(forces, constraints, nullptr, 1, {.relative_residual = 1e-11, .group_size = 6});
      CHECK(solution.report.relative_residual <= 1e-11);
      CHECK(difference(flat(solution.motion.displacement), dense_solution(forces, constraints)) < 1e-5);
    }
}

TEST_CASE("Loads, prescribed rotations and an initial guess") {
  const Body body = random_body(90, 4.4, 3);
  const bond::LinearForces forces(beams(1e9, 0.5), body.particles, body.network);
  particles::Constraints constraints = pulled_along_x(body, 4.4, 0);
  core::Random random(4);
  particles::SpatialField<> load(body.particles.size());
  for (ParticleIndex i = 0; i < body.particles.size(); ++i)
    if (forces.bonds_of(i).size() > 1)
      for (int d = 0; d < 6; ++d)
        load[i][d] = 1e5 * random.normal();
  const auto middle = static_cast<ParticleIndex>(
      std::min_element(body.particles.position.begin(), body.particles.position.end(),
                       [](const Vec3& a, const Vec3& b) {
                         return (a - Vec3::Constant(2.2)).norm() < (b - Vec3::Constant(2.2)).norm();
                       }) -
      body.particles.position.begin());
  constraints.add({middle, 5, 0.02});
  const Eigen::VectorXd expected = dense_solution(forces, constraints, &load);

  Solution solution = solve(forces, constraints, &load, 1, {.relative_residual = 1e-11});
  CHECK(difference(flat(solution.motion.displacement), expected) < 1e-6);
  CHECK(solution.motion.displacement[middle][5] == 0.02);

  SUBCASE("started from the solution, nothing is left to do") {
    core::ThreadPool pool;
    const auto inertia = unit_inertia(forces.particle_count());
    const integrate::Problem<bond::LinearForces> problem{forces, inertia, constraints, &load};
    const auto report = integrate::StaticMultigrid().solve(problem, solution.motion, pool);
    CHECK(report.iterations == 0);
    CHECK(difference(flat(solution.motion.displacement), expected) < 1e-6);
  }
}

TEST_CASE("Dangling chains of soft beams carry nothing") {
  Body body = lattice(8);
  const auto grown = static_cast<ParticleIndex>(body.particles.size());
  for (ParticleIndex i = 0; i < grown; i += 5) { // each of three particles around a corner
    ParticleIndex last = i;
    for (const Vec3& way : {Vec3(0.3, 0.4, 0.2), Vec3(-0.4, 0.3, 0.2), Vec3(0.2, -0.3, 0.4)}) {
      const ParticleIndex next = body.add(body.particles.position[last] + way);
      body.join(last, next);
      last = next;
    }
  }
  const bond::LinearForces forces(beams(1e9, 0.15), body.particles, body.network);
  particles::Constraints constraints;
  for (ParticleIndex i = 0; i < grown; ++i) {
    const double x = body.particles.position[i].x();
    if (x == 0 || x == 7)
      for (std::uint8_t dof = 0; dof < 3; ++dof)
        constraints.add({i, dof, x == 0 || dof > 0 ? 0 : 0.01});
  }
  const Solution solution = solve(forces, constraints);
  const Solution without = [&] {
    const Body bare = lattice(8);
    const bond::LinearForces bare_forces(beams(1e9, 0.15), bare.particles, bare.network);
    return solve(bare_forces, constraints);
  }();
  for (ParticleIndex i = 0; i < grown; ++i)
    CHECK((solution.motion.displacement[i].linear() - without.motion.displacement[i].linear()).norm() < 1e-7);
}

// The slender chain bends a million times what its bonds stretch: rounding allows a residual of 1e-10, not less.
TEST_CASE("A chain of beams bends like the exact cantilever") {
  const int bonds = 40;
  const double length = bonds, force = 3.0, youngs_modulus = 1e6, radius_ratio = 0.5;
  Body body;
  for (int i = 0; i <= bonds; ++i)
    body.add(Vec3(0, 0, i));
  for (ParticleIndex i = 0; i < bonds; ++i)
    body.join(i, i + 1);
  const bond::LinearForces forces(beams(youngs_modulus, radius_ratio), body.particles, body.network);
  const double beam_radius = radius_ratio * 0.5;
  const double second_moment = std::numbers::pi * std::pow(beam_radius, 4) / 4;
  particles::Constraints constraints;
  hold(constraints, 0);
  particles::SpatialField<> load(body.particles.size());
  load[bonds][0] = force;
  const Solution solution = solve(forces, constraints, &load, 1, {.relative_residual = 1e-9});
  const double bending = youngs_modulus * second_moment;
  CHECK(solution.motion.displacement[bonds][0] ==
        doctest::Approx(force * std::pow(length, 3) / (3 * bending)).epsilon(1e-6));
  CHECK(solution.motion.displacement[bonds][4] ==
        doctest::Approx(force * length * length / (2 * bending)).epsilon(1e-6));
}

TEST_CASE("A simple cubic lattice in tension has its exact modulus") {
  const int edge = 12;
  const Body body = lattice(edge);
  const bond::LinearForces forces(beams(1e9, 0.6), body.particles, body.network);
  const particles::Constraints constraints = [&] {
    particles::Constraints list;
    for (ParticleIndex i = 0; i < body.particles.size(); ++i) {
      const Vec3& x = body.particles.position[i];
      if (x.x() == 0)
        list.add({i, 0, 0});
      if (x.x() == edge - 1)
        list.add({i, 0, 1e-3});
      if (x.y() == 0)
        list.add({i, 1, 0});
      if (x.z() == 0)
        list.add({i, 2, 0});
    }
    return list;
  }();
  const Solution solution = solve(forces, constraints);
  // Rows of beams along x in parallel: E A / 1 each, strain 1e-3 / (edge - 1), no lateral contraction.
  core::ThreadPool pool;
  particles::SpatialField<> force(body.particles.size());
  forces.evaluate(solution.motion.displacement, force, pool);
  double low = 0, high = 0;
  for (ParticleIndex i = 0; i < body.particles.size(); ++i) {
    if (body.particles.position[i].x() == 0)
      low -= force[i][0];
    if (body.particles.position[i].x() == edge - 1)
      high -= force[i][0];
  }
  const double exact = edge * edge * 1e9 * std::numbers::pi * 0.3 * 0.3 * 1e-3 / (edge - 1);
  CHECK(high == doctest::Approx(exact).epsilon(1e-7));
  CHECK(low == doctest::Approx(-exact).epsilon(1e-7)); // the reactions balance
}

TEST_CASE("A prescribed rigid motion strains nothing") {
  const double edge = 9;
  const Body body = random_body(800, edge, 11);
  const bond::LinearForces forces(beams(1e9, 0.3, 100), body.particles, body.network);
  const Vec3 shift(1e-3, -2e-3, 3e-3), turn(2e-3, 1e-3, -1e-3);
  const auto rigid = [&](ParticleIndex i) -> Vec3 { return shift + turn.cross(body.particles.position[i]); };
  particles::Constraints constraints;
  for (ParticleIndex i = 0; i < body.particles.size(); ++i)
    if (body.particles.position[i].x() < 1 || body.particles.position[i].x() > edge - 1)
      for (std::uint8_t dof = 0; dof < 3; ++dof)
        constraints.add({i, dof, rigid(i)[dof]});
  const Solution solution = solve(forces, constraints, nullptr, 1, {.relative_residual = 1e-10});
  CHECK(solution.report.levels.size() >= 2);
  core::ThreadPool pool;
  const double stiffness = forces.stiffness(0).normal;
  CHECK(forces.elastic_energy(solution.motion.displacement, pool) < 1e-12 * stiffness * shift.squaredNorm());
  for (ParticleIndex i = 0; i < body.particles.size(); ++i)
    if (forces.bonds_of(i).size() > 2)
      CHECK((solution.motion.displacement[i].linear() - rigid(i)).norm() < 1e-6 * shift.norm());
}

TEST_CASE("Networks of springs are solved in the range, and their floppy modes are counted") {
  const Body body = random_body(90, 4.4, 7);
  const particles::Constraints constraints = pulled_along_x(body, 4.4, 0.01);
  std::size_t turning = 0; // particles with a bond, outside the clusters left at rest
  for (const double ratio : {0.0, 0.3}) {
    CAPTURE(ratio);
    const bond::LinearForces forces(bond::Spring<>({{{1e9, 0.5}, {1e9, 0.5}}, ratio, {}}), body.particles,
                                    body.network);
    const Solution solution = solve(forces, constraints, nullptr, 1, {.relative_residual = 1e-10});
    turning = static_cast<std::size_t>(std::count_if(
                  body.particles.radius.begin(), body.particles.radius.end(),
                  [&, i = ParticleIndex{0}](double) mutable { return forces.bonds_of(i++).size() > 0; })) -
              solution.report.floating_particles;
    core::ThreadPool pool;
    particles::SpatialField<> exact(body.particles.size());
    const Eigen::VectorXd u = dense_solution(forces, constraints);
    for (Eigen::Index k = 0; k < u.size(); ++k)
      exact[static_cast<std::size_t>(k / 6)][static_cast<int>(k % 6)] = u[k];
    // The displacement of a floppy mode is not determined; the energy is.
    CHECK(forces.elastic_energy(solution.motion.displacement, pool) ==
          doctest::Approx(forces.elastic_energy(exact, pool)).epsilon(1e-7));
    if (ratio == 0)
      CHECK(solution.report.floppy_modes_at_least >= 3 * turning); // rotations meet nothing
    else
      CHECK(solution.report.floppy_modes_at_least == 0);
  }
}

TEST_CASE("Rattlers and floating clusters are left at rest and counted") {
  Body body = lattice(4);
  body.add(Vec3(10, 0, 0));
  const ParticleIndex a = body.add(Vec3(12, 0, 0)), b = body.add(Vec3(13, 0, 0));
  body.join(a, b);
  const ParticleIndex hanging = body.add(Vec3(3, 3, 4)); // by one bond
  body.join(63, hanging);
  const bond::LinearForces forces(beams(1e9, 0.5), body.particles, body.network);
  particles::Constraints constraints = pulled_along_x(body, 4, 0.01);
  // pulled_along_x() sees the strays as part of the far face: take the lattice alone
  particles::Constraints lattice_alone;
  for (const auto& constraint : constraints.list())
    if (constraint.particle < 64)
      lattice_alone.add(constraint);
  const Solution solution = solve(forces, lattice_alone);
  CHECK(solution.report.rattlers == 1);
  CHECK(solution.report.floating_clusters == 1);
  CHECK(solution.report.floating_particles == 2);
  for (const ParticleIndex i : {ParticleIndex{64}, a, b})
    CHECK(solution.motion.displacement[i].linear().norm() == 0);
  // One bond carries nothing: what hangs by it follows rigidly.
  const auto& carrier = solution.motion.displacement[63];
  const Vec3 follows = carrier.linear() + carrier.angular().cross(Vec3::UnitZ());
  CHECK((solution.motion.displacement[hanging].linear() - follows).norm() < 1e-8);

  SUBCASE("a load on the floating cluster is refused") {
    particles::SpatialField<> load(body.particles.size());
    load[b][1] = 1;
    const std::string message = refusal(forces, lattice_alone, &load);
    CHECK(message.find("2 particle(s), the first is 65") != std::string::npos);
    CHECK(message.find("translation along y") != std::string::npos);
  }
  SUBCASE("so is one on the rattler") {
    particles::SpatialField<> load(body.particles.size());
    load[64][0] = 1;
    CHECK(refusal(forces, lattice_alone, &load).find("the first is 64") != std::string::npos);
  }
  SUBCASE("a cluster moved by one constraint is loose, and moves") {
    lattice_alone.add({a, 0, 0.5});
    const Solution moved = solve(forces, lattice_alone, nullptr, 1, {.relative_residual = 1e-10});
    CHECK(moved.report.loose_clusters == 1);
    CHECK(moved.motion.displacement[b][0] == doctest::Approx(0.5));
  }
}

TEST_CASE("An interface without stiffness parts the body") {
  const Body body = lattice(6);
  struct Cut {
    bond::ChannelStiffness stiffness(const bond::BondGeometry& bond) const {
      return bond.phase_first != bond.phase_second ? bond::ChannelStiffness{} : inside.stiffness(bond);
    }
    void validate(const particles::ParticleSet& particles) const { inside.validate(particles); }
    bond::Beam<> inside;
  };
  Body parted = body;
  for (ParticleIndex i = 0; i < body.particles.size(); ++i)
    parted.particles.phase[i] = body.particles.position[i].x() > 2.5 ? 1 : 0;
  const bond::LinearForces forces(Cut{beams(1e9, 0.5, 1)}, parted.particles, parted.network);
  const particles::Constraints constraints = [&] {
    particles::Constraints list;
    for (ParticleIndex i = 0; i < body.particles.size(); ++i)
      for (std::uint8_t dof = 0; dof < 3; ++dof) {
        if (body.particles.position[i].x() == 0)
          list.add({i, dof, 0});
        if (body.particles.position[i].x() == 5)
          list.add({i, dof, dof == 0 ? 0.1 : 0});
      }
    return list;
  }();
  const Solution solution = solve(forces, constraints, nullptr, 1, {.relative_residual = 1e-10});
  for (ParticleIndex i = 0; i < body.particles.size(); ++i)
    CHECK(solution.motion.displacement[i][0] ==
          doctest::Approx(parted.particles.phase[i] ? 0.1 : 0).epsilon(1e-7));
}

TEST_CASE("A body that is not held is refused, and its free motions are named") {
  const Body body = lattice(3);
  const bond::LinearForces forces(beams(1e9, 0.5), body.particles, body.network);
  particles::Constraints constraints;
  const std::string free = refusal(forces, constraints);
  for (const char* motion : {"translation along x", "translation along y", "translation along z",
                             "rotation about x", "rotation about y", "rotation about z", "27 particle(s)"})
    CHECK(free.find(motion) != std::string::npos);

  for (ParticleIndex i = 0; i < 9; ++i)
    constraints.add({i, 0, 0}); // the face x = 0 on a frictionless plane
  const std::string sliding = refusal(forces, constraints);
  CHECK(sliding.find("translation along x") == std::string::npos);
  CHECK(sliding.find("translation along y, translation along z, rotation about x is not accepted") !=
        std::string::npos);

  constraints.add({0, 1, 0});
  constraints.add({0, 2, 0});
  CHECK(refusal(forces, constraints).find("= rotation about x is not accepted") != std::string::npos);
  constraints.add({1, 1, 0});
  CHECK(refusal(forces, constraints) == "accepted");
}

TEST_CASE("A ring of bonds through a periodic face cannot turn, and its translation is taken out") {
  const Body body = periodic_lattice(4);
  const bond::LinearForces forces(beams(1e9, 0.5), body.particles, body.network);
  const particles::SpatialField<> load = loads_of_strain(forces, 1e-3);
  const particles::Constraints constraints;
  const Solution solution =
      solve(forces, constraints, &load, 1, {.relative_residual = 1e-10, .group_size = 5});
  const Eigen::VectorXd exact = dense_solution(forces, constraints, &load); // of least norm
  CHECK(difference(flat(solution.motion.displacement), exact) < 1e-6);
  Vec3 mean = Vec3::Zero();
  for (const auto& u : solution.motion.displacement)
    mean += u.linear();
  CHECK(mean.norm() < 1e-12);
}

TEST_CASE(
    "Neither the translation of a free periodic body nor a loaded cluster in it grows out of rounding") {
  Body body = periodic_lattice(12);
  const ParticleIndex a = body.add(Vec3(0.5, 0.5, 0.5), 0.1), b = body.add(Vec3(0.7, 0.5, 0.5), 0.1);
  body.join(a, b);
  const bond::LinearForces forces(beams(1e9, 0.5), body.particles, body.network);
  const particles::SpatialField<> load = loads_of_strain(forces, 1e-3);
  // far below the 1e-8 that is usual: there is time for what grows to be seen
  const Solution solution = solve(forces, {}, &load, 1, {.relative_residual = 1e-14, .max_iterations = 60});
  CHECK(solution.report.relative_residual <= 1e-14);
  const auto& u = solution.motion.displacement;
  CHECK(u[b][0] - u[a][0] == doctest::Approx(-1e-3 * 0.2)); // takes back all of the strain
  CHECK(u[a].linear().norm() <= 1e-3);                      // though nothing holds it
}

TEST_CASE("The same bytes for 1, 2 and 4 threads") {
  const Body body = lattice(20); // several blocks of particles and of groups
  const bond::LinearForces forces(beams(1e9, 0.4), body.particles, body.network);
  const particles::Constraints constraints = pulled_along_x(body, 20, 0.01);
  const Solution one = solve(forces, constraints);
  CHECK(one.report.iterations > 5);
  for (const int threads : {2, 4}) {
    const Solution several = solve(forces, constraints, nullptr, threads);
    CHECK(std::memcmp(one.motion.displacement.data(), several.motion.displacement.data(),
                      one.motion.size() * sizeof(one.motion.displacement[0])) == 0);
    CHECK(one.report.history == several.report.history);
  }
}

TEST_CASE("Parameters and problems that are not accepted") {
  using integrate::StaticMultigrid;
  CHECK_THROWS_WITH_AS(
      StaticMultigrid({.relative_residual = 0}),
      "relative_residual of the static multigrid = 0 is not accepted: a number between 0 and 1 is expected",
      core::InvalidInput);
  CHECK_THROWS_AS(StaticMultigrid({.relative_residual = std::nan("")}), core::InvalidInput);
  CHECK_THROWS_AS(StaticMultigrid({.max_iterations = 0}), core::InvalidInput);
  CHECK_THROWS_AS(StaticMultigrid({.group_size = 1}), core::InvalidInput);
  CHECK_THROWS_AS(StaticMultigrid({.smoothing_steps = 0}), core::InvalidInput);

  const Body body = lattice(3);
  const bond::LinearForces forces(beams(1e9, 0.5), body.particles, body.network);
  const particles::Constraints constraints = pulled_along_x(body, 3, 0.01);
  const auto inertia = unit_inertia(27);
  const integrate::Problem<bond::LinearForces> problem{forces, inertia, constraints};
  core::ThreadPool pool;
  SUBCASE("a motion of another size") {
    auto motion = particles::Motion::at_rest(26);
    CHECK_THROWS_AS(StaticMultigrid().solve(problem, motion, pool), core::InvalidInput);
  }
  SUBCASE("an initial guess that is not a number") {
    auto motion = particles::Motion::at_rest(27);
    motion.displacement[13][2] = std::nan("");
    CHECK_THROWS_AS(StaticMultigrid().solve(problem, motion, pool), core::InvalidInput);
  }
  SUBCASE("a moment that no bond resists") {
    const bond::LinearForces springs(bond::Spring<>({{{1e9, 0.5}}, 0, {}}), body.particles, body.network);
    particles::SpatialField<> load(27);
    load[13][4] = 1;
    CHECK(refusal(springs, constraints, &load).find("moment on particle 13 along y = 1") !=
          std::string::npos);
  }
  SUBCASE("too few iterations") {
    const Body large = lattice(8);
    const bond::LinearForces many(beams(1e9, 0.5), large.particles, large.network);
    const auto masses = unit_inertia(512);
    const particles::Constraints pull = pulled_along_x(large, 8, 0.01);
    auto motion = particles::Motion::at_rest(512);
    CHECK_THROWS_AS(StaticMultigrid({.relative_residual = 1e-12, .max_iterations = 1})
                        .solve(integrate::Problem<bond::LinearForces>{many, masses, pull}, motion, pool),
                    core::NotReached);
  }
  SUBCASE("a stop asked for") {
    const std::atomic<bool> stop{true};
    auto motion = particles::Motion::at_rest(27);
    CHECK_THROWS_AS(StaticMultigrid().solve(problem, motion, pool, core::Monitor({}, &stop)),
                    core::Interrupted);
  }
}
