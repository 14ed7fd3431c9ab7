#pragma once

/// @file
/// Bonds that grow when they are heated.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/detail/wrapped_law.hpp>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace cdem::bond {

/// The wrapped law at a raised temperature: a heated bond is at rest when it is longer.
///
///     stretch felt by the law = stretch - alpha dT L
///     alpha = (R_i alpha_i + R_j alpha_j)/(R_i + R_j),   dT = (dT_i + dT_j)/2
///
/// Each particle's part of the bond dilates by its own alpha: the dilatation is a sum over lengths, whatever the rule
/// that mixes stiffnesses. The mean temperature of the ends is that of the bond where the field is linear along it. A
/// body of one alpha, uniformly heated, grows by alpha dT without stress, to rounding; in a linear field it bends the
/// bonds alone, which do not know the temperature across their section.                      (not in the paper)
template <BondLaw Law>
class Thermal : public detail::WrappedLaw<Law> {
  using Base = detail::WrappedLaw<Law>;
  using Inner = typename Base::Inner;

public:
  using State = typename Base::State;
  struct Parameters {
    Law law;
    std::vector<double> expansion;        ///< [phases] alpha, 1/K
    std::vector<double> temperature_rise; ///< dT, K: one for all, or [particles]
  };
  struct Prepared {
    typename Inner::Prepared inner;
    double dilatation; ///< alpha dT L, m
  };

  /// @throws core::InvalidInput for no expansion or temperature at all, or one that is not finite
  explicit Thermal(Parameters parameters)
      : Base(std::move(parameters.law)), expansion_(std::move(parameters.expansion)),
        temperature_rise_(std::move(parameters.temperature_rise)) {
    expect_finite(expansion_, "thermal expansion", "phase");
    expect_finite(temperature_rise_, "temperature rise", "particle");
  }
  Thermal(Law law, std::vector<double> expansion, std::vector<double> temperature_rise)
      : Thermal(Parameters{std::move(law), std::move(expansion), std::move(temperature_rise)}) {}

  Prepared prepare(const BondGeometry& bond) const {
    const double expansion = (bond.radius_first * expansion_[bond.phase_first] +
                              bond.radius_second * expansion_[bond.phase_second]) /
                             (bond.radius_first + bond.radius_second);
    const double rise = 0.5 * (temperature_rise(bond.first) + temperature_rise(bond.second));
    return {Inner::prepare(this->law(), bond), expansion * rise * bond.length};
  }
  [[gnu::always_inline]] ChannelLoad<> load(const Prepared& prepared, const Deformation<>& d,
                                            const State& state) const {
    return Inner::load(this->law(), prepared.inner, felt(prepared, d), state);
  }
  double energy(const Prepared& prepared, const Deformation<>& d, const State& state) const {
    return Inner::energy(this->law(), prepared.inner, felt(prepared, d), state);
  }
  Matrix6 tangent(const Prepared& prepared, const Deformation<>& d, const State& state, double length) const {
    return Inner::tangent(this->law(), prepared.inner, felt(prepared, d), state, length);
  }
  [[gnu::always_inline]] void update(const Prepared& prepared, const Deformation<>& d,
                                     State& state) const requires HasState<Law> {
    Inner::update(this->law(), prepared.inner, felt(prepared, d), state);
  }

  /// @throws core::InvalidInput if a phase has no expansion, or temperatures are not one for each particle
  void validate(const particles::ParticleSet& particles) const {
    Base::validate(particles);
    for (std::size_t i = 0; i < particles.phase.size(); ++i)
      core::expect(particles.phase[i] < expansion_.size(), "phase of particle " + std::to_string(i),
                   particles.phase[i],
                   "a phase with a thermal expansion is expected, " + std::to_string(expansion_.size()) +
                       " given");
    core::expect(temperature_rise_.size() == 1 || temperature_rise_.size() == particles.size(),
                 "number of temperature rises", temperature_rise_.size(),
                 "1 or the number of particles, " + std::to_string(particles.size()) + ", is expected");
  }

private:
  static void expect_finite(const std::vector<double>& list, const std::string& name, const char* of) {
    core::expect(!list.empty(), "number of values of the " + name, list.size(), "at least 1 is expected");
    for (std::size_t k = 0; k < list.size(); ++k)
      if (!std::isfinite(list[k])) [[unlikely]]
        core::expect_finite(list[k], name + " of " + of + " " + std::to_string(k));
  }
  double temperature_rise(ParticleIndex i) const {
    return temperature_rise_[temperature_rise_.size() == 1 ? 0 : i];
  }
  static Deformation<> felt(const Prepared& prepared, Deformation<> d) {
    d.stretch -= prepared.dilatation;
    return d;
  }

  std::vector<double> expansion_;        ///< [phases]
  std::vector<double> temperature_rise_; ///< one, or [particles]
};

static_assert(BondLaw<Thermal<Beam<>>>);

} // namespace cdem::bond
