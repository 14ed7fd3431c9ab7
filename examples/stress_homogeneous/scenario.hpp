#pragma once

// How the stress of a homogeneous cube in tension scatters from specimen to specimen: [L17] section 2.5, figure 9.

#include <cdem/stress/closure.hpp>
#include <cdem/stress/coarse_graining.hpp>
#include <cdem/stress/halo.hpp>

#include <set>

#include "rve_tension/scenario.hpp"
#include "scatter.hpp"

namespace cdem::examples::stress_homogeneous {

/// Of the paper's run.
inline constexpr double paper_particles = 700000;
inline constexpr int paper_slice = 15; ///< hexahedra along an edge in figure 9a

struct Params {
  rve_tension::Params tension = silica_in_tension();
  double strain = 3.75e-3; ///< between the faces, [L17] section 2.5
  /// Hexahedra along an edge. Where none is given: those that give the particles a specimen of the paper's 343 to 21,952
  /// hexahedra at 700,000 particles.
  std::vector<int> divisions = {};
  /// Particles in the volumes over which the estimators are compared.
  std::vector<double> volumes = {30, 80, 250, 1200};

  /// @throws core::InvalidInput for what no stage would accept, before anything is computed or written
  void validate() const {
    tension.validate();
    core::expect_positive(strain, "strain");
    for (const int n : divisions)
      core::expect(n >= 2 && n <= 1000, "divisions", n, "2 to 1000 hexahedra along an edge are expected");
    for (const double particles : volumes)
      core::expect(particles >= 1, "volumes", particles, "1 particle or more is expected");
  }

  /// Silica glass alone, by the static solver: the problem is linear.
  static rve_tension::Params silica_in_tension() {
    rve_tension::Params params;
    params.method = rve_tension::Method::statics;
    params.relative_residual = 1e-10; // the specimens then add up to the reactions within 1e-9
    params.materials = {rve_tension::paper_materials()[1]};
    return params;
  }
};

/// An estimator over volumes of one size in the interior of the body.
struct Average {
  std::string estimator;
  double particles = 0; ///< in that volume
  Scatter scatter;
};

/// Mean stress of a layer of hexahedra, over that of the body.
struct Layer {
  double position = 0;          ///< of its middle, over the side
  std::array<double, 3> mean{}; ///< layers across x, y and z
};

struct Result {
  rve_tension::Result tension;
  double strain = 0;          ///< to which all is scaled
  double scale = 0;           ///< from the solution to that strain
  double face_stress = 0;     ///< F/S, Pa: E times strain of this packing
  double interior_stress = 0; ///< E by the slope in the interior, times the strain of the faces, Pa
  double mean_stress = 0;     ///< sum of F x over the volume, Pa
  double gauge_length = 0;    ///< distance of the faces' mean centres, m
  double force_length = 0;    ///< the same weighted by the forces on them, m
  std::vector<Tessellated> tessellations;
  std::vector<Average> averages;
  stress::tessellation::Hexahedra slice_cells; ///< of figure 9a
  stress::StressField slice;
  std::vector<Layer> layers; ///< of that tessellation

