#pragma once

// How the stress scatters over the specimens of a body, and how that falls with their size.

#include <cdem/stress/distribution.hpp>
#include <cdem/stress/love_weber.hpp>
#include <cdem/stress/tessellation/tetrahedra.hpp>
#include <cdem/stress/tessellation/wedges.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace cdem::examples::stress_homogeneous {

/// One component of the stress over some specimens.
struct Scatter {
  stress::SampleMoments moments;
  double minimum = 0; ///< Pa
  double maximum = 0; ///< Pa
  stress::AndersonDarling normal;
  std::optional<stress::AndersonDarling> lognormal;       ///< none where a value is not above 0
  std::optional<stress::LikelihoodComparison> likelihood; ///< likewise

  double cov() const { return moments.coefficient_of_variation(); }
};

/// @return none for fewer than 8 values
inline std::optional<Scatter> scatter_of(const std::vector<double>& values) {
  if (values.size() < 8)
    return std::nullopt;
  Scatter scatter;
  scatter.moments = stress::sample_moments(values);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  scatter.minimum = *low;
  scatter.maximum = *high;
  scatter.normal = stress::anderson_darling_normal(values);
  if (scatter.minimum > 0) {
    scatter.lognormal = stress::anderson_darling_lognormal(values);
    scatter.likelihood = stress::normal_or_lognormal(values);
  }
  return scatter;
}

/// The shape of the specimens, and the rule by which a bond is shared among them.
enum class Cells : std::uint8_t { hexahedra, hexahedra_by_contact, wedges, tetrahedra };

inline constexpr std::array all_cells{Cells::hexahedra, Cells::hexahedra_by_contact, Cells::wedges,
                                      Cells::tetrahedra};

inline const char* name_of(Cells cells) {
  constexpr const char* names[] = {"hexahedra", "hexahedra_by_contact", "wedges", "tetrahedra"};
  return names[static_cast<std::size_t>(cells)];
}
/// Specimens that a hexahedron of the grid is cut into.
inline std::size_t parts_of(Cells cells) {
  return cells == Cells::wedges ? 2 : cells == Cells::tetrahedra ? 6 : 1;
}

/// Calls use(estimator) with the Love–Weber estimator on these cells of a grid.
template <class Use>
auto with_estimator(Cells cells, const stress::tessellation::Hexahedra& grid, stress::Outside outside,
                    Use&& use) {
  using stress::LoveWeber;
  if (cells == Cells::wedges)
    return use(
        LoveWeber<stress::tessellation::Wedges>(stress::tessellation::Wedges(grid), {.outside = outside}));
  if (cells == Cells::tetrahedra)
    return use(LoveWeber<stress::tessellation::Tetrahedra>(stress::tessellation::Tetrahedra(grid),
                                                           {.outside = outside}));
  const auto sharing = cells == Cells::hexahedra ? stress::Sharing::by_length : stress::Sharing::by_midpoint;
  return use(LoveWeber<>(grid, {sharing, outside}));
}

/// The hexahedra of a grid as a body in tension sees them.
class Places {
public:
  Places(const stress::tessellation::Hexahedra& grid, Axis load) : grid_(grid), load_(core::index_of(load)) {}

  /// Number of a hexahedron's layer along an axis.
  int layer(std::size_t hexahedron, int axis) const {
    const auto& n = grid_.counts();
    const auto x = static_cast<std::size_t>(n[0]), y = static_cast<std::size_t>(n[1]);
    return static_cast<int>(axis == 0   ? hexahedron % x
                            : axis == 1 ? hexahedron / x % y
                                        : hexahedron / (x * y));
  }
  bool outermost(std::size_t hexahedron, int axis) const {
    const int at = layer(hexahedron, axis);
    return at == 0 || at == grid_.counts()[static_cast<std::size_t>(axis)] - 1;
  }
  /// In no outer layer: none of its specimens touches a face of the body.
  bool interior(std::size_t hexahedron) const {
    return !outermost(hexahedron, 0) && !outermost(hexahedron, 1) && !outermost(hexahedron, 2);
  }
  /// Every other hexahedron along each axis: what is left are no neighbours.
  bool thinned(std::size_t hexahedron) const {
    return layer(hexahedron, 0) % 2 == 1 && layer(hexahedron, 1) % 2 == 1 && layer(hexahedron, 2) % 2 == 1;
  }
  /// Which face it touches: loaded, fixed, side; none.
  const char* face(std::size_t hexahedron) const {
    if (outermost(hexahedron, load_))
      return layer(hexahedron, load_) == 0 ? "fixed" : "loaded";
    return interior(hexahedron) ? "none" : "side";
  }

private:
  const stress::tessellation::Hexahedra& grid_;
  int load_;
};

