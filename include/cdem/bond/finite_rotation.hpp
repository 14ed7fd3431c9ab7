#pragma once

/// @file
/// A law seen from the mean rotation of each bond's ends: rotations of any size.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/response.hpp>

#include <utility>

namespace cdem::bond {

/// The wrapped law, in a frame that turns with the bond's ends (corotational, quaternions).
///
/// Strains of a bond stay as small as the law wants them; displacements and rotations of the body are of any size. The
/// deformation is the same whichever end is the first, rigid motions give none, and forces are exact derivatives of the
/// energy: detail::FiniteMotion has the equations.
/// @tparam Law  any bond law; with a small motion the two are the same
template <BondLaw Law>
class FiniteRotation {
public:
  static constexpr bool finite_rotation = true;
  using Inner = Response<Law>;
  using State = StateOf<Law>;
  using Prepared = typename Inner::Prepared;
  using Parameters = typename Law::Parameters;

  explicit FiniteRotation(Law law) : law_(std::move(law)) {}
  explicit FiniteRotation(Parameters parameters) : law_(std::move(parameters)) {}

  const Law& law() const noexcept { return law_; }
  Prepared prepare(const BondGeometry& geometry) const { return Inner::prepare(law_, geometry); }
  ChannelLoad<> load(const Prepared& prepared, const Deformation<>& d, const State& state) const {
    return Inner::load(law_, prepared, d, state);
  }
  double energy(const Prepared& prepared, const Deformation<>& d, const State& state) const {
    return Inner::energy(law_, prepared, d, state);
  }
  Matrix6 tangent(const Prepared& prepared, const Deformation<>& d, const State& state, double length) const {
    return Inner::tangent(law_, prepared, d, state, length);
  }
  void update(const Prepared& prepared, const Deformation<>& d, State& state) const requires(HasState<Law>) {
    Inner::update(law_, prepared, d, state);
  }
  void validate(const particles::ParticleSet& particles) const { law_.validate(particles); }

private:
  Law law_;
};

static_assert(BondLaw<FiniteRotation<Beam<>>>);

} // namespace cdem::bond
