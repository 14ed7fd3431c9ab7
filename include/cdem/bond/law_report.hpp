#pragma once

/// @file
/// What check_law() is asked and answers.

#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>

#include <cstdint>
#include <cstdio>
#include <ostream>
#include <string>
#include <vector>

namespace cdem::bond {

/// On what a law is tried.
struct LawCheckParameters {
  double strain = 1e-3;                 ///< largest displacement of an end over the bond's length
  double angle = 1e-3;                  ///< rad, largest rotation of an end
  double turn = 3;                      ///< rad, of the rigid motion
  double radius = 1e-3;                 ///< m; the particles' radii are up to 30 % smaller or larger
  std::vector<PhaseIndex> phases = {0}; ///< of which each particle has one at random
  int bonds = 8;
  int deformations = 8;        ///< of each bond
  bool loaded_at_rest = false; ///< a bond at rest may carry a load, as a heated one does
  bool throw_if_failed = false;
  std::uint64_t seed = 1;

  /// @throws core::InvalidInput naming the value
  void validate() const {
    core::expect_positive(strain, "strain of the deformations");
    core::expect_positive(angle, "angle of the deformations", "rad");
    core::expect_positive(turn, "turn of the rigid motion", "rad");
    core::expect_positive(radius, "radius of the particles", "m");
    core::expect(!phases.empty(), "number of phases", phases.size(), "at least 1 is expected");
    core::expect(bonds >= 1, "number of bonds", bonds, "at least 1 is expected");
    core::expect(deformations >= 1, "number of deformations", deformations, "at least 1 is expected");
  }
};

/// One thing that a law must fulfil, and how far it is from it.
struct LawCheck {
  std::string name;
  double tolerance = 0;
  double deviation = 0;   ///< the largest found
  std::string where = {}; ///< the bond that it was found on

  bool passed() const { return deviation <= tolerance; } // not where it is no number

  /// Keeps the larger deviation.
  void note(double found, const std::string& bond) {
    if (found <= deviation || deviation != deviation)
      return;
    deviation = found;
    where = bond;
  }
};

/// Every check with its number.
struct LawReport {
  std::vector<LawCheck> checks;

  bool passed() const {
    for (const LawCheck& check : checks)
      if (!check.passed())
        return false;
    return true;
  }

  /// The check of this name. @throws core::InvalidInput if there is none
  const LawCheck& at(const std::string& name) const {
    for (const LawCheck& check : checks)
      if (check.name == name)
        return check;
    core::reject("name of a check", name, "one of those that the report lists is expected");
  }

  /// A table, one line a check; where it failed, with the bond.
  std::string to_string() const {
    std::string text = line("check", "deviation", "tolerance", "");
    for (const LawCheck& check : checks)
      text += line(check.name, number(check.deviation), number(check.tolerance),
                   check.passed() ? "passed" : "FAILED: " + check.where);
    return text;
  }
  friend std::ostream& operator<<(std::ostream& out, const LawReport& report) {
    return out << report.to_string();
  }

  /// @throws core::InvalidInput with the table, unless everything passed
  void expect_passed() const {
    if (!passed())
      throw core::InvalidInput("the bond law does not pass check_law():\n" + to_string());
  }

private:
  static std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1e", value);
    return text;
  }
  static std::string line(const std::string& name, const std::string& deviation, const std::string& tolerance,
                          const std::string& verdict) {
    char text[256];
    std::snprintf(text, sizeof text, "%-26s %10s %10s  %s\n", name.c_str(), deviation.c_str(),
                  tolerance.c_str(), verdict.c_str());
    return text;
  }
};

} // namespace cdem::bond
