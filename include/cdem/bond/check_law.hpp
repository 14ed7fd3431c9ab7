#pragma once

/// @file
/// What to run on a bond law of one's own before trusting it.

#include <cdem/bond/bond_forces.hpp>
#include <cdem/bond/detail/law_checker.hpp>
#include <cdem/bond/law_report.hpp>

namespace cdem::bond {

/// Tries a law on random bonds of two particles, at random deformations.
///
///     finite values                     load, energy and tangent, at rest and in each channel alone too
///     action and reaction               forces on the two ends, from two evaluations: a law must not change by being asked
///     balance of moments                of the two forces and the two moments
///     frame indifference                bond and motion turned: the same energy, the load turned
///     rigid motion                      a turn of the whole bond in steps leaves the load what it was
///     no load at rest                   unless Parameters say that the law is loaded there
///     same law from either end          the two particles exchanged
///     load = dE/dx                      E stored, x deformation, the state held
///     tangent = dF/dx                   the state held
///     symmetric tangent
///     dissipation not negative          over closed paths; laws with a State
///     work = stored + lost              over the same paths; laws with a State
///
/// Deviations are relative: to the largest load (N, moments over the bond's length) or work on that bond.
/// @throws core::InvalidInput for parameters that are not accepted, what the law itself throws, and with
///         `throw_if_failed` the table of what failed
/// @complexity some 10 ms for most laws
template <BondLaw Law>
LawReport check_law(const Law& law, const LawCheckParameters& parameters = {}) {
  parameters.validate();
  LawReport report = detail::LawChecker<Law>(law, parameters).run();
  if (parameters.throw_if_failed)
    report.expect_passed();
  return report;
}

} // namespace cdem::bond
