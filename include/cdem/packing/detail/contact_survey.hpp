#pragma once

/// @file
/// What a finished packing's spheres have to do with each other: overlaps, contacts, rattlers.

#include <cdem/geometry/box.hpp>
#include <cdem/packing/detail/cell_grid.hpp>
#include <cdem/particles/particle_set.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace cdem::packing::detail {

/// See survey_contacts().
struct ContactSurvey {
  double largest_overlap =
      0; ///< relative to the sum of the radii (at a wall: to the radius); 0 if none touch
  std::uint32_t rattlers = 0; ///< spheres outside the network that holds
  double contact_number =
      0; ///< mean contacts of the others among themselves and with walls; 0 if there are none
};

/// Contacts, overlaps and rattlers of a packing, by a neighbour search of its own.
///
/// Two spheres touch if their gap is below `tolerance` times the sum of their radii (at a wall: the radius). Spheres
/// with fewer than four contacts cannot be held fast: they are rattlers, and are taken out again and again until all
/// that are left have four.
/// @param tolerance  not negative, below 1
/// @complexity       O(spheres) unless sizes differ widely
inline ContactSurvey survey_contacts(const particles::ParticleSet& spheres, const geometry::Box& box,
                                     double tolerance) {
  const bool periodic = box.periodic[0];
  const double edge = box.size()[0];
  const std::size_t count = spheres.size();
  const double largest = *std::max_element(spheres.radius.begin(), spheres.radius.end()) / edge;
  CellGrid grid(count, 2 * spheres.mean_radius() / edge, periodic);
  std::vector<Vec3> point(count);
  for (ParticleIndex i = 0; i < count; ++i) {
    point[i] = (spheres.position[i] - box.lower) / edge;
    grid.insert(i, point[i]);
  }

  ContactSurvey survey;
  std::vector<std::uint32_t> contacts(count, 0);
  std::vector<std::array<ParticleIndex, 2>> pairs;
  const auto judge = [&](double relative_gap) {
    survey.largest_overlap = std::max(survey.largest_overlap, -relative_gap);
    return relative_gap < tolerance;
  };
  for (ParticleIndex i = 0; i < count; ++i) {
    const double radius = spheres.radius[i];
    grid.visit_near(point[i], (1 + tolerance) * (radius / edge + largest), [&](ParticleIndex j) {
      if (j <= i)
        return true;
      const double sum = radius + spheres.radius[j];
      const double distance = box.minimum_image(spheres.position[j] - spheres.position[i]).norm();
      if (judge((distance - sum) / sum)) {
        pairs.push_back({i, j});
        ++contacts[i];
        ++contacts[j];
      }
      return true;
    });
    if (!periodic)
      for (int k = 0; k < 3; ++k) {
        contacts[i] += judge((spheres.position[i][k] - box.lower[k] - radius) / radius);
        contacts[i] += judge((box.upper[k] - spheres.position[i][k] - radius) / radius);
      }
  }

  // Peels rattlers off until none is left; each round drops the pairs that have lost a sphere.
  std::vector<char> held(count, 1);
  for (bool changed = true; changed;) {
    changed = false;
    for (ParticleIndex i = 0; i < count; ++i)
      if (held[i] && contacts[i] < 4) {
        held[i] = 0;
        changed = true;
      }
    std::erase_if(pairs, [&](const auto& pair) {
      if (held[pair[0]] && held[pair[1]])
        return false;
      --contacts[pair[0]];
      --contacts[pair[1]];
      return true;
    });
  }
  double sum = 0;
  for (ParticleIndex i = 0; i < count; ++i) {
    survey.rattlers += held[i] ? 0U : 1U;
    sum += held[i] ? contacts[i] : 0;
  }
  if (survey.rattlers < count)
    survey.contact_number = sum / static_cast<double>(count - survey.rattlers);
  return survey;
}

} // namespace cdem::packing::detail
