#pragma once

/// @file
/// Phases that touch but do not hold together.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/detail/wrapped_law.hpp>

#include <utility>

namespace cdem::bond {

/// The wrapped law within phases; across phases a contact without friction or cohesion.
///
///     across phases:  F_n = the law's at the stretch alone where the stretch is below 0, else 0;  nothing else
///
/// A beam's contact so has its K_n, and none where DebondedInterface inside has set C_Gamma = 0. The contact stays that
/// of the two particles bonded at rest; the surfaces touch at rest. The load is continuous, its tangent jumps at contact.
/// The deformation that a memory inside follows is the stretch below 0 alone.            (not in the paper)
template <BondLaw Law>
class UnilateralInterface : public detail::WrappedLaw<Law> {
  using Base = detail::WrappedLaw<Law>;
  using Inner = typename Base::Inner;

public:
  using State = typename Base::State;
  struct Parameters {
    Law law;
  };
  struct Prepared {
    typename Inner::Prepared inner;
    bool across; ///< two phases
  };

  explicit UnilateralInterface(Parameters parameters) : Base(std::move(parameters.law)) {}
  explicit UnilateralInterface(Law law) : Base(std::move(law)) {}

  Prepared prepare(const BondGeometry& bond) const {
    return {Inner::prepare(this->law(), bond), bond.phase_first != bond.phase_second};
  }
  [[gnu::always_inline]] ChannelLoad<> load(const Prepared& prepared, const Deformation<>& d,
                                            const State& state) const {
    ChannelLoad<> f = Inner::load(this->law(), prepared.inner, felt(prepared, d), state);
    if (prepared.across)
      f = {d.stretch < 0 ? f.normal : 0, {}, 0, {}};
    return f;
  }
  double energy(const Prepared& prepared, const Deformation<>& d, const State& state) const {
    return Inner::energy(this->law(), prepared.inner, felt(prepared, d), state);
  }
  Matrix6 tangent(const Prepared& prepared, const Deformation<>& d, const State& state, double length) const {
    Matrix6 slope = Inner::tangent(this->law(), prepared.inner, felt(prepared, d), state, length);
    if (prepared.across) {
      const double normal = d.stretch < 0 ? slope(0, 0) : 0;
      slope.setZero();
      slope(0, 0) = normal;
    }
    return slope;
  }
  [[gnu::always_inline]] void update(const Prepared& prepared, const Deformation<>& d,
                                     State& state) const requires HasState<Law> {
    Inner::update(this->law(), prepared.inner, felt(prepared, d), state);
  }

private:
  static Deformation<> felt(const Prepared& prepared, const Deformation<>& d) {
    return prepared.across ? Deformation<>{d.stretch < 0 ? d.stretch : 0, {}, 0, {}} : d;
  }
};

static_assert(BondLaw<UnilateralInterface<Beam<>>>);

} // namespace cdem::bond
