#pragma once

/// @file
/// The tension test of the paper.

#include <cdem/boundary/faces.hpp>
#include <cdem/particles/constraints.hpp>

namespace cdem::boundary {

/// A body with its faces found and its degrees of freedom prescribed.
struct TensionSetup {
  Axis axis = Axis::x;
  geometry::Box box;
  Faces faces;
  particles::Constraints constraints;
};

/// Tension along one axis with *symmetric boundary conditions*, [L17] section 2.3.
///
/// On the three lower faces the particles have no displacement along the face's normal (planes of symmetry); those of
/// the upper face of `axis` move along it at a constant velocity, imposed at once or over the integrator's ramp; the other
/// two upper faces are free of traction and need not stay plane. Tangential motion and rotations are free everywhere.
struct SymmetricTension {
  Axis axis = Axis::x;
  double velocity = 1e-5; ///< m/s, the paper's; negative compresses; a static solver reads it as m
  double tolerance = 0;   ///< m, see find_faces()

  /// @throws core::InvalidInput for a velocity that is zero or not finite, faces that cannot be found, or a particle
  ///         that reaches both faces of `axis`
  TensionSetup apply(const particles::ParticleSet& particles, const network::BondNetwork& network,
                     const geometry::Box& box) const {
    core::expect(std::isfinite(velocity) && velocity != 0, "velocity of the loaded face", velocity,
                 "a finite number other than 0 m/s is expected");
    TensionSetup setup{axis, box, find_faces(particles, network, box, tolerance), {}};
    std::vector<particles::Constraint> wanted;
    const auto prescribe = [&](const Face& face, Axis normal, double rate) {
      for (const ParticleIndex i : face.particles)
        wanted.push_back({i, static_cast<std::uint8_t>(normal), rate});
    };
    for (const Axis normal : {Axis::x, Axis::y, Axis::z})
      prescribe(setup.faces.lower(normal), normal, 0);
    prescribe(setup.faces.upper(axis), axis, velocity);
    std::stable_sort(wanted.begin(), wanted.end());
    for (const auto& constraint : wanted)
      setup.constraints.add(constraint);
    return setup;
  }
};

} // namespace cdem::boundary
