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

namespace cdem::stress {

/// Sum of V sigma over the specimens, in Pa m^3 = N m. What is outside them is not included.
/// @throws core::InvalidInput unless the field has one volume a specimen
inline Mat3 moment_of_stress(const StressField& field) {
  core::expect(field.volume.size() == field.size(), "number of specimen volumes", field.volume.size(),
               "one per specimen (" + std::to_string(field.size()) + ") is expected");
  Mat3 sum = Mat3::Zero();
  for (std::size_t cell = 0; cell < field.size(); ++cell)
    sum += field.volume[cell] * field.stress[cell];
  return sum;
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