/// An extreme value and where it lies.
struct Extreme {
  double stress = 0;          ///< Pa
  Vec3 centre = Vec3::Zero(); ///< m, of the hexahedron
  std::string face;           ///< that it touches
};

/// A body cut into specimens of one volume.
struct Tessellated {
  Cells cells = Cells::hexahedra;
  int divisions = 0; ///< hexahedra along an edge
  std::size_t specimens = 0;
  double particles = 0;     ///< a specimen, in the mean
  double particles_cov = 0; ///< of that number
  double moment = 0;        ///< sum of V sigma, N m
  Scatter all;
  std::optional<Scatter> interior; ///< of the specimens in no outer layer of hexahedra
  std::optional<Scatter> thinned;  ///< of every other one of these along each axis
  Extreme minimum, maximum;
  double surface = 0; ///< CoV of the means of classes of specimens: by the faces of the body that they touch
  double along = 0,
         across = 0; ///< correlation of neighbours of the interior, along the load and across; hexahedra
};

namespace detail {

/// Correlation of two neighbouring hexahedra of the interior, one a step along `axis` from the other.
inline double correlation(const std::vector<double>& values, const stress::tessellation::Hexahedra& grid,
                          const Places& places, const stress::SampleMoments& moments, int axis) {
  std::size_t step = 1;
  for (int k = 0; k < axis; ++k)
    step *= static_cast<std::size_t>(grid.counts()[static_cast<std::size_t>(k)]);
  double sum = 0, pairs = 0;
  for (std::size_t h = 0; h + step < values.size(); ++h)
    if (places.interior(h) && places.layer(h, axis) + 2 < grid.counts()[static_cast<std::size_t>(axis)]) {
      sum += (values[h] - moments.mean) * (values[h + step] - moments.mean);
      ++pairs;
    }
  return sum / (pairs * moments.standard_deviation * moments.standard_deviation);
}

} // namespace detail

namespace detail {

/// Standard deviation of the classes' means over the mean of all: specimens that touch so many faces across the load and so many
/// along it. What is left of the scatter is within the classes.
inline double between_classes(const std::vector<double>& values, std::size_t parts, const Places& places,
                              Axis load, double mean) {
  std::array<double, 6> sum{}, count{};
  for (std::size_t s = 0; s < values.size(); ++s) {
    std::size_t touched = 0;
    for (int axis = 0; axis < 3; ++axis)
      touched += places.outermost(s / parts, axis) ? (axis == core::index_of(load) ? 3U : 1U) : 0U;
    sum[touched] += values[s];
    count[touched] += 1;
  }
  double squares = 0;
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (count[k] > 0)
      squares += count[k] * (sum[k] / count[k] - mean) * (sum[k] / count[k] - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1)) / std::abs(mean);
}

} // namespace detail

/// Judges the component sigma_aa, a the axis of the load, of a field over the cells of a grid that covers the body.
/// @throws core::InvalidInput for fewer than 8 specimens
inline Tessellated judge(const stress::StressField& field, Cells cells,
                         const stress::tessellation::Hexahedra& grid, Axis load) {
  const int axis = core::index_of(load);
  const Places places(grid, load);
  Tessellated result;
  result.cells = cells;
  result.divisions = grid.counts()[0];
  result.specimens = field.size();
  const std::size_t parts = parts_of(cells);
  std::vector<double> all, interior, thinned, particles;
  std::size_t least = 0, most = 0;
  for (std::size_t s = 0; s < field.size(); ++s) {
    const double value = field.stress[s](axis, axis);
    all.push_back(value);
    particles.push_back(field.particles[s]);
    result.moment += field.volume[s] * value;
    least = value < all[least] ? s : least;
    most = value > all[most] ? s : most;
    if (places.interior(s / parts)) {
      interior.push_back(value);
      if (s % parts == 0 && places.thinned(s / parts))
        thinned.push_back(value);
    }
  }
  const auto extreme = [&](std::size_t s) {
    return Extreme{all[s], grid.centre(s / parts), places.face(s / parts)};
  };
  result.minimum = extreme(least);
  result.maximum = extreme(most);
  const auto scatter = scatter_of(all);
  core::expect(scatter.has_value(), "number of specimens", all.size(), "8 or more is expected");
  result.all = *scatter;
  result.interior = scatter_of(interior);
  result.surface = detail::between_classes(all, parts, places, load, result.all.moments.mean);
  result.thinned = scatter_of(thinned);
  const auto numbers = stress::sample_moments(particles);
  result.particles = numbers.mean;
  result.particles_cov = numbers.coefficient_of_variation();
  if (parts == 1 && result.interior) {
    for (int k = 0; k < 3; ++k) {
      const double r = detail::correlation(all, grid, places, result.interior->moments, k);
      (k == axis ? result.along : result.across) += k == axis ? r : 0.5 * r;
    }
  }
  return result;
}

