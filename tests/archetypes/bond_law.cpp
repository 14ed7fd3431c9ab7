// The least that a bond law is, through every template that takes one.

#include <cdem/bond/linear_forces.hpp>

namespace {

struct Law {
  Law() = delete; // laws have parameters
  explicit Law(int) {}
  Law(const Law&) = default;
  Law& operator=(const Law&) = delete; // copies are enough
  cdem::bond::ChannelStiffness stiffness(const cdem::bond::BondGeometry&) const { return {1, 1, 1, 1}; }
  void validate(const cdem::particles::ParticleSet&) const {}
};

static_assert(cdem::bond::BondLaw<Law>);

} // namespace

template cdem::bond::BasicLinearForces<double>::BasicLinearForces(const Law&,
                                                                  const cdem::particles::ParticleSet&,
                                                                  const cdem::network::BondNetwork&);
