// Who is a bond law and who only looks like one.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/bond_law.hpp>
#include <cdem/bond/spring.hpp>

namespace {

using namespace cdem;
using bond::BondGeometry;
using bond::BondLaw;
using bond::ChannelStiffness;
using particles::ParticleSet;

static_assert(BondLaw<bond::Beam<>>);
static_assert(BondLaw<bond::Beam<bond::ArithmeticMean>>);
static_assert(BondLaw<bond::Spring<>>);
static_assert(BondLaw<bond::Spring<bond::HarmonicMean>>);

struct Smallest {
  ChannelStiffness stiffness(const BondGeometry&) const;
  void validate(const ParticleSet&) const;
};
static_assert(BondLaw<Smallest>);

struct TakesGeometryByValue {
  ChannelStiffness stiffness(BondGeometry) const;
  void validate(const ParticleSet&) const;
};
static_assert(BondLaw<TakesGeometryByValue>);

struct SaysWhetherValid { // what validate() returns is not looked at
  ChannelStiffness stiffness(const BondGeometry&) const;
  bool validate(const ParticleSet&) const;
};
static_assert(BondLaw<SaysWhetherValid>);

// Near misses, each short of one thing.

struct NoStiffness {
  void validate(const ParticleSet&) const;
};
static_assert(!BondLaw<NoStiffness>);
static_assert(!bond::GivesChannelStiffness<NoStiffness> && bond::ValidatesParticles<NoStiffness>);

struct NoValidate {
  ChannelStiffness stiffness(const BondGeometry&) const;
};
static_assert(!BondLaw<NoValidate>);
static_assert(bond::GivesChannelStiffness<NoValidate> && !bond::ValidatesParticles<NoValidate>);

struct StiffnessIsANumber {
  double stiffness(const BondGeometry&) const;
  void validate(const ParticleSet&) const;
};
static_assert(!BondLaw<StiffnessIsANumber>);

struct StiffnessChangesTheLaw { // shared by threads: must be const
  ChannelStiffness stiffness(const BondGeometry&);
  void validate(const ParticleSet&) const;
};
static_assert(!BondLaw<StiffnessChangesTheLaw>);

struct StiffnessFromLengthAlone {
  ChannelStiffness stiffness(double length) const;
  void validate(const ParticleSet&) const;
};
static_assert(!BondLaw<StiffnessFromLengthAlone>);

struct CannotBeCopied {
  CannotBeCopied(const CannotBeCopied&) = delete;
  ChannelStiffness stiffness(const BondGeometry&) const;
  void validate(const ParticleSet&) const;
};
static_assert(!BondLaw<CannotBeCopied>);

static_assert(!BondLaw<int>);

// Laws of the other kinds, as models and near misses.

using bond::ChannelLoad;
using bond::Deformation;
using Differentiable = bond::Differentiable;

struct Valid {
  void validate(const ParticleSet&) const;
};

struct Block : Valid {
  bond::Matrix12 stiffness(const BondGeometry&) const;
};
static_assert(BondLaw<Block> && bond::LinearLaw<Block>);
static_assert(bond::GivesBlockStiffness<Block> && !bond::GivesChannelStiffness<Block>);

struct Force : Valid {
  ChannelLoad<> load(const BondGeometry&, const Deformation<>&) const;
  double energy(const BondGeometry&, const Deformation<>&) const;
};
static_assert(BondLaw<Force> && bond::ForceLaw<Force> && !bond::EnergyLaw<Force> && !bond::LinearLaw<Force>);

struct Energy : Valid {
  template <class Real>
  Real energy(const BondGeometry&, const Deformation<Real>&) const;
};
static_assert(BondLaw<Energy> && bond::EnergyLaw<Energy> && !bond::ForceLaw<Energy>);

struct Prepared : Valid {
  double prepare(const BondGeometry&) const;
  template <class Real>
  Real energy(double stiffness, const Deformation<Real>&) const;
};
static_assert(BondLaw<Prepared> && std::same_as<bond::PreparedOf<Prepared>, double>);

struct Remembering : Valid {
  struct State {
    double longest = 0;
  };
  template <class Real>
  Real energy(const BondGeometry&, const Deformation<Real>&, const State&) const;
  void update(const BondGeometry&, const Deformation<>&, State&) const;
};
static_assert(BondLaw<Remembering> && bond::EnergyLaw<Remembering> && bond::HasState<Remembering>);

struct RememberingForce : Valid {
  struct State {};
  ChannelLoad<> load(const BondGeometry&, const Deformation<>&, const State&) const;
  double energy(const BondGeometry&, const Deformation<>&, State) const;     // a copy does no harm
  void update(const BondGeometry&, const Deformation<>&, auto& state) const; // nor does a template
};
static_assert(BondLaw<RememberingForce> && bond::ForceLaw<RememberingForce>);

template <class Inner>
struct Wrapper : Valid { // as laws do that wrap another
  using State = bond::StateOf<Inner>;
  ChannelLoad<> load(const BondGeometry&, const Deformation<>&, const State&) const;
  double energy(const BondGeometry&, const Deformation<>&, const State&) const;
  void update(const BondGeometry&, const Deformation<>&, State&) const requires bond::HasState<Inner>;
};
static_assert(BondLaw<Wrapper<Force>> && !bond::HasState<Wrapper<Force>>);
static_assert(BondLaw<Wrapper<Remembering>> && bond::HasState<Wrapper<Remembering>>);

struct Final final : Valid {
  ChannelStiffness stiffness(const BondGeometry&) const;
};
static_assert(BondLaw<Final>);

struct ForceAndAWrongStiffness : Force { // whole as a force law: what it names beside is its own affair
  double stiffness(double) const;
};
static_assert(BondLaw<ForceAndAWrongStiffness>);

struct LoadWithoutEnergy : Valid {
  ChannelLoad<> load(const BondGeometry&, const Deformation<>&) const;
};
static_assert(!BondLaw<LoadWithoutEnergy> && bond::GivesLoad<LoadWithoutEnergy>);

struct EnergyOfDoubles : Valid {
  double energy(const BondGeometry&, const Deformation<>&) const;
};
static_assert(!BondLaw<EnergyOfDoubles> && bond::GivesEnergy<EnergyOfDoubles, double> &&
              !bond::GivesEnergy<EnergyOfDoubles, Differentiable>);

struct EnergyNotConst : Valid {
  template <class Real>
  Real energy(const BondGeometry&, const Deformation<Real>&);
};
static_assert(!BondLaw<EnergyNotConst>);

struct UpdatesAConst : Valid {
  struct State {};
  template <class Real>
  Real energy(const BondGeometry&, const Deformation<Real>&, const State&) const;
  void update(const BondGeometry&, const Deformation<>&, const State&) const;
};
static_assert(!BondLaw<UpdatesAConst> && bond::UpdatesState<UpdatesAConst> &&
              !bond::UpdatesStateByReference<UpdatesAConst>);

struct EnergyChangesTheState : Valid {
  struct State {};
  template <class Real>
  Real energy(const BondGeometry&, const Deformation<Real>&, State&) const;
  void update(const BondGeometry&, const Deformation<>&, State&) const;
};
static_assert(!BondLaw<EnergyChangesTheState>);

struct UpdateWithoutState : Energy {
  void update(const BondGeometry&, const Deformation<>&, int&) const;
};
static_assert(!BondLaw<UpdateWithoutState> && bond::EnergyLaw<UpdateWithoutState>);

struct FinalWithoutLaw final : Valid {};
static_assert(!BondLaw<FinalWithoutLaw> && !bond::NamesStiffnessLoadOrEnergy<FinalWithoutLaw>);

struct FinalWrongEnergy final : Valid {
  double energy(const BondGeometry&, const Deformation<>&) const;
};
static_assert(!BondLaw<FinalWrongEnergy> && bond::NamesStiffnessLoadOrEnergy<FinalWrongEnergy>);

// The rules that mix two phases.

static_assert(bond::InterfaceRule<bond::GeometricMean>);
static_assert(bond::InterfaceRule<double (*)(double, double)>);

struct GivesAnInteger {
  int operator()(double, double) const;
};
static_assert(!bond::InterfaceRule<GivesAnInteger>);

struct OneArgument {
  double operator()(double) const;
};
static_assert(!bond::InterfaceRule<OneArgument>);

struct NotConst {
  double operator()(double, double);
};
static_assert(!bond::InterfaceRule<NotConst>);

} // namespace
