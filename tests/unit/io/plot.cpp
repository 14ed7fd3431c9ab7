// Writes a run's output of known values into the folder given; plot.py draws it with scripts/plot.

#include <cdem/io/results.hpp>
#include <cdem/io/specimens_vtu.hpp>
#include <cdem/stress/tessellation/hexahedra.hpp>

#include <iostream>
#include <numbers>

using namespace cdem;

namespace {

void write_curve(const std::filesystem::path& path) {
  io::CsvWriter csv(path, {"step", "time_s", "youngs_modulus_pa", "youngs_modulus_average_pa",
                           "youngs_modulus_steady_pa", "poissons_ratio", "poissons_ratio_average",
                           "poissons_ratio_steady", "reaction_fixed_n", "reaction_loaded_n", "kinetic_j",
                           "elastic_j", "external_work_j", "dissipated_j"});
  for (int step = 50; step <= 20'000; step += 50) {
    const double t = step / 20e3;
    const double swing = std::exp(-3 * t) * std::cos(80 * t);
    csv.row(step, 2e-5 * step, 357e9 * (1 + 0.4 * swing), 357e9 * (1 + 0.01 * swing / t),
            step < 1000 ? std::nan("") : 357e9, 0.23 * (1 - 0.3 * swing), 0.23 * (1 - 0.01 * swing / t), 0.23,
            1, -1, 1e-7, 1e-5 * t * t, 1e-7 + 1e-5 * t * t + 1e-6 * t, 1e-6 * t);
  }
  csv.commit();
}

void write_angles(const std::filesystem::path& path) {
  io::CsvWriter csv(path, {"plane", "class", "angle_rad", "fraction"});
  for (const char* plane : {"xy", "yz", "zx"})
    for (int k = 0; k < 32; ++k)
      csv.row(plane, k, (k + 0.5) * std::numbers::pi / 16, 1 / 32.0 + (k % 2 == 0 ? 1e-3 : -1e-3));
  csv.commit();
}

void write_isotropy(const std::filesystem::path& path) {
  io::CsvWriter csv(path,
                    {"cov", "particles", "anisotropy", "anisotropy_yz", "anisotropy_zx", "anisotropy_xy",
                     "anisotropy_chance", "anisotropy_printed", "eps", "eps_cut", "eps_printed"});
  for (const double cov : {0.0, 0.3})
    for (const int particles : {10000, 100000}) {
      const double chance = 0.1 / std::sqrt(particles);
      csv.row(cov, particles, 1.1 * chance, chance, 1.1 * chance, 1.2 * chance, chance,
              particles == 10000 ? 1.3e-3 : std::nan(""), 1e-3, 2e-3, std::nan(""));
    }
  csv.commit();
}

/// Tables of examples/stress_homogeneous, those columns alone that are drawn.
void write_scatter(const std::filesystem::path& folder) {
  io::CsvWriter variability(folder / "variability.csv",
                            {"cells", "body", "particles", "mean_pa", "minimum_pa", "maximum_pa", "cov",
                             "prediction_low_pa", "prediction_high_pa"});
  io::CsvWriter estimators(folder / "estimators.csv", {"estimator", "particles", "cov", "cov_error"});
  io::CsvWriter layers(folder / "layers.csv",
                       {"position", "mean_across_x", "mean_across_y", "mean_across_z"});
  for (const double n : {30.0, 80.0, 1200.0}) {
    const double cov = 0.6 / std::sqrt(n), mean = 243e6;
    for (const char* cells : {"hexahedra", "wedges"})
      for (const char* body : {"all", "interior"})
        variability.row(cells, body, n, mean, mean * (1 - 3 * cov), mean * (1 + 3 * cov), cov,
                        mean * (1 - 2 * cov), mean * (1 + 2 * cov));
    for (const char* estimator : {"hexahedra", "halo"})
      estimators.row(estimator, n, cov, 0.02 * cov);
    layers.row(n / 1300, 0.95, 1.01, 1);
  }
  variability.commit();
  estimators.commit();
  layers.commit();
}

void write_calibration(const std::filesystem::path& folder) {
  const std::vector<std::string> columns{"cov", "radius_ratio", "relative_modulus", "poissons_ratio"};
  io::CsvWriter points(folder / "calibration_points.csv",
                       {"seed", "cov", "radius_ratio", "relative_modulus", "poissons_ratio"});
  io::CsvWriter fit(folder / "calibration_fit.csv", columns);
  for (const double cov : {0.03, 0.3})
    for (const double r : {0.1, 0.5, 0.9}) {
      fit.row(cov, r, 0.5 * r * r, 0.4 - 0.3 * r);
      for (const int seed : {1, 2})
        points.row(seed, cov, r, 0.5 * r * r + 0.01 * seed, 0.4 - 0.3 * r);
    }
  points.commit();
  fit.commit();
  io::CsvWriter printed(folder / "calibration_printed.csv",
                        {"material", "radius_ratio", "relative_modulus", "poissons_ratio"});
  printed.row("alumina", 0.545, 0.138, 0.24);
  printed.commit();
}

void write_specimens(const std::filesystem::path& path) {
  const stress::tessellation::Hexahedra tessellation(geometry::Box::cube(0.01, false), {4, 5, 6});
  stress::StressField field;
  for (std::size_t s = 0; s < tessellation.cell_count(); ++s) {
    field.stress.push_back(Vec3(2e8 + 1e6 * static_cast<double>(s), 1e6, -1e6).asDiagonal());
    field.volume.push_back(tessellation.volume(s));
    field.particles.push_back(80);
  }
  io::write_specimens_vtu(path, tessellation, io::fields_of(field));
}

} // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: plot FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  for (const auto& entry : std::filesystem::directory_iterator(folder)) // figures of an earlier run
    std::filesystem::remove(entry.path());
  write_curve(folder / "alumina_convergence.csv");
  write_curve(folder / "silica_convergence.csv");
  write_curve(folder / "silica_sudden_convergence.csv");
  write_curve(folder / "silica_ramped_convergence.csv");
  write_angles(folder / "angles.csv");
  write_calibration(folder);
  write_isotropy(folder / "isotropy.csv");
  write_scatter(folder);
  write_specimens(folder / "alumina_specimens.vtu");
  io::Results results;
  results.add({.quantity = "alumina.youngs_modulus",
               .value = 357e9,
               .unit = "Pa",
               .reference = 350e9,
               .source = "[L17]"});
  results.add({.quantity = "silica.stress.particles_at_cov[cov=0.1]",
               .value = 54,
               .reference = 80,
               .source = "[L17]"});
  results.add({.quantity = "silica.youngs_modulus[loading=sudden,average=all]",
               .value = 350e9,
               .unit = "Pa",
               .reference = 357e9,
               .source = "static solution"});
  results.write_csv(folder / "results.csv");
}
