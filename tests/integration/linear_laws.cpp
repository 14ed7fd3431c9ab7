// Statics and dynamics give the same answer for every linear law.

#include <cdem/bond/debonded_interface.hpp>
#include <cdem/bond/forces_of.hpp>
#include <cdem/bond/spring.hpp>
#include <cdem/bond/timoshenko_beam.hpp>
#include <cdem/integrate/critical_time_step.hpp>
#include <cdem/integrate/dynamic_relaxation.hpp>
#include <cdem/integrate/static_multigrid.hpp>
#include <cdem/integrate/velocity_verlet.hpp>

#include <doctest/doctest.h>

#include "bodies.hpp"
#include "unit/bond/laws.hpp"

namespace {

using namespace cdem;

const std::vector<bond::Material> materials{{2e9, 0.6}, {10e9, 0.5}};

/// A disordered cube of two phases whose lower side is held and whose upper is moved, sheared and pulled.
struct Test {
  simulation::Specimen specimen = bodies::shaken_cube(5, 1e-3, 7.5, 3);
  particles::Constraints constraints;
  particles::Inertia inertia;

  Test() {
    for (std::size_t i = 0; i < specimen.particles.size(); ++i) {
      const Vec3& x = specimen.particles.position[i];
      specimen.particles.phase[i] = x.y() > 2.5e-3 ? 1 : 0;
      if (x.x() > 1e-3 && x.x() < 4e-3)
        continue;
      for (std::uint8_t dof = 0; dof < 6; ++dof)
        constraints.add({static_cast<ParticleIndex>(i), dof, x.x() > 4e-3 && dof < 2 ? 1e-6 : 0});
    }
    inertia = particles::solid_spheres(specimen.particles, std::vector{2000.0, 3000.0});
  }
};

double apart(const particles::Motion& a, const particles::Motion& b) {
  double difference = 0, largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int dof = 0; dof < 3; ++dof) {
      difference = std::max(difference, std::abs(a.displacement[i][dof] - b.displacement[i][dof]));
      largest = std::max(largest, std::abs(a.displacement[i][dof]));
    }
  return difference / largest;
}

/// The multigrid's solution, dynamic relaxation's, and where a damped motion ends.
template <class Law>
particles::Motion solved(const Law& law) {
  const Test test;
  using Forces = bond::ForcesOf<Law>;
  const Forces forces(law, test.specimen.particles, test.specimen.network);
  const integrate::Problem<Forces> problem{forces, test.inertia, test.constraints};
  core::ThreadPool pool(2);
  const auto at_rest = [&] { return particles::Motion::at_rest(test.specimen.particles.size()); };
  auto multigrid = at_rest(), relaxed = at_rest(), moved = at_rest();
  integrate::StaticMultigrid({.relative_residual = 1e-12}).solve(problem, multigrid, pool);
  integrate::DynamicRelaxation({.relative_residual = 1e-10}).solve(problem, relaxed, pool);
  CHECK(apart(relaxed, multigrid) < 1e-8);

  // from the guess of a uniform strain, held where the constraints end: damped to rest
  particles::Constraints held;
  for (const auto& constraint : test.constraints.list())
    held.add({constraint.particle, constraint.dof, 0});
  std::vector<Vec3> reactions;
  const double time_step = 0.8 * integrate::critical_time_step(forces, test.inertia).time_step;
  particles::SpatialField<> load(moved.size()), prescribed(moved.size());
  for (const auto& constraint : test.constraints.list())
    prescribed[constraint.particle][constraint.dof] = constraint.rate;
  forces.evaluate(prescribed, load, pool); // of linear forces: what moving the sides does to the rest
  const integrate::Problem<Forces> damped{forces, test.inertia, held, &load};
  integrate::VelocityVerlet({.time_step = time_step, .damping = {0.03 / time_step, 0}})
      .run(damped, moved, 1500, pool);
  for (const auto& constraint : test.constraints.list())
    moved.displacement[constraint.particle][constraint.dof] += constraint.rate;
  CHECK(apart(moved, multigrid) < 1e-6);
  return multigrid;
}

} // namespace

TEST_CASE("linear laws: multigrid, dynamic relaxation and a damped motion end at the same place") {
  const bond::Beam<> beam({.materials = materials});
  const auto plain = solved(beam);
  SUBCASE("four channels") {
    CHECK(apart(solved(bond::TimoshenkoBeam<>({.materials = materials})), plain) > 1e-3);
    CHECK(apart(solved(bond::Spring<>({.materials = materials, .tangential_ratio = 0.3})), plain) > 1e-3);
    CHECK(apart(solved(bond::DebondedInterface(beam, {0.2, {}})), plain) > 1e-3);
  }
  SUBCASE("12x12") {
    const laws::BlockBeam block{beam};
    CHECK(apart(solved(block), plain) < 1e-9);
    const bond::DebondedInterface debonded(block, {0.2, {}});
    CHECK(apart(solved(debonded), solved(bond::DebondedInterface(beam, {0.2, {}}))) < 1e-9);
  }
}

TEST_CASE("a law given by its energy alone has the displacements of the law by hand") {
  const bond::Beam<> beam({.materials = materials});
  CHECK(apart(solved(laws::EnergyBeam{{beam}}), solved(beam)) < 1e-10);
}