  const rve_tension::MaterialResult& material() const { return tension.materials.front(); }
  Axis axis() const { return tension.setup.axis; }
  std::vector<const Tessellated*> with(Cells cells) const {
    std::vector<const Tessellated*> found;
    for (const Tessellated& one : tessellations)
      if (one.cells == cells)
        found.push_back(&one);
    return found;
  }
  /// CoV against particles a specimen, over all specimens or those of the interior.
  Curve curve(Cells cells, bool interior) const {
    Curve curve;
    for (const Tessellated* one : with(cells))
      if (!interior || one->interior)
        curve.emplace_back(one->particles, interior ? one->interior->cov() : one->all.cov());
    return curve;
  }
  Curve curve(const std::string& estimator) const {
    Curve curve;
    for (const Average& one : averages)
      if (one.estimator == estimator)
        curve.emplace_back(one.particles, one.scatter.cov());
    return curve;
  }
};

namespace detail {

/// Divisions of the paper's tessellations, and a few between, so many times fewer that specimens hold as many particles.
inline std::vector<int> divisions_of(const Params& params, std::size_t particles) {
  if (!params.divisions.empty())
    return params.divisions;
  const double factor = std::cbrt(static_cast<double>(particles) / paper_particles);
  std::set<int> divisions; // once each
  for (const int n : {7, 9, 11, 13, paper_slice, 18, 20, 23, 28})
    divisions.insert(std::max(2, static_cast<int>(std::lround(n * factor))));
  return {divisions.begin(), divisions.end()};
}

/// The one nearest to the paper's figure 9a, of three layers or more if there is one: then some touch no face.
inline int slice_of(const std::vector<int>& divisions, std::size_t particles) {
  const double wanted = paper_slice * std::cbrt(static_cast<double>(particles) / paper_particles);
  const auto distance = [&](int n) { return std::abs(n - wanted) + (n < 3 ? 1000 : 0); };
  return *std::min_element(divisions.begin(), divisions.end(),
                           [&](int a, int b) { return distance(a) < distance(b); });
}

/// Those of the hexahedra that are cut into `parts`, so that specimens keep their volume as well as whole numbers allow.
inline std::set<int> coarser(const std::vector<int>& divisions, std::size_t parts) {
  std::set<int> result;
  for (const int n : divisions)
    result.insert(std::max(2, static_cast<int>(std::lround(n / std::cbrt(static_cast<double>(parts))))));
  return result;
}

/// The forces at the wanted strain, and what they act on.
struct Loaded {
  const simulation::Specimen& specimen;
  const std::vector<Vec3>& forces;
  Axis axis;
  core::ThreadPool& pool;

