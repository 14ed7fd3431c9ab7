#pragma once

/// @file
/// What laws that wrap another have in common.

#include <cdem/bond/bond_law.hpp>
#include <cdem/bond/response.hpp>

#include <utility>

namespace cdem::bond::detail {

/// Keeps the wrapped law and hands on what a wrapper does not change: frame, memory, section, checks.
template <BondLaw Law>
class WrappedLaw {
public:
  static constexpr bool finite_rotation = TurnsWithItsEnds<Law>;
  using State = bond::StateOf<Law>; // not the helper of the same name

  const Law& law() const noexcept { return law_; }
  void validate(const particles::ParticleSet& particles) const { law_.validate(particles); }
  double section_radius(const BondGeometry& bond) const requires GivesSectionRadius<Law> {
    return law_.section_radius(bond);
  }

protected:
  using Inner = Response<Law>;

  explicit WrappedLaw(Law law) : law_(std::move(law)) {}

private:
  Law law_;
};

} // namespace cdem::bond::detail
