#pragma once

/// @file
/// A law seen from the mean rotation of each bond's ends: rotations of any size.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/detail/wrapped_law.hpp>

#include <utility>

namespace cdem::bond {

namespace detail {
/// `L::Parameters`, or the law itself where it has none.
template <class L>
struct ParametersOf {
  struct type {
    L law;
  };
  static L make(type parameters) { return std::move(parameters.law); }
};
template <class L>
requires requires {
  typename L::Parameters;
}
struct ParametersOf<L> {
  using type = typename L::Parameters;
  static L make(type parameters) { return L(std::move(parameters)); }
};
} // namespace detail

/// The wrapped law, in a frame that turns with the bond's ends (corotational, quaternions).
///
/// Strains of a bond stay as small as the law wants them; displacements and rotations of the body are of any size. The
/// deformation is the same whichever end is the first, rigid motions give none, and forces are exact derivatives of the
/// energy: detail::FiniteMotion has the equations.
/// @tparam Law  any bond law; with a small motion the two are the same
template <BondLaw Law>
class FiniteRotation : public detail::WrappedLaw<Law> {
  using Base = detail::WrappedLaw<Law>;
  using Inner = typename Base::Inner;

public:
  static constexpr bool finite_rotation = true;
  using State = typename Base::State;
  using Prepared = typename Inner::Prepared;
  using Parameters = typename detail::ParametersOf<Law>::type;

  explicit FiniteRotation(Law law) : Base(std::move(law)) {}
  explicit FiniteRotation(Parameters parameters)
      : Base(detail::ParametersOf<Law>::make(std::move(parameters))) {}

  Prepared prepare(const BondGeometry& geometry) const { return Inner::prepare(this->law(), geometry); }
  [[gnu::always_inline]] ChannelLoad<> load(const Prepared& prepared, const Deformation<>& d,
                                            const State& state) const {
    return Inner::load(this->law(), prepared, d, state);
  }
  double energy(const Prepared& prepared, const Deformation<>& d, const State& state) const {
    return Inner::energy(this->law(), prepared, d, state);
  }
  Matrix6 tangent(const Prepared& prepared, const Deformation<>& d, const State& state, double length) const {
    return Inner::tangent(this->law(), prepared, d, state, length);
  }
  [[gnu::always_inline]] void update(const Prepared& prepared, const Deformation<>& d,
                                     State& state) const requires HasState<Law> {
    Inner::update(this->law(), prepared, d, state);
  }
};

static_assert(BondLaw<FiniteRotation<Beam<>>>);

} // namespace cdem::bond
