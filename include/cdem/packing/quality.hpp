#pragma once

/// @file
/// How good a packing is: density, sizes, contacts, order near and far, directions of its bonds.

#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/network/anisotropy.hpp>
#include <cdem/network/bonds.hpp>
#include <cdem/network/coordination.hpp>
#include <cdem/packing/detail/pair_statistics.hpp>
#include <cdem/packing/detail/structure_factor.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace cdem::packing {

/// What quality() is to look at. Lengths in mean diameters d, so that packings of any size can be compared.
struct QualityParameters {
  double coordination = 6.2; ///< Z of the network whose eps, E_k and degrees are reported, [L17] section 2.1
  /// Gaps up to this part of the sum of the radii (at a wall: of the radius) are contacts. None: 100 over the reduced
  /// pressure, at most 0.01, since the gaps of a jammed packing shrink as its inverse; 1e-3 where that is not known.
  std::optional<double> contact_tolerance = {};
  std::optional<double> reduced_pressure =
      {};                       ///< PV/NkT as the generator reports it; not computable from a packing
  std::vector<double> eps = {}; ///< of eq. 1, any finite ones: Z is reported at each
  double smallest_gap = 1e-9;   ///< d; first point of the curve of Z against the gap
  double largest_gap = 0.3;     ///< d; last point
  std::size_t gaps_per_decade = 20;
  double pair_range = 5;    ///< d; g(r) up to here, or half the shortest edge where that is less
  double pair_class = 0.02; ///< d; width of a class of g(r); class c is centred on c widths
  int wave_number = 6;      ///< S(k) up to this multiple of 2 pi over the longest edge, 0 to 64; 0: none
};

/// Mean, scatter and extremes of the radii, m.
struct RadiusStatistics {
  double mean = 0, standard_deviation = 0, smallest = 0, largest = 0;
  double skewness =
      0; ///< third central moment over the third power of the standard deviation; 0 for equal radii
  double cov() const { return standard_deviation / mean; }
};

/// The account of a packing.
struct Quality {
  std::uint64_t particles = 0;
  double density = 0;        ///< the spheres' volume over the box's; overlaps count twice
  double number_density = 0; ///< 1/m^3
  RadiusStatistics radius;
  std::optional<double> reduced_pressure; ///< as given

  // Contacts, walls included
  double contact_tolerance = 0; ///< used
  double contact_number = 0;    ///< mean of all spheres
  double backbone_number =
      0; ///< mean of those left when rattlers are out: 6 in a jammed frictionless packing
  std::uint64_t rattlers = 0; ///< spheres with fewer than four contacts, taken out again and again
  double largest_overlap = 0; ///< of two spheres, over the sum of their radii
  std::vector<std::uint64_t> contacts_histogram; ///< [c] spheres with c contacts

  // The network of the wanted coordination number
  double coordination = 0;          ///< Z reached, to within one bond
  double eps = 0;                   ///< eq. 1
  network::Anisotropy<> anisotropy; ///< E_k and the three polar histograms, eq. 2
  double isotropic_deviation = 0;   ///< root mean square of E_k that chance alone gives to so many bonds
  network::DegreeHistogram degrees;

  // Z = 2 pairs / spheres against the gap of two surfaces, [points]
  std::vector<double> gap;     ///< m
  std::vector<double> gap_eps; ///< the same as eps of eq. 1: over the box's side
  std::vector<double> gap_coordination;
  std::vector<double> eps_coordination; ///< [eps] Z at those asked for

  // Pair correlation of the centres, [classes]
  std::vector<double> distance;         ///< m; middle of the class
  std::vector<double> pair_correlation; ///< g(r): pairs over those of as many independent points in this box

  // Structure factors of the longest waves, [classes]; empty unless the box is periodic in all directions
  std::vector<double> wave_number;             ///< 1/m; mean of |k| in the class
  std::vector<std::uint32_t> wave_vectors;     ///< averaged over, k and -k counted once
  std::vector<double> structure_factor;        ///< of the centres, |sum exp(-i k x)|^2 / N
  std::vector<double> volume_structure_factor; ///< of the volumes v, |sum v exp(-i k x)|^2 / sum v^2
};

