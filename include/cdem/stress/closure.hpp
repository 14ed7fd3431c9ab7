#pragma once

/// @file
/// Both sides of the Love–Weber theorem.
///
/// For a body at rest the internal and the external forces have the same moment:
///
///   sum over specimens of V sigma  =  sum over bonds of f (x) d  =  sum over particles of F (x) x
///
/// F the external forces (loads and reactions) on the particles, x the particles' centres. The first equality
/// is that of Sharing::by_length, with StressField::outside added where a body is not wholly tessellated; the
/// second is equilibrium of the forces, particle by particle, in a body without periodic bonds.   Love 1927;
/// Weber 1966

#include <cdem/core/error.hpp>
#include <cdem/particles/spatial_field.hpp>
#include <cdem/stress/stress_estimator.hpp>

#include <span>
#include <string>
#include <vector>

namespace cdem::stress {

namespace detail {
inline Mat3 weighted_sum(const StressField& field, const std::vector<Mat3>& tensors) {
  core::expect(field.volume.size() == tensors.size(), "number of specimen volumes", field.volume.size(),
               "one per specimen (" + std::to_string(tensors.size()) + ") is expected");
  Mat3 sum = Mat3::Zero();
  for (std::size_t cell = 0; cell < tensors.size(); ++cell)
    sum += field.volume[cell] * tensors[cell];
  return sum;
}
} // namespace detail

/// Sum of V sigma over the specimens, in Pa m^3 = N m. What is outside them is not included.
/// @throws core::InvalidInput unless the field has one volume a specimen
inline Mat3 moment_of_stress(const StressField& field) {
  return detail::weighted_sum(field, field.stress);
}

/// Sum of V mu over the specimens, in N m^2: with outside_couple that of M (x) d over the bonds, M the moments at their middles.
/// For a body at rest it is
///
///     sum over particles of M_ext (x) x  +  sum over bonds of (d x f) (x) x_m
///
/// x_m the middle of the branch, M_ext the external moments: the second term is the part of the forces that the stress,
/// not being symmetric, does not balance locally.
/// @throws core::InvalidInput unless the field has one volume and one couple stress a specimen
inline Mat3 moment_of_couple_stress(const StressField& field) {
  core::expect(
      field.couple_stress.size() == field.size(), "number of couple stresses", field.couple_stress.size(),
      "one per specimen (" + std::to_string(field.size()) + ") is expected: were the bonds' moments given?");
  return detail::weighted_sum(field, field.couple_stress);
}

/// Sum of F (x) x, in N m = Pa m^3, row = force. It depends on the origin unless the forces' sum is zero.
///
/// @param positions  [particles] m
/// @param forces     [particles] N, external
/// @throws core::InvalidInput for different lengths, or a sum that is not finite
inline Mat3 moment_of_forces(std::span<const Vec3> positions, std::span<const Vec3> forces) {
  core::expect(forces.size() == positions.size(), "number of forces", forces.size(),
               "one per position (" + std::to_string(positions.size()) + ") is expected");
  Mat3 sum = Mat3::Zero();
  for (std::size_t i = 0; i < positions.size(); ++i)
    sum.noalias() += forces[i] * positions[i].transpose();
  core::expect(sum.allFinite(), "largest part of the moment of the forces", sum.cwiseAbs().maxCoeff(),
               "finite forces and positions are expected");
  return sum;
}

/// The same from forces and moments as integrators keep them; the moments do not enter.
inline Mat3 moment_of_forces(std::span<const Vec3> positions, const particles::SpatialField<>& forces) {
  core::expect(forces.size() == positions.size(), "number of forces", forces.size(),
               "one per position (" + std::to_string(positions.size()) + ") is expected");
  Mat3 sum = Mat3::Zero();
  for (std::size_t i = 0; i < positions.size(); ++i)
    sum.noalias() += forces[i].linear() * positions[i].transpose();
  core::expect(sum.allFinite(), "largest part of the moment of the forces", sum.cwiseAbs().maxCoeff(),
               "finite forces and positions are expected");
  return sum;
}

} // namespace cdem::stress
