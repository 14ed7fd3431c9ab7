#pragma once

/// @file
/// Bonds across phases that hold less than perfectly.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/detail/wrapped_law.hpp>
#include <cdem/bond/phase_pairs.hpp>

#include <string>
#include <utility>

namespace cdem::bond {

/// The wrapped law within phases; across phases its stiffness times a cohesion, [L17] eq. 17.
///
///     E_mu^Gamma = C_Gamma sqrt(E_mu^f E_mu^m),   C_Gamma in [0, 1]
///
/// All channels of a bond are scaled, as E_mu scales them; of a law that is not linear, load and energy. C_Gamma = 1 is
/// the law itself, 0 a bond that does nothing. A linear law stays one: nothing is added to a step.
/// A law that breaks inside sees its load unscaled: put Breakable around DebondedInterface.
template <BondLaw Law>
class DebondedInterface : public detail::WrappedLaw<Law> {
  using Base = detail::WrappedLaw<Law>;
  using Inner = typename Base::Inner;

public:
  using State = typename Base::State;
  struct Parameters {
    Law law;
    PhasePairs cohesion = {.otherwise = 1}; ///< C_Gamma of each pair of two phases
  };
  struct Prepared {
    typename Inner::Prepared inner;
    double cohesion;
  };

  /// @throws core::InvalidInput for a cohesion outside [0, 1] or of a phase with itself
  explicit DebondedInterface(Parameters parameters)
      : Base(std::move(parameters.law)), cohesion_(std::move(parameters.cohesion)) {
    cohesion_.validate(
        "cohesion", [](double c) { return c >= 0 && c <= 1; }, "a number in [0, 1] is expected");
    for (const PhasePairs::Pair& pair : cohesion_.pairs)
      core::expect(pair.first != pair.second,
                   "cohesion of phase " + std::to_string(int{pair.first}) + " with itself", pair.value,
                   "two different phases are expected");
  }
  DebondedInterface(Law law, PhasePairs cohesion)
      : DebondedInterface(Parameters{std::move(law), std::move(cohesion)}) {}

  /// C_Gamma of a bond; 1 within a phase.
  double cohesion(const BondGeometry& bond) const {
    return bond.phase_first == bond.phase_second ? 1 : cohesion_.between(bond.phase_first, bond.phase_second);
  }

  /// Of a linear law: the channels' or the 12x12.
  auto stiffness(const BondGeometry& bond) const requires LinearLaw<Law> {
    const double c = cohesion(bond);
    const auto whole = this->law().stiffness(bond);
    if constexpr (GivesChannelStiffness<Law>)
      return ChannelStiffness{c * whole.normal, c * whole.tangential, c * whole.torsion, c * whole.bending};
    else
      return Matrix12(c * whole);
  }

  Prepared prepare(const BondGeometry& bond) const requires(!LinearLaw<Law>) {
    return {Inner::prepare(this->law(), bond), cohesion(bond)};
  }
  [[gnu::always_inline]] ChannelLoad<> load(const Prepared& prepared, const Deformation<>& d,
                                            const State& state) const requires(!LinearLaw<Law>) {
    const ChannelLoad<> f = Inner::load(this->law(), prepared.inner, d, state);
    const double c = prepared.cohesion;
    return {c * f.normal,
            {c * f.tangential.t, c * f.tangential.b},
            c * f.torsion,
            {c * f.bending.t, c * f.bending.b}};
  }
  double energy(const Prepared& prepared, const Deformation<>& d, const State& state) const
      requires(!LinearLaw<Law>) {
    return prepared.cohesion * Inner::energy(this->law(), prepared.inner, d, state);
  }
  Matrix6 tangent(const Prepared& prepared, const Deformation<>& d, const State& state, double length) const
      requires(!LinearLaw<Law>) {
    return prepared.cohesion * Inner::tangent(this->law(), prepared.inner, d, state, length);
  }
  [[gnu::always_inline]] void update(const Prepared& prepared, const Deformation<>& d,
                                     State& state) const requires HasState<Law> {
    Inner::update(this->law(), prepared.inner, d, state);
  }

private:
  PhasePairs cohesion_;
};

static_assert(BondLaw<DebondedInterface<Beam<>>>);

} // namespace cdem::bond
