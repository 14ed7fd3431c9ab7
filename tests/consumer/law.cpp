// What a user's second program does: a bond law of its own, checked, in the forces of the toolkit.

#include <cdem/cdem.hpp>

#include <cmath>
#include <iostream>

namespace mine {

/// A bar that stiffens: energy k s^2/2 (1 + s^2/L^2), s the stretch.
struct StiffeningBar {
  double stiffness = 1e6; ///< N/m

  template <class Real>
  Real energy(const cdem::bond::BondGeometry& bond, const cdem::bond::Deformation<Real>& d) const {
    const Real strain = d.stretch / bond.length;
    return 0.5 * stiffness * d.stretch * d.stretch * (1.0 + strain * strain);
  }
  void validate(const cdem::particles::ParticleSet&) const {}
};
static_assert(cdem::bond::BondLaw<StiffeningBar>);

} // namespace mine

int main() {
  using namespace cdem;
  const mine::StiffeningBar law;
  const bond::LawReport report = bond::check_law(law, {.strain = 0.1});
  std::cout << report;

  particles::ParticleSet particles;
  particles.resize(2);
  particles.radius.assign(2, 1.0);
  particles.position[1] = Vec3(2, 0, 0);
  network::BondNetwork network;
  network.particle_count = 2;
  network.first.push_back(0);
  network.second.push_back(1);
  network.branch.push_back(particles.position[1]);

  core::ThreadPool pool;
  const bond::ForcesOf<mine::StiffeningBar> forces(law, particles, network);
  particles::SpatialField<> displacement(2), force(2);
  const double stretch = 0.2, strain = 0.1;
  displacement[1].linear().x() = stretch;
  forces.evaluate(displacement, force, pool);
  const double exact = law.stiffness * stretch * (1 + 2 * strain * strain); // dE/ds
  std::cout << "force " << force[0].linear().x() << " N, by hand " << exact << " N\n";
  return report.passed() && std::abs(force[0].linear().x() - exact) < 1e-12 * exact ? 0 : 1;
}
