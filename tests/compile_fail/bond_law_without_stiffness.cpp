// A bond law that forgets its stiffness is refused at the line that uses it, and the missing part is named.
//
// expect: GivesChannelStiffness
// expect: law\.stiffness\(geometry\)

#include <cdem/bond/bond_law.hpp>

struct Law {
  void validate(const cdem::particles::ParticleSet&) const {}
#ifdef CDEM_REPAIRED
  cdem::bond::ChannelStiffness stiffness(const cdem::bond::BondGeometry&) const {
    return {};
  }
#endif
};

static_assert(cdem::bond::BondLaw<Law>); // refused here