namespace detail {

inline RadiusStatistics radius_statistics(const std::vector<double>& radii) {
  RadiusStatistics result;
  const auto count = static_cast<double>(radii.size());
  for (const double r : radii)
    result.mean += r / count;
  double second = 0, third = 0;
  for (const double r : radii) {
    const double d = r / result.mean - 1;
    second += d * d / count;
    third += d * d * d / count;
  }
  const auto [low, high] = std::minmax_element(radii.begin(), radii.end());
  result.smallest = *low;
  result.largest = *high;
  if (*low < *high) { // rounding of the mean is no scatter
    result.standard_deviation = std::sqrt(second) * result.mean;
    result.skewness = third / std::pow(second, 1.5);
  }
  return result;
}

inline void validate(const QualityParameters& p) {
  core::expect_positive(p.coordination, "coordination number Z");
  if (p.contact_tolerance)
    core::expect(*p.contact_tolerance >= 0 && *p.contact_tolerance < 1, "contact tolerance",
                 *p.contact_tolerance, "0 to below 1 is expected");
  if (p.reduced_pressure)
    core::expect_positive(*p.reduced_pressure, "reduced pressure");
  for (const double eps : p.eps)
    core::expect_finite(eps, "eps");
  core::expect_positive(p.smallest_gap, "smallest gap", "d");
  core::expect(p.largest_gap > p.smallest_gap && p.largest_gap <= 2, "largest gap", p.largest_gap,
               "above the smallest gap and at most 2 d is expected");
  core::expect(p.gaps_per_decade >= 1 && p.gaps_per_decade <= 1000, "gaps per decade", p.gaps_per_decade,
               "1 to 1000 is expected");
  core::expect(p.pair_range > 0 && p.pair_range <= 20, "range of g(r)", p.pair_range,
               "above 0 and at most 20 d is expected");
  core::expect(p.pair_class >= 1e-4 && p.pair_class <= p.pair_range, "class of g(r)", p.pair_class,
               "1e-4 d to the range is expected");
  core::expect(p.wave_number >= 0 && p.wave_number <= 64, "largest wave number", p.wave_number,
               "0 to 64 is expected");
}

/// The gaps of the curve, m: `per_decade` a decade from the smallest to the largest.
inline std::vector<double> gap_points(const QualityParameters& p, double diameter) {
  const double decades = std::log10(p.largest_gap / p.smallest_gap);
  const auto steps = static_cast<std::size_t>(std::ceil(decades * static_cast<double>(p.gaps_per_decade)));
  std::vector<double> points;
  for (std::size_t k = 0; k <= steps; ++k)
    points.push_back(diameter * p.smallest_gap *
                     std::pow(10, decades * static_cast<double>(k) / static_cast<double>(steps)));
  return points;
}

inline std::vector<std::uint32_t> wall_contacts(const particles::ParticleSet& spheres,
                                                const geometry::Box& box, double tolerance) {
  std::vector<std::uint32_t> contacts(spheres.size(), 0);
  for (int k = 0; k < 3; ++k)
    if (!box.periodic[static_cast<std::size_t>(k)])
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        const double reach = (1 + tolerance) * spheres.radius[i];
        contacts[i] += spheres.position[i][k] - box.lower[k] <= reach;
        contacts[i] += box.upper[k] - spheres.position[i][k] <= reach;
      }
  return contacts;
}

/// Contacts, Z against the gap and g(r).
inline void survey_pairs(Quality& result, const particles::ParticleSet& spheres, const geometry::Box& box,
                         const QualityParameters& p, core::ThreadPool& pool) {
  const double diameter = 2 * result.radius.mean, side = network::characteristic_length(box);
  const double half_edge = box.size().minCoeff() / 2 * (1 - 1e-6);
  result.contact_tolerance =
      p.contact_tolerance.value_or(p.reduced_pressure ? std::min(100 / *p.reduced_pressure, 0.01) : 1e-3);

  PairCounts counts;
  counts.contact_tolerance = result.contact_tolerance;
  counts.distance_class = p.pair_class * diameter;
  const double range = std::min(p.pair_range * diameter, half_edge);
  counts.distance_classes = static_cast<std::size_t>(range / counts.distance_class + 0.5);
  result.gap = gap_points(p, diameter);
  counts.gap = result.gap;
  for (const double eps : p.eps)
    counts.gap.push_back(eps * side);
  std::sort(counts.gap.begin(), counts.gap.end());

  const double largest = 2 * result.radius.largest;
  const double reach =
      std::max({range, largest + std::max(counts.gap.back(), 0.0), largest * (1 + result.contact_tolerance)});
  network::detail::expect_one_image(box, reach);
  const PairStatistics pairs = count_pairs(spheres, box, reach, counts, pool);

  const auto count = static_cast<double>(result.particles);
  const auto coordination_at = [&](double gap) {
    const auto at = std::lower_bound(counts.gap.begin(), counts.gap.end(), gap) - counts.gap.begin();
    return 2 * static_cast<double>(pairs.within[static_cast<std::size_t>(at)]) / count;
  };
  for (const double gap : result.gap) {
    result.gap_eps.push_back(gap / side);
    result.gap_coordination.push_back(coordination_at(gap));
  }
  for (const double eps : p.eps)
    result.eps_coordination.push_back(coordination_at(eps * side));

  const double per_volume = count * (count - 1) / (2 * box.volume() * box.volume());
  double inner = 0;
  for (std::size_t c = 0; c < counts.distance_classes; ++c) {
    const double outer = pair_volume(box, (static_cast<double>(c) + 0.5) * counts.distance_class);
    result.distance.push_back(static_cast<double>(c) * counts.distance_class);
    result.pair_correlation.push_back(static_cast<double>(pairs.distance[c]) /
                                      (per_volume * (outer - inner)));
    inner = outer;
  }

  const Skeleton held =
      skeleton(spheres.size(), pairs.contacts, wall_contacts(spheres, box, result.contact_tolerance));
  result.rattlers = held.rattlers;
  result.backbone_number = held.contact_number;
  result.largest_overlap = pairs.largest_overlap;
  double sum = 0;
  for (const std::uint32_t contacts : held.contacts) {
    if (contacts >= result.contacts_histogram.size())
      result.contacts_histogram.resize(contacts + std::size_t{1}, 0);
    ++result.contacts_histogram[contacts];
    sum += contacts;
  }
  result.contact_number = sum / count;
}

