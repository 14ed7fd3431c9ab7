#pragma once

/// @file
/// A network with the stiffness of each bond: internal forces, energy, loads of single bonds.

#include <cdem/bond/bond_law.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <span>
#include <vector>

namespace cdem::bond {

/// Internal forces f = -K u of a bonded body in small motion, matrix-free.
///
/// The stiffness of every bond is computed once, from any BondLaw. A particle gathers the loads of its own
/// bonds in their order, so that results are bitwise the same for any number of threads.
class LinearForces {
public:
  /// @throws core::InvalidInput for particles, a network or phases that do not fit together, or a law that
  /// returns a
  ///         stiffness that is negative or not finite (names the bond)
  /// @complexity O(bonds), 88 bytes a bond
  template <BondLaw Law>
  LinearForces(const Law& law, const particles::ParticleSet& particles, const network::BondNetwork& network) {
    particles.validate();
    network.validate();
    core::expect(network.particle_count == particles.size(), "particle_count of the network",
                 network.particle_count,
                 "the number of particles, " + std::to_string(particles.size()) + ", is expected");
    law.validate(particles);
    bonds_.reserve(network.size());
    for (BondIndex b = 0; b < network.size(); ++b) {
      const BondGeometry geometry = geometry_of(b, particles, network);
      const ChannelStiffness stiffness = law.stiffness(geometry);
      for (const double k : {stiffness.normal, stiffness.tangential, stiffness.torsion, stiffness.bending})
        core::expect_not_negative(k, "a stiffness of bond " + std::to_string(b));
      bonds_.push_back({network.first[b], network.second[b], geometry.direction, geometry.length, stiffness});
    }
    list_ends(particles.size());
  }

  std::size_t particle_count() const noexcept { return begin_.size() - 1; }
  std::size_t bond_count() const noexcept { return bonds_.size(); }

  /// Internal forces, f = -K u.
  ///
  /// @param displacement  [particles] m, rad
  /// @param force         [particles] N, N m, overwritten
  /// @complexity          O(bonds), no allocation; every bond is computed once for each of its ends
  void evaluate(const particles::SpatialField<>& displacement, particles::SpatialField<>& force,
                core::ThreadPool& pool) const {
    core::parallel_for(pool, particle_count(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
        for (std::size_t e = begin_[i]; e < begin_[i + 1]; ++e) {
          const Bond& bond = bonds_[ends_[e]];
          const BondLoad load = load_of(bond.stiffness, bond.direction, bond.length,
                                        deformation_of(bond.direction, bond.length, displacement[bond.first],
                                                       displacement[bond.second]));
          if (bond.first == i) {
            linear += load.force;
            angular += load.moment_first;
          } else {
            linear -= load.force;
            angular += load.moment_second;
          }
        }
        force[i].linear() = linear;
        force[i].angular() = angular;
      }
    });
  }

  /// Elastic energy u.K u / 2, J. @complexity O(bonds)
  double elastic_energy(const particles::SpatialField<>& displacement, core::ThreadPool& pool) const {
    return core::parallel_sum(pool, bonds_.size(), 0.0, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t b = begin; b < end; ++b)
        sum += energy_of(bonds_[b].stiffness, bonds_[b].direction, deformation(b, displacement));
      return sum;
    });
  }

  /// Force and moments of one bond. @complexity O(1)
  BondLoad load(BondIndex b, const particles::SpatialField<>& displacement) const {
    return load_of(bonds_[b].stiffness, bonds_[b].direction, bonds_[b].length, deformation(b, displacement));
  }

  /// Forces on the first particle of every bond, what a stress estimator reads.
  ///
  /// @param forces  [bonds] N, overwritten
  void bond_forces(const particles::SpatialField<>& displacement, std::vector<Vec3>& forces,
                   core::ThreadPool& pool) const {
    forces.resize(bonds_.size());
    core::parallel_for(pool, bonds_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b)
        forces[b] = load(b, displacement).force;
    });
  }

  /// The 6x6 block of K that couples particle i with itself (rows and columns: x, y, z, about x, y, z).
  ///
  ///     translation: K_n nn + K_t (1 - nn)                rotation: S_n nn + (E_mu I/L + K_t L^2/4)(1 - nn)
  ///     coupling:    -K_t (L/2) [n]x on the first end, +K_t (L/2) [n]x on the second
  Eigen::Matrix<double, 6, 6> diagonal_block(ParticleIndex i) const {
    Eigen::Matrix<double, 6, 6> block = Eigen::Matrix<double, 6, 6>::Zero();
    for (std::size_t e = begin_[i]; e < begin_[i + 1]; ++e) {
      const Bond& bond = bonds_[ends_[e]];
      const Vec3& n = bond.direction;
      const Mat3 along = n * n.transpose(), across = Mat3::Identity() - along;
      const ChannelStiffness& k = bond.stiffness;
      const double arm = 0.5 * bond.length;
      Mat3 cross;
      cross << 0, -n.z(), n.y(), n.z(), 0, -n.x(), -n.y(), n.x(), 0;
      const Mat3 coupling = (bond.first == i ? -1 : 1) * k.tangential * arm * cross;
      block.topLeftCorner<3, 3>() += k.normal * along + k.tangential * across;
      block.bottomRightCorner<3, 3>() += k.torsion * along + (k.bending + k.tangential * arm * arm) * across;
      block.topRightCorner<3, 3>() += coupling;
      block.bottomLeftCorner<3, 3>() += coupling.transpose();
    }
    return block;
  }

  /// Stiffness of one bond.
  const ChannelStiffness& stiffness(BondIndex b) const { return bonds_[b].stiffness; }
  /// Unit vector of one bond, from its first particle to its second.
  const Vec3& direction(BondIndex b) const { return bonds_[b].direction; }
  /// Length of one bond at rest, m.
  double length(BondIndex b) const { return bonds_[b].length; }
  /// The two particles of one bond.
  std::pair<ParticleIndex, ParticleIndex> ends(BondIndex b) const {
    return {bonds_[b].first, bonds_[b].second};
  }
  /// The bonds of particle i.
  std::span<const BondIndex> bonds_of(ParticleIndex i) const {
    return {ends_.data() + begin_[i], begin_[i + 1] - begin_[i]};
  }

private:
  struct Bond {
    ParticleIndex first;
    ParticleIndex second;
    Vec3 direction;
    double length;
    ChannelStiffness stiffness;
  };

  BondDeformation deformation(BondIndex b, const particles::SpatialField<>& displacement) const {
    const Bond& bond = bonds_[b];
    return deformation_of(bond.direction, bond.length, displacement[bond.first], displacement[bond.second]);
  }

  void list_ends(std::size_t particles) {
    begin_.assign(particles + 1, 0);
    for (const Bond& bond : bonds_) {
      ++begin_[bond.first + 1];
      ++begin_[bond.second + 1];
    }
    for (std::size_t i = 0; i < particles; ++i)
      begin_[i + 1] += begin_[i];
    ends_.resize(2 * bonds_.size());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (BondIndex b = 0; b < bonds_.size(); ++b) {
      ends_[next[bonds_[b].first]++] = b;
      ends_[next[bonds_[b].second]++] = b;
    }
  }

  std::vector<Bond> bonds_;
  std::vector<std::size_t> begin_; ///< [particles + 1] where each particle's bonds start in `ends_`
  std::vector<BondIndex> ends_;    ///< [2 bonds] bonds of each particle
};

} // namespace cdem::bond