/// Particles a specimen and the CoV that they give.
using Curve = std::vector<std::pair<double, double>>;

/// CoV = factor n^exponent.
struct PowerLaw {
  double exponent = 0;
  double error = 0; ///< standard error of the exponent; NaN for two points
  double factor = 0;

  double particles_at(double cov) const { return std::pow(cov / factor, 1 / exponent); }
};

/// Least squares in the logarithms.
/// @throws core::InvalidInput for fewer than two points
inline PowerLaw power_law(const Curve& curve) {
  core::expect(curve.size() >= 2, "number of points", curve.size(), "2 or more is expected");
  const double n = static_cast<double>(curve.size());
  double x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  for (const auto& [particles, cov] : curve) {
    x += std::log(particles) / n;
    y += std::log(cov) / n;
  }
  for (const auto& [particles, cov] : curve) {
    const double dx = std::log(particles) - x, dy = std::log(cov) - y;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  const double slope = xy / xx;
  const double error = n > 2 ? std::sqrt(std::max(0.0, yy - slope * xy) / (n - 2) / xx)
                             : std::numeric_limits<double>::quiet_NaN();
  return {slope, error, std::exp(y - slope * x)};
}

/// Independent particles in the bulk, and under each face of a cube of N particles a layer that carries nothing, d mean distances of
/// particles thick. It lowers the hexahedra at the faces, of edge h, by d/h, and these are a part p = 2 h/L of all for each pair of
/// faces, so that it adds 3 p (1 - p) (d/h)^2:
///
///     CoV^2 = bulk^2/n + 6 d^2 (1 - 2 (n/N)^(1/3)) / (N n)^(1/3)
struct TwoParts {
  double bulk = 0;  ///< CoV of a specimen of one particle, as it were
  double layer = 0; ///< d; 0 where the curve falls faster than its bulk alone
};

/// Least squares in CoV^2, relative to its value at each point; exact through two points.
/// @param total  N
/// @throws core::InvalidInput for fewer than two points
inline TwoParts two_parts(const Curve& curve, double total) {
  core::expect(curve.size() >= 2, "number of points", curve.size(), "2 or more is expected");
  double aa = 0, ab = 0, bb = 0, a1 = 0, b1 = 0;
  for (const auto& [particles, cov] : curve) {
    const double a = 1 / (particles * cov * cov);
    const double b = 6 * (1 - 2 * std::cbrt(particles / total)) / (std::cbrt(total * particles) * cov * cov);
    aa += a * a;
    ab += a * b;
    bb += b * b;
    a1 += a;
    b1 += b;
  }
  const double determinant = aa * bb - ab * ab;
  const auto root = [&](double part) { return std::sqrt(std::max(0.0, part / determinant)); };
  return {root(a1 * bb - b1 * ab), root(b1 * aa - a1 * ab)};
}

/// Where a curve falls to a CoV: between two points of it, or beyond its ends by the power law of the whole.
struct Crossing {
  double particles = 0;
  bool interpolated = false;
};

/// Straight between the points in the logarithms. The first place from below, points in the order of particles.
inline Crossing crossing(Curve curve, double cov) {
  std::sort(curve.begin(), curve.end());
  for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
    const auto& [n0, c0] = curve[k];
    const auto& [n1, c1] = curve[k + 1];
    if (n1 > n0 && c0 >= cov && c1 < cov)
      return {n0 * std::pow(n1 / n0, std::log(cov / c0) / std::log(c1 / c0)), true};
  }
  return {power_law(curve).particles_at(cov), false};
}

} // namespace cdem::examples::stress_homogeneous