  template <class Estimator>
  stress::StressField stress(const Estimator& estimator) const {
    return estimator.estimate(specimen.particles, specimen.network, forces, pool);
  }
  stress::StressField stress(Cells cells, const stress::tessellation::Hexahedra& grid,
                             stress::Outside outside) const {
    return with_estimator(cells, grid, outside, [&](const auto& estimator) { return stress(estimator); });
  }
};

inline std::vector<double> component(const stress::StressField& field, Axis axis) {
  std::vector<double> values;
  values.reserve(field.size());
  for (const Mat3& stress : field.stress)
    values.push_back(stress(core::index_of(axis), core::index_of(axis)));
  return values;
}

/// Cubes of edge h, as many as fit between margins inside the box, in its middle; none where not two fit along each edge.
inline std::optional<stress::tessellation::Hexahedra> cubes_inside(const geometry::Box& box, double edge,
                                                                   double margin) {
  stress::tessellation::Hexahedra::Counts counts{};
  geometry::Box window = box;
  for (int k = 0; k < 3; ++k) {
    const int n = static_cast<int>((box.size()[k] - 2 * margin) / edge);
    if (n < 2)
      return std::nullopt;
    counts[static_cast<std::size_t>(k)] = n;
    const double middle = 0.5 * (box.lower[k] + box.upper[k]);
    window.lower[k] = middle - 0.5 * n * edge;
    window.upper[k] = middle + 0.5 * n * edge;
  }
  return stress::tessellation::Hexahedra(window, counts);
}

/// The estimators over volumes of exactly `particles` particles in the mean, all inside the body: specimens in a window, balls and
/// kernels at the centres of its cubes. A kernel's volume is (integral of phi)^2 / integral of phi^2.
inline void compare_estimators(double particles, const Loaded& body, std::vector<Average>& averages) {
  const geometry::Box& box = body.specimen.box;
  const double spacing = std::cbrt(box.volume() / static_cast<double>(body.specimen.particles.size()));
  const double volume = particles * spacing * spacing * spacing, edge = std::cbrt(volume);
  const auto lucy = stress::Lucy::of_volume(volume);
  const auto gaussian = stress::Gaussian::of_volume(volume, 4);
  // two particles below the surface, and no kernel reaches out of the body
  const double margin = std::max(2 * spacing, std::max(lucy.reach(), gaussian.reach()) - 0.5 * edge);
  const auto add = [&](const char* name, const stress::StressField& field) {
    if (const auto scatter = scatter_of(component(field, body.axis)))
      averages.push_back({name, particles, *scatter});
  };
  for (const Cells cells : all_cells) {
    const double whole = edge * std::cbrt(static_cast<double>(parts_of(cells)));
    if (const auto window = cubes_inside(box, whole, margin))
      add(name_of(cells), body.stress(cells, *window, stress::Outside::report));
  }
  if (const auto window = cubes_inside(box, edge, margin)) {
    std::vector<Vec3> centres;
    for (std::size_t cell = 0; cell < window->cell_count(); ++cell)
      centres.push_back(window->centre(cell));
    add("halo", body.stress(stress::Halo(centres, std::cbrt(0.75 * volume / std::numbers::pi), box)));
    add("lucy", body.stress(stress::CoarseGraining<stress::Lucy>(centres, lucy, box)));
    add("gaussian", body.stress(stress::CoarseGraining<stress::Gaussian>(centres, gaussian, box)));
  }
}

inline std::vector<Layer> layers_of(const stress::StressField& field,
                                    const stress::tessellation::Hexahedra& grid, Axis load, double mean) {
  const Places places(grid, load);
  const int n = grid.counts()[0];
  std::vector<Layer> layers(static_cast<std::size_t>(n));
  const std::vector<double> values = component(field, load);
  for (std::size_t h = 0; h < values.size(); ++h)
    for (int k = 0; k < 3; ++k)
      layers[static_cast<std::size_t>(places.layer(h, k))].mean[static_cast<std::size_t>(k)] +=
          values[h] / (mean * n * n);
  for (std::size_t k = 0; k < layers.size(); ++k)
    layers[k].position = (static_cast<double>(k) + 0.5) / n;
  return layers;
}

} // namespace detail

/// Packs, bonds, pulls, and cuts the body into specimens of many sizes and shapes.
inline Result run(const Params& params, const core::Monitor& monitor = {}) {
  params.validate();
  rve_tension::Result solved = rve_tension::run(params.tension, monitor);
  const geometry::Box box = solved.specimen.box;
  const double scale = params.strain / solved.materials.front().strain;
  const Axis axis = params.tension.axis;
  const std::vector<int> divisions = detail::divisions_of(params, solved.specimen.particles.size());
  const int slice = detail::slice_of(divisions, solved.specimen.particles.size());

  Result result{
      std::move(solved), params.strain, scale, 0, 0, 0, 0, 0, {}, {}, {box, {slice, slice, slice}}, {}, {}};
  const rve_tension::MaterialResult& pulled = result.material();
  result.face_stress = pulled.force_fixed / pulled.section * result.scale;
  result.interior_stress = pulled.moduli.interior_youngs_modulus * params.strain;
  result.mean_stress = pulled.moment_of_reactions / box.volume() * result.scale;
  result.gauge_length = result.tension.setup.faces.gauge_length(axis);
  result.force_length = pulled.moment_of_reactions / pulled.force_fixed;
  std::vector<Vec3> forces = pulled.bond_forces;
  for (Vec3& force : forces)
    force *= result.scale;

  core::ThreadPool pool(params.tension.threads);
  const detail::Loaded body{result.tension.specimen, forces, axis, pool};
  const auto cut = [&](Cells cells, int n) {
    const stress::tessellation::Hexahedra grid(box, {n, n, n});
    stress::StressField field = body.stress(cells, grid, stress::Outside::refuse);
    result.tessellations.push_back(judge(field, cells, grid, axis));
    if (cells == Cells::hexahedra && n == slice)
      result.slice = std::move(field);
  };
  for (const Cells cells : all_cells) {
    monitor.report({"specimens", static_cast<double>(cells) / 4, name_of(cells)});
    for (const int n : detail::coarser(divisions, parts_of(cells)))
      cut(cells, n);
  }
  result.layers = detail::layers_of(result.slice, result.slice_cells, axis, result.mean_stress);
  for (std::size_t k = 0; k < params.volumes.size(); ++k) {
    monitor.report({"estimators", static_cast<double>(k) / static_cast<double>(params.volumes.size()),
                    "volumes of " + core::to_text(params.volumes[k]) + " particles"});
    detail::compare_estimators(params.volumes[k], body, result.averages);
  }
  return result;
}

} // namespace cdem::examples::stress_homogeneous
