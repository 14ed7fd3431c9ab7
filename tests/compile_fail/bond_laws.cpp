// Laws that lack something of the kind their author began to write. Each is refused at the line that uses it, and what
// is missing is named.

#include <cdem/bond/bond_law.hpp>

#include <vector>

namespace {

using namespace cdem::bond;

#ifdef CDEM_REPAIRED
#define GOOD(...) __VA_ARGS__
#define BAD(...)
#else
#define GOOD(...)
#define BAD(...) __VA_ARGS__
#endif

/// What every law has; the laws below take it over.
struct Valid {
  void validate(const cdem::particles::ParticleSet&) const {}
};

struct SaysNothing : Valid {
  GOOD(ChannelStiffness stiffness(const BondGeometry&) const;)
};
// expect: NamesStiffnessLoadOrEnergy
static_assert(BondLaw<SaysNothing>); // refused here

struct WithoutValidate {
  GOOD(void validate(const cdem::particles::ParticleSet&) const;)
  ChannelStiffness stiffness(const BondGeometry&) const;
};
// expect: ValidatesParticles
// expect: law\.validate\(particles\)
static_assert(BondLaw<WithoutValidate>); // refused here

struct StiffnessOfWrongType : Valid {
  BAD(double stiffness(const BondGeometry&) const;)
  GOOD(ChannelStiffness stiffness(const BondGeometry&) const;)
};
// expect: GivesStiffness
// expect: ChannelsOrMatrix12
static_assert(BondLaw<StiffnessOfWrongType>); // refused here

struct StiffnessNotConst : Valid {
  ChannelStiffness stiffness(const BondGeometry&) GOOD(const);
};
// expect: GivesStiffness
// expect: law\.stiffness\(geometry\)
static_assert(BondLaw<StiffnessNotConst>); // refused here

struct ForceWithoutEnergy : Valid {
  ChannelLoad<> load(const BondGeometry&, const Deformation<>&) const;
  GOOD(double energy(const BondGeometry&, const Deformation<>&) const;)
};
// expect: GivesEnergyOfDeformation
// expect: law\.energy\(prepared, deformation\)
static_assert(BondLaw<ForceWithoutEnergy>); // refused here

struct LoadOfWrongType : Valid {
  BAD(BondLoad load(const BondGeometry&, const Deformation<>&) const;)
  GOOD(ChannelLoad<> load(const BondGeometry&, const Deformation<>&) const;)
  double energy(const BondGeometry&, const Deformation<>&) const;
};
// expect: GivesLoadOfDeformation
// expect: law\.load\(prepared, deformation\)
// expect: Is<|return-type
static_assert(BondLaw<LoadOfWrongType>); // refused here

struct EnergyOfDoublesAlone : Valid {
  BAD(double energy(const BondGeometry&, const Deformation<double>&) const;)
  GOOD(template <class Real> Real energy(const BondGeometry&, const Deformation<Real>&) const;)
};
// expect: EnergyIsDifferentiable
// expect: law\.energy\(prepared, deformation\)
static_assert(BondLaw<EnergyOfDoublesAlone>); // refused here

struct EnergyForgetsTheDerivative : Valid {
  template <class Real>
  BAD(double)
  GOOD(Real) energy(const BondGeometry&, const Deformation<Real>&) const;
};
// expect: EnergyIsDifferentiable
static_assert(BondLaw<EnergyForgetsTheDerivative>); // refused here

struct EnergyWithoutItsState : Valid {
  struct State {};
  template <class Real>
  Real energy(const BondGeometry&, const Deformation<Real>& GOOD(, const State&)) const;
  void update(const BondGeometry&, const Deformation<>&, State&) const;
};
// expect: GivesEnergyOfState
// expect: law\.energy\(prepared, deformation, state\)
static_assert(BondLaw<EnergyWithoutItsState>); // refused here

struct StateIsNeverUpdated : Valid {
  struct State {};
  template <class Real>
  Real energy(const BondGeometry&, const Deformation<Real>&, const State&) const;
  GOOD(void update(const BondGeometry&, const Deformation<>&, State&) const;)
};
// expect: UpdatesState
// expect: law\.update\(prepared, deformation, state\)
static_assert(BondLaw<StateIsNeverUpdated>); // refused here

struct UpdatesACopy : Valid {
  struct State {};
  template <class Real>
  Real energy(const BondGeometry&, const Deformation<Real>&, const State&) const;
  void update(const BondGeometry&, const Deformation<>&, State BAD() GOOD(&)) const;
};
// expect: UpdatesStateByReference
static_assert(BondLaw<UpdatesACopy>); // refused here

struct StateWithAPointer : Valid {
  struct State {
    BAD(std::vector<double>) GOOD(double) damage;
  };
  template <class Real>
  Real energy(const BondGeometry&, const Deformation<Real>&, const State&) const;
  void update(const BondGeometry&, const Deformation<>&, State&) const;
};
// expect: StateIsTriviallyCopyable
static_assert(BondLaw<StateWithAPointer>); // refused here

struct StateWithoutABeginning : Valid {
  struct State {
    BAD(explicit State(double d) : damage(d){})
    double damage;
  };
  template <class Real>
  Real energy(const BondGeometry&, const Deformation<Real>&, const State&) const;
  void update(const BondGeometry&, const Deformation<>&, State&) const;
};
// expect: StateIsDefaultConstructible
static_assert(BondLaw<StateWithoutABeginning>); // refused here

struct StateNotDeclared : Valid {
  struct GOOD(State) BAD(Memory) {};
  template <class Real, class S> // taken, but by no one
  Real energy(const BondGeometry&, const Deformation<Real>&, const S&) const;
  void update(const BondGeometry&, const Deformation<>&, GOOD(State) BAD(Memory) &) const;
};
// expect: DeclaresState
// expect: State
static_assert(BondLaw<StateNotDeclared>); // refused here

struct PreparesFromTheLength : Valid {
  double prepare(BAD(double) GOOD(const BondGeometry&)) const;
  template <class Real>
  Real energy(const double&, const Deformation<Real>&) const;
};
// expect: PreparesBonds
// expect: law\.prepare\(geometry\)
static_assert(BondLaw<PreparesFromTheLength>); // refused here

} // namespace
