#pragma once

/// @file
/// What soft spheres in equilibrium have to do with each other: contacts, rattlers, pressure, balance.

#include <cdem/core/parallel.hpp>
#include <cdem/packing/detail/cell_grid.hpp>
#include <cdem/packing/detail/soft_system.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace cdem::packing::detail {

/// See survey_soft_contacts().
struct SoftContacts {
  std::uint64_t contacts = 0;  ///< pairs that overlap, and spheres that overlap a wall
  double energy = 0;           ///< E, see SoftBlock
  double virial = 0;           ///< sum of f r over the contacts (at a wall: r the height of the centre)
  double mean_force = 0;       ///< of a contact
  double mean_overlap = 0;     ///< over the sum of the radii (at a wall: over the radius)
  double largest_overlap = 0;  ///< the same
  double residual = 0;         ///< root mean square of the forces on spheres over mean_force
  double largest_residual = 0; ///< largest force on a sphere over mean_force
  std::uint32_t rattlers = 0;  ///< spheres with fewer than four contacts, taken out again and again
  double contact_number = 0;   ///< mean number of contacts of the others
};

/// A contact of one sphere: with another, or (`other` = no_sphere) with a wall.
struct SoftContact {
  ParticleIndex other;
  double distance, reach; ///< r and D; of a wall h and R
  double force, energy;
};

/// Calls visit(contact) for each contact of a sphere.
template <class Visit>
void for_each_contact(const SoftSystem& system, ParticleIndex i, Visit&& visit) {
  const Quad& own = system.spheres()[i];
  for (const ParticleIndex j : system.lists().of(i)) {
    double square = 0;
    for (int k = 0; k < 3; ++k) {
      double d = own[k] - system.spheres()[j][k];
      if (system.periodic())
        d -= nearest_integer(d);
      square += d * d;
    }
    const double reach = (own[3] + system.spheres()[j][3]) * system.scale();
    if (square < reach * reach && j != i) {
      const double push = 1 - square / (reach * reach), r = std::sqrt(square);
      visit(SoftContact{j, r, reach, push * r, 0.25 * reach * reach * push * push});
    }
  }
  if (!system.periodic())
    for (int k = 0; k < 3; ++k)
      for (const double height : {own[k], 1 - own[k]}) {
        const double radius = own[3] * system.scale(), depth = radius - height;
        if (depth > 0)
          visit(SoftContact{no_sphere, height, radius, 2 * depth, depth * depth});
      }
}

/// Spheres outside the network that holds: with fewer than four contacts, taken out again and again.
/// @param contacts  [spheres] number of contacts; on return among those that stay
/// @return          [spheres] whether it stays
inline std::vector<char> peel_rattlers(const SoftSystem& system, std::vector<std::uint32_t>& contacts) {
  std::vector<char> held(system.size(), 1);
  std::vector<ParticleIndex> loose;
  const auto judge = [&](ParticleIndex i) {
    if (held[i] && contacts[i] < 4) {
      held[i] = 0;
      loose.push_back(i);
    }
  };
  for (ParticleIndex i = 0; i < system.size(); ++i)
    judge(i);
  while (!loose.empty()) {
    const ParticleIndex i = loose.back();
    loose.pop_back();
    for_each_contact(system, i, [&](const SoftContact& contact) {
      if (contact.other != no_sphere && held[contact.other]) {
        --contacts[contact.other];
        judge(contact.other);
      }
    });
  }
  return held;
}

/// Contacts of a system after its evaluate(). @complexity O(spheres)
inline SoftContacts survey_soft_contacts(const SoftSystem& system, core::ThreadPool& pool) {
  struct Sums {
    double ends = 0, energy = 0, virial = 0, force = 0, overlap = 0, largest = 0, squares = 0, worst = 0;
    Sums& operator+=(const Sums& other) {
      ends += other.ends;
      energy += other.energy;
      virial += other.virial;
      force += other.force;
      overlap += other.overlap;
      largest = std::max(largest, other.largest);
      squares += other.squares;
      worst = std::max(worst, other.worst);
      return *this;
    }
  };
  std::vector<std::uint32_t> contacts(system.size(), 0);
  const Sums sums = core::parallel_sum(pool, system.size(), Sums{}, [&](std::size_t begin, std::size_t end) {
    Sums part;
    for (std::size_t i = begin; i < end; ++i) {
      for_each_contact(system, static_cast<ParticleIndex>(i), [&](const SoftContact& contact) {
        const double share = contact.other == no_sphere ? 1 : 0.5; // the other half is the other sphere's
        const double overlap = 1 - contact.distance / contact.reach;
        part.ends += share;
        part.energy += share * contact.energy;
        part.virial += share * contact.force * contact.distance;
        part.force += share * contact.force;
        part.overlap += share * overlap;
        part.largest = std::max(part.largest, overlap);
        ++contacts[i];
      });
      double square = 0;
      for (int k = 0; k < 3; ++k)
        square += std::pow(static_cast<double>(system.forces()[i][k]), 2);
      part.squares += square;
      part.worst = std::max(part.worst, square);
    }
    return part;
  });

  SoftContacts survey;
  survey.contacts = static_cast<std::uint64_t>(sums.ends);
  survey.energy = sums.energy;
  survey.virial = sums.virial;
  survey.largest_overlap = sums.largest;
  if (sums.ends > 0) {
    survey.mean_force = sums.force / sums.ends;
    survey.mean_overlap = sums.overlap / sums.ends;
    survey.residual = std::sqrt(sums.squares / static_cast<double>(system.size())) / survey.mean_force;
    survey.largest_residual = std::sqrt(sums.worst) / survey.mean_force;
  }
  const std::vector<char> held = peel_rattlers(system, contacts);
  double ends = 0;
  for (std::size_t i = 0; i < system.size(); ++i) {
    survey.rattlers += held[i] ? 0U : 1U;
    ends += held[i] ? contacts[i] : 0;
  }
  if (survey.rattlers < system.size())
    survey.contact_number = ends / static_cast<double>(system.size() - survey.rattlers);
  return survey;
}

} // namespace cdem::packing::detail
