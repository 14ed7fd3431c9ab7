// A run that was stopped and goes on from its checkpoint gives the same bytes as one that was not, bonds that remember
// included.

#include <cdem/bond/finite_rotation.hpp>
#include <cdem/integrate/velocity_verlet.hpp>
#include <cdem/io/forces_memory.hpp>

#include <doctest/doctest.h>

#include "custom_bond_law/softening_beam.hpp"
#include "unit/bond/body.hpp"
#include "unit/io/temporary_folder.hpp"

using namespace cdem;

namespace {

using Law = bond::FiniteRotation<SofteningBeam>;
using Forces = bond::BondForces<Law>;

Law law() {
  return Law({.beam = {.materials = {{.youngs_modulus = 1e9, .radius_ratio = 0.5}}},
              .onset = 1e-3,
              .rupture = 5e-3});
}

/// A row of particles, its first end held, its last pulled and turned.
struct Pull {
  body::Body row = body::row(6, Vec3(1, 2, 3).normalized(), 2e-3, 1e-3);
  particles::Inertia inertia = particles::solid_spheres(row.particles, std::vector{1000.0});
  particles::Constraints constraints;
  core::ThreadPool pool;

  Pull() {
    for (std::uint8_t dof = 0; dof < 6; ++dof) {
      constraints.add({0, dof, 0});
      constraints.add({5, dof, dof == 3 ? 100.0 : 1.0});
    }
  }
  void run(Forces& forces, particles::Motion& motion, std::uint64_t steps) {
    const integrate::Problem<Forces> problem{forces, inertia, constraints};
    integrate::VelocityVerlet({.time_step = 1e-7}).run(problem, motion, steps, pool);
  }
};

} // namespace

TEST_CASE("bonds go on from a checkpoint as if they had never stopped") {
  const TemporaryFolder folder;
  Pull pull;
  Forces whole(law(), pull.row.particles, pull.row.network);
  auto motion = particles::Motion::at_rest(6);
  pull.run(whole, motion, 300);
  {
    io::CheckpointWriter file(folder.path() / "memory.cdem");
    io::add_memory(file, whole);
    file.commit();
  }
  auto again = motion;
  Forces resumed(law(), pull.row.particles, pull.row.network);
  io::read_memory(io::CheckpointReader(folder.path() / "memory.cdem"), resumed);
  pull.run(whole, motion, 300);
  pull.run(resumed, again, 300);
  CHECK(body::same_bytes(motion.displacement, again.displacement));
  CHECK(whole.dissipated_energy() == resumed.dissipated_energy());
  CHECK(whole.dissipated_energy() > 0); // there was something to remember
  for (BondIndex b = 0; b < 5; ++b)
    CHECK(whole.states()[b].worst == resumed.states()[b].worst);
  CHECK(whole.orientation(5).coeffs() == resumed.orientation(5).coeffs());
}

TEST_CASE("the memory of another body or law is refused") {
  const TemporaryFolder folder;
  const auto path = folder.path() / "memory.cdem";
  Pull pull;
  {
    io::CheckpointWriter file(path);
    io::add_memory(file, Forces(law(), pull.row.particles, pull.row.network));
    file.commit();
  }
  const body::Body longer = body::row(7, Vec3::UnitX(), 2e-3, 1e-3);
  Forces other(law(), longer.particles, longer.network);
  CHECK_THROWS_WITH_AS(io::read_memory(io::CheckpointReader(path), other),
                       doctest::Contains("'bond.state' is of 5 bonds, this body has 6"), core::FileError);
  using Beams = bond::BondForces<bond::Beam<>>;
  Beams beams(bond::Beam<>({.materials = {{.youngs_modulus = 1e9, .radius_ratio = 0.5}}}), pull.row.particles,
              pull.row.network);
  CHECK_THROWS_WITH_AS(io::read_memory(io::CheckpointReader(path), beams), doctest::Contains("'bond.state'"),
                       core::FileError);
}
