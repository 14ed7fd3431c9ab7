#pragma once

/// @file
/// Brittle bonds.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/detail/wrapped_law.hpp>
#include <cdem/bond/failure_criterion.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace cdem::bond {

/// The wrapped law until its load meets the criterion; from then on nothing.
///
/// A bond breaks at the end of the step (of the advance()) in which the criterion is met, and does not heal. What it stored
/// then is lost, and booked as dissipated. A broken bond bears no compression either: its particles pass through each
/// other, as nothing tells them that they touch.                                        (not in the paper)
/// @tparam Criterion  a FailureCriterion for the law
template <BondLaw Law, class Criterion>
requires FailureCriterion<Criterion, Law>
class Breakable : public detail::WrappedLaw<Law> {
  using Base = detail::WrappedLaw<Law>;
  using Inner = typename Base::Inner;

public:
  struct State {
    [[no_unique_address]] StateOf<Law> inner = {};
    bool broken = false;
  };
  struct Parameters {
    Law law;
    Criterion criterion;
  };
  struct Prepared {
    typename Inner::Prepared inner;
    decltype(std::declval<const Criterion&>().prepare(std::declval<const BondGeometry&>(),
                                                      std::declval<const Law&>())) criterion;
  };

  /// @throws core::InvalidInput for a criterion whose validate() throws it
  explicit Breakable(Parameters parameters)
      : Base(std::move(parameters.law)), criterion_(std::move(parameters.criterion)) {
    if constexpr (requires { criterion_.validate(); })
      criterion_.validate();
  }
  Breakable(Law law, Criterion criterion) : Breakable(Parameters{std::move(law), std::move(criterion)}) {}

  const Criterion& criterion() const noexcept { return criterion_; }

  Prepared prepare(const BondGeometry& bond) const {
    return {Inner::prepare(this->law(), bond), criterion_.prepare(bond, this->law())};
  }
  [[gnu::always_inline]] void update(const Prepared& prepared, const Deformation<>& d, State& state) const {
    if (state.broken)
      return;
    Inner::update(this->law(), prepared.inner, d, state.inner);
    state.broken = criterion_.exertion(prepared.criterion,
                                       Inner::load(this->law(), prepared.inner, d, state.inner)) >= 1;
  }
  [[gnu::always_inline]] ChannelLoad<> load(const Prepared& prepared, const Deformation<>& d,
                                            const State& state) const {
    return state.broken ? ChannelLoad<>{} : Inner::load(this->law(), prepared.inner, d, state.inner);
  }
  double energy(const Prepared& prepared, const Deformation<>& d, const State& state) const {
    return state.broken ? 0 : Inner::energy(this->law(), prepared.inner, d, state.inner);
  }
  Matrix6 tangent(const Prepared& prepared, const Deformation<>& d, const State& state, double length) const {
    return state.broken ? Matrix6(Matrix6::Zero())
                        : Inner::tangent(this->law(), prepared.inner, d, state.inner, length);
  }

private:
  Criterion criterion_;
};

static_assert(BondLaw<Breakable<Beam<>, AxialStress>>);

/// Whether a bond's state says that it is broken, by the outermost Breakable or one inside.
template <class State>
bool is_broken(const State& state) {
  if constexpr (requires { is_broken(state.inner); })
    return state.broken || is_broken(state.inner);
  else if constexpr (requires { state.broken; })
    return state.broken;
  else
    return false;
}

/// Number of broken bonds as of the last advance(). @complexity O(bonds)
template <class Forces>
requires requires(const Forces& forces) {
  forces.states();
}
std::size_t count_broken(const Forces& forces) {
  const auto states = forces.states();
  return static_cast<std::size_t>(
      std::count_if(states.begin(), states.end(), [](const auto& state) { return is_broken(state); }));
}

} // namespace cdem::bond
