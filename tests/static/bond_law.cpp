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
