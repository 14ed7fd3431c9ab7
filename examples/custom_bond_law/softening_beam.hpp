#pragma once
// A bond law that is not in the library. A program needs no more than this file to use it.

#include <cdem/bond/beam.hpp>

#include <algorithm>

// [law]
/// The library's beam until its strain passes `onset`; from there its load falls on a straight line to nothing at
/// `rupture`. Strain is sqrt(2 E/K_n)/L with E the energy of the undamaged beam: in tension, stretch over length.
class SofteningBeam {
public:
  struct Parameters {
    cdem::bond::Beam<>::Parameters beam;
    double onset = 1e-3, rupture = 1e-2;
  };
  explicit SofteningBeam(Parameters p) : beam_(p.beam), onset_(p.onset), rupture_(p.rupture) {
    cdem::core::expect_positive(onset_, "onset of softening");
    cdem::core::expect(rupture_ > onset_, "rupture", rupture_, "a strain above the onset is expected");
  }
  void validate(const cdem::particles::ParticleSet& particles) const { beam_.validate(particles); }
  // [law]
  // [prepare]
  struct Prepared {
    cdem::bond::ChannelStiffness k;
    double length;
  };
  Prepared prepare(const cdem::bond::BondGeometry& bond) const {
    return {beam_.stiffness(bond), bond.length};
  }
  // [prepare]
  // [state]
  struct State {
    double worst = 0; ///< largest strain so far
  };
  void update(const Prepared& bond, const cdem::bond::Deformation<>& d, State& state) const {
    state.worst = std::max(state.worst, std::sqrt(2 * undamaged(bond.k, d) / bond.k.normal) / bond.length);
  }
  // [state]
  // [energy]
  template <class Real>
  Real energy(const Prepared& bond, const cdem::bond::Deformation<Real>& d, const State& state) const {
    return left(state.worst) * undamaged(bond.k, d);
  }
  double left(double worst) const { // part of the stiffness
    return worst <= onset_ ? 1 : std::max(0.0, onset_ / worst * (rupture_ - worst) / (rupture_ - onset_));
  }

private:
  template <class Real>
  static Real undamaged(const cdem::bond::ChannelStiffness& k, const cdem::bond::Deformation<Real>& d) {
    return 0.5 * (k.normal * d.stretch * d.stretch + k.tangential * d.shear.squared() +
                  k.torsion * d.twist * d.twist + k.bending * d.bend.squared());
  }
  // [energy]
  cdem::bond::Beam<> beam_;
  double onset_, rupture_;
};
static_assert(cdem::bond::BondLaw<SofteningBeam>);
