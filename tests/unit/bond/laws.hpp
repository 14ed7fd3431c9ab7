#pragma once

/// @file
/// Laws of the three kinds for the tests of what is made from them.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/bond_law.hpp>

#include <algorithm>

namespace laws {

using namespace cdem;
using bond::BondGeometry;
using bond::ChannelLoad;
using bond::ChannelStiffness;
using bond::Deformation;

/// The beam as the 12x12 matrix that its loads at unit motions make, changed if asked.
struct BlockBeam {
  bond::Beam<> beam;
  void (*change)(bond::Matrix12&) = nullptr;

  bond::Matrix12 stiffness(const BondGeometry& geometry) const {
    const ChannelStiffness k = beam.stiffness(geometry);
    bond::Matrix12 block;
    for (int column = 0; column < 12; ++column) {
      particles::Spatial<> ends[2];
      ends[column / 6][column % 6] = 1;
      const bond::BondLoad load =
          bond::load_of(k, geometry.direction, geometry.length,
                        bond::deformation_of(geometry.direction, geometry.length, ends[0], ends[1]));
      block.col(column) << -load.force, -load.moment_first, load.force, -load.moment_second;
    }
    if (change)
      change(block);
    return block;
  }
  void validate(const particles::ParticleSet& particles) const { beam.validate(particles); }
};

/// Four channels, the same for every bond.
struct AnyChannels {
  ChannelStiffness channels;
  ChannelStiffness stiffness(const BondGeometry&) const { return channels; }
  void validate(const particles::ParticleSet&) const {}
};

/// What the laws below are made from.
struct FromBeam {
  bond::Beam<> beam;
  ChannelStiffness prepare(const BondGeometry& geometry) const { return beam.stiffness(geometry); }
  void validate(const particles::ParticleSet& particles) const { beam.validate(particles); }

protected:
  template <class Real>
  static Real elastic(const ChannelStiffness& k, const Deformation<Real>& d) {
    return 0.5 * (k.normal * d.stretch * d.stretch + k.tangential * d.shear.squared() +
                  k.torsion * d.twist * d.twist + k.bending * d.bend.squared());
  }
};

/// The beam by its energy alone.
struct EnergyBeam : FromBeam {
  template <class Real>
  Real energy(const ChannelStiffness& k, const Deformation<Real>& d) const {
    return elastic(k, d);
  }
};

/// A beam that stiffens as it is strained, its channels coupled; an energy law.
struct Stiffening : FromBeam {
  template <class Real>
  Real energy(const ChannelStiffness& k, const Deformation<Real>& d) const {
    const Real e = elastic(k, d) / k.normal;
    return k.normal * (exp(e) - 1 + 0.1 * d.stretch * d.twist * d.bend.t + 0.05 * sin(d.shear.b) * d.stretch);
  }
};

/// A spring whose stiffness falls as 1/(1 + m), m its largest stretch so far; a force law with a memory.
struct Softening : FromBeam {
  struct State {
    double largest = 0;
  };
  void update(const ChannelStiffness&, const Deformation<>& d, State& state) const {
    state.largest = std::max(state.largest, d.stretch);
  }
  ChannelLoad<> load(const ChannelStiffness& k, const Deformation<>& d, const State& state) const {
    return {k.normal * d.stretch / (1 + state.largest), {}, 0, {}};
  }
  double energy(const ChannelStiffness& k, const Deformation<>& d, const State& state) const {
    return 0.5 * k.normal * d.stretch * d.stretch / (1 + state.largest);
  }
};

} // namespace laws
