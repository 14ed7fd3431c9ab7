#pragma once

/// @file
/// Young's modulus and Poisson's ratio from a tension test.

#include <cdem/boundary/symmetric_tension.hpp>
#include <cdem/particles/motion.hpp>

#include <span>

namespace cdem::homogenize {

/// What the grips of a testing machine see: forces and motions of the faces.
struct FaceReading {
  double force_fixed = 0;       ///< N, resultant on the fixed face, positive in tension
  double force_loaded = 0;      ///< N, resultant on the loaded face, positive in tension
  double stress = 0;            ///< Pa, force_fixed over the box's cross section, [L17] section 2.3
  double axial_strain = 0;      ///< relative motion of the two faces over the distance of their mean centres
  double nominal_strain = 0;    ///< the same over the side of the box, as in the paper
  double transverse_strain = 0; ///< mean of the two directions, over the distance of the faces' mean centres

  /// E_M = F / (S eps_L), Pa.                                                          [L17] section 2.3
  double youngs_modulus() const { return stress / axial_strain; }
  /// The same with the side of the box as gauge length: too high by box side over gauge length.
  double nominal_youngs_modulus() const { return stress / nominal_strain; }
  /// nu_M = -eps_T / eps_L.                                                            [L17] section 2.3
  double poissons_ratio() const { return -transverse_strain / axial_strain; }
};

/// What an extensometer on the body sees: the slope of displacement against position, by least squares over the
/// particles of the interior. It does not depend on which particles count as a face.
struct InteriorReading {
  double axial_strain = 0;
  double transverse_strain = 0; ///< mean of the two directions

  double youngs_modulus(double stress) const { return stress / axial_strain; }
  double poissons_ratio() const { return -transverse_strain / axial_strain; }
};

/// Reads moduli off a body under boundary::SymmetricTension.
///
/// For dynamic and static solutions alike: it takes displacements and reactions, whoever computed them.
class TensionGauge {
public:
  struct Parameters {
    double margin = 0.15; ///< the interior begins this part of the side away from every face, in [0, 0.5[
  };

  /// Only particles of the network's largest cluster count, as for the faces.
  /// @throws core::InvalidInput for a margin outside [0, 0.5[ or an interior of fewer than 8 particles
  TensionGauge(const particles::ParticleSet& particles, const network::BondNetwork& network,
               const boundary::TensionSetup& setup, Parameters parameters)
      : setup_(setup) {
    core::expect(parameters.margin >= 0 && parameters.margin < 0.5, "margin of the interior",
                 parameters.margin, "a part of the side in [0, 0.5[ is expected");
    const auto& list = setup.constraints.list();
    const auto held = [&](const boundary::Face& face) {
      std::vector<std::size_t> numbers;
      for (const ParticleIndex i : face.particles) {
        const particles::Constraint key{i, static_cast<std::uint8_t>(setup.axis), 0};
        numbers.push_back(
            static_cast<std::size_t>(std::lower_bound(list.begin(), list.end(), key) - list.begin()));
      }
      return numbers;
    };
    fixed_ = held(setup.faces.lower(setup.axis));
    loaded_ = held(setup.faces.upper(setup.axis));

    const network::Clusters clusters = network::clusters(network);
    const Vec3 inset = parameters.margin * setup.box.size();
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const Vec3& x = particles.position[i];
      if (clusters.of[i] == clusters.largest && (x.array() >= (setup.box.lower + inset).array()).all() &&
          (x.array() <= (setup.box.upper - inset).array()).all())
        interior_.push_back({static_cast<ParticleIndex>(i), x});
    }
    core::expect(interior_.size() >= 8, "number of particles in the interior", interior_.size(),
                 "at least 8 are expected: more particles, or a smaller margin");
    Vec3 mean = Vec3::Zero();
    for (const Point& point : interior_)
      mean += point.weight;
    mean /= static_cast<double>(interior_.size());
    Vec3 spread = Vec3::Zero();
    for (Point& point : interior_) {
      point.weight -= mean;
      spread += point.weight.cwiseAbs2();
    }
    for (Point& point : interior_) // sum of weight * displacement is then the slope
      point.weight = point.weight.cwiseQuotient(spread);
  }
  TensionGauge(const particles::ParticleSet& particles, const network::BondNetwork& network,
               const boundary::TensionSetup& setup)
      : TensionGauge(particles, network, setup, Parameters{}) {}

  /// Reads the faces. @complexity O(particles of the faces)
  /// @param reaction  [constraints] N, in the order of the setup's constraints
  FaceReading faces(const particles::SpatialField<>& displacement, std::span<const double> reaction) const {
    FaceReading reading;
    for (const std::size_t k : fixed_)
      reading.force_fixed -= reaction[k];
    for (const std::size_t k : loaded_)
      reading.force_loaded += reaction[k];
    const Vec3 size = setup_.box.size();
    const int axis = core::index_of(setup_.axis);
    reading.stress = reading.force_fixed / (size.prod() / size[axis]);
    const double elongation = opening(setup_.axis, displacement);
    reading.axial_strain = elongation / setup_.faces.gauge_length(setup_.axis);
    reading.nominal_strain = elongation / size[axis];
    for (const Axis other : {Axis::x, Axis::y, Axis::z})
      if (other != setup_.axis)
        reading.transverse_strain += 0.5 * opening(other, displacement) / setup_.faces.gauge_length(other);
    return reading;
  }

  /// Reads the interior. @complexity O(particles)
  InteriorReading interior(const particles::SpatialField<>& displacement) const {
    Vec3 slope = Vec3::Zero();
    for (const Point& point : interior_)
      slope += point.weight.cwiseProduct(displacement[point.particle].linear());
    const double axial = slope[core::index_of(setup_.axis)];
    return {axial, 0.5 * (slope.sum() - axial)};
  }

private:
  struct Point {
    ParticleIndex particle;
    Vec3 weight;
  };

  /// Mean displacement of the upper face less that of the lower one, along the axis, m.
  double opening(Axis axis, const particles::SpatialField<>& displacement) const {
    const auto mean = [&](const boundary::Face& face) {
      double sum = 0;
      for (const ParticleIndex i : face.particles)
        sum += displacement[i].component[core::index_of(axis)];
      return sum / static_cast<double>(face.particles.size());
    };
    return mean(setup_.faces.upper(axis)) - mean(setup_.faces.lower(axis));
  }

  boundary::TensionSetup setup_;
  std::vector<std::size_t> fixed_, loaded_; ///< numbers of the faces' constraints
  std::vector<Point> interior_;
};

} // namespace cdem::homogenize