inline void survey_waves(Quality& result, const particles::ParticleSet& spheres, const geometry::Box& box,
                         int most, core::ThreadPool& pool) {
  if (most == 0 || !(box.periodic[0] && box.periodic[1] && box.periodic[2]))
    return;
  const WaveSums waves = wave_sums(spheres, box, most, pool, quality_blocks);
  double squared_weights = 0;
  for (const double r : spheres.radius)
    squared_weights += std::pow(r, 6);
  const auto count = static_cast<double>(spheres.size());
  const double mean_cube = spheres.solid_volume() / (4.0 / 3.0 * std::numbers::pi * count);
  squared_weights /= mean_cube * mean_cube;

  const auto classes = static_cast<std::size_t>(most);
  result.wave_number.assign(classes, 0);
  result.wave_vectors.assign(classes, 0);
  result.structure_factor.assign(classes, 0);
  result.volume_structure_factor.assign(classes, 0);
  const Vec3 edge = box.size();
  const double unit = 2 * std::numbers::pi / edge.maxCoeff();
  for (int a = 0; a <= most; ++a)
    for (int b = a == 0 ? 0 : -most; b <= most; ++b)
      for (int c = a == 0 && b == 0 ? 1 : -most; c <= most; ++c) {
        const double k = 2 * std::numbers::pi * Vec3(a, b, c).cwiseQuotient(edge).norm();
        const auto nearest = static_cast<std::size_t>(std::lround(k / unit));
        if (nearest > classes)
          continue;
        const auto& sum = waves.sum[waves.index(a, b, c)];
        ++result.wave_vectors[nearest - 1];
        result.wave_number[nearest - 1] += k;
        result.structure_factor[nearest - 1] += (sum[0] * sum[0] + sum[1] * sum[1]) / count;
        result.volume_structure_factor[nearest - 1] += (sum[2] * sum[2] + sum[3] * sum[3]) / squared_weights;
      }
  for (std::size_t c = 0; c < classes; ++c) // none is empty: the longest edge alone gives one vector a class
    for (auto* values : {&result.wave_number, &result.structure_factor, &result.volume_structure_factor})
      (*values)[c] /= result.wave_vectors[c];
}

} // namespace detail

/// Everything that can be said of a packing from its spheres and its box.
///
///     g(r) = pairs in the class / (N(N-1)/2 * mean over u of the share of the box whose shift by r u stays inside it)
///
/// so that independent points give 1 in every class, between walls too;
///
///     S(k) = |sum_i exp(-i k x_i)|^2 / N,    S_v(k) = |sum_i v_i exp(-i k x_i)|^2 / sum_i v_i^2
///
/// at the wave vectors that fit a periodic box, averaged over classes one 2 pi/L wide about 1, 2, ... times 2 pi/L. Both
/// are 1 for independent spheres; near k = 0 S is the variance of the number of centres in large volumes over its mean, and S_v
/// the like of the solid volume (Torquato and Stillinger 2003). E_k, eps: network/anisotropy.hpp, network/bonds.hpp.
/// @param pool  results are the same to the last bit for any number of threads
/// @throws      core::InvalidInput for particles, a box or parameters that are not accepted, fewer than two particles, or a
///              periodic edge not above twice the farthest pair looked for: the largest diameter and the widest gap
/// @complexity  O(spheres (range/d)^3 + spheres wave_number^3 + spheres log spheres); docs/packing_quality.md has times
inline Quality quality(const particles::ParticleSet& particles, const geometry::Box& box,
                       const QualityParameters& parameters, core::ThreadPool& pool) {
  particles.validate();
  box.validate();
  detail::validate(parameters);
  core::expect(particles.size() >= 2, "number of particles", particles.size(), "at least 2 are expected");
  Quality result;
  result.particles = particles.size();
  result.density = particles.solid_volume() / box.volume();
  result.number_density = static_cast<double>(particles.size()) / box.volume();
  result.radius = detail::radius_statistics(particles.radius);
  result.reduced_pressure = parameters.reduced_pressure;
  detail::survey_pairs(result, particles, box, parameters, pool);
  detail::survey_waves(result, particles, box, parameters.wave_number, pool);
  const auto bonds = network::bonds_at_coordination(particles, box, parameters.coordination, pool);
  result.coordination = bonds.coordination;
  result.eps = bonds.eps;
  result.anisotropy = network::anisotropy(bonds.network);
  result.isotropic_deviation = network::isotropic_deviation(bonds.network.size());
  result.degrees = network::degree_histogram(bonds.network);
  return result;
}

/// The same on the calling thread alone.
inline Quality quality(const particles::ParticleSet& particles, const geometry::Box& box,
                       const QualityParameters& parameters = {}) {
  core::ThreadPool one_thread(1);
  return quality(particles, box, parameters, one_thread);
}

} // namespace cdem::packing
