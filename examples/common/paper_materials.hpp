#pragma once

// The materials of the paper with the micro parameters that it prints.

#include <cdem/bond/material.hpp>

#include <string>

namespace cdem::examples {

/// A material of the paper: its printed micro parameters and what it prints for them.
struct PaperMaterial {
  std::string name;
  bond::Material micro;
  double density;        ///< kg/m^3, of the solid; scaled to the time step (not in the paper)
  double time_step;      ///< s, printed
  double youngs_modulus; ///< Pa, printed
  double poissons_ratio; ///< printed
};

/// [L17] section 2.3; the time step is that of 700,000 particles.
inline PaperMaterial alumina() {
  return {"alumina", {.youngs_modulus = 2536e9, .radius_ratio = 0.545}, 3900, 2.15e-5, 350e9, 0.24};
}

/// [L17] section 2.3; the time step is that of 700,000 particles.
inline PaperMaterial silica() {
  return {"silica", {.youngs_modulus = 220.2e9, .radius_ratio = 0.722}, 2200, 5.21e-5, 65e9, 0.20};
}

/// [L17] section 3.2; the time step is that of the cylinder's 1,000,000 particles.
inline PaperMaterial aluminium() {
  return {"aluminium", {.youngs_modulus = 12020e9, .radius_ratio = 0.169}, 2700, 1.815e-5, 72.5e9, 0.33};
}

} // namespace cdem::examples
