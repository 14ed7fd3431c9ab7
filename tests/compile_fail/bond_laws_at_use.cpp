// A class that is no bond law is refused where forces are made of it, not somewhere within.

#include <cdem/bond/forces_of.hpp>
#include <cdem/integrate/velocity_verlet.hpp>
#include <cdem/packing/lattice.hpp>
#include <cdem/simulation/simulation.hpp>
#include <cdem/stress/love_weber.hpp>

namespace {

using namespace cdem::bond;

/// A law that does not give the derivative of its energy.
struct Law {
  void validate(const cdem::particles::ParticleSet&) const {}
#ifdef CDEM_REPAIRED
  template <class Real>
  Real energy(const BondGeometry&, const Deformation<Real>& d) const {
    return d.stretch * d.stretch;
  }
#else
  double energy(const BondGeometry&, const Deformation<>& d) const {
    return d.stretch * d.stretch;
  }
#endif
};

// expect: EnergyIsDifferentiable
// expect: law\.energy\(prepared, deformation\)
std::size_t in_a_function(const cdem::particles::ParticleSet& particles,
                          const cdem::network::BondNetwork& network) {
  return BondForces<Law>(Law(), particles, network).bond_count(); // refused here
}

// expect: EnergyIsDifferentiable
using Forces = ForcesOf<Law>; // refused here

using cdem::integrate::VelocityVerlet;
using cdem::packing::Lattice;
using cdem::simulation::Simulation;
using cdem::stress::LoveWeber;
// expect: EnergyIsDifferentiable
using Cube = Simulation<Lattice, Law, VelocityVerlet, LoveWeber<>>; // refused here

} // namespace
