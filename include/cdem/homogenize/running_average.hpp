#pragma once

/// @file
/// Averages over time and the paper's rule for when they have converged.

#include <cdem/core/error.hpp>

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

namespace cdem::homogenize {

/// Mean of all the values seen so far.
class RunningAverage {
public:
  void add(double value) {
    ++count_;
    mean_ += (value - mean_) / static_cast<double>(count_);
  }
  double mean() const noexcept { return mean_; }
  std::uint64_t count() const noexcept { return count_; }

  /// An average to go on with, from a checkpoint.
  static RunningAverage restore(double mean, std::uint64_t count) {
    RunningAverage average;
    average.mean_ = mean;
    average.count_ = count;
    return average;
  }

private:
  double mean_ = 0;
  std::uint64_t count_ = 0;
};

/// The paper's rule, [L17] section 5.3: converged when two successive checks, `interval` steps apart, each changed the
/// average by less than `tolerance`, relative to it.
class ConvergenceRule {
public:
  struct Parameters {
    std::uint64_t interval = 2500; ///< steps between checks
    double tolerance = 1e-3;       ///< relative change
    int successive = 2;            ///< checks in a row that must pass
  };

  /// What the rule remembers between checks; enough to go on after a checkpoint.
  struct State {
    double last = 0;      ///< average at the last check
    bool checked = false; ///< whether there was one
    int passed = 0;       ///< checks passed in a row
  };

  ConvergenceRule() : ConvergenceRule(Parameters{}) {}
  /// @throws core::InvalidInput for an interval or a number of checks below 1, or a tolerance not above 0
  explicit ConvergenceRule(Parameters parameters) : parameters_(parameters) {
    core::expect(parameters_.interval > 0, "interval of the convergence checks", parameters_.interval,
                 "at least 1 step is expected");
    core::expect_positive(parameters_.tolerance, "tolerance of the convergence checks");
    core::expect(parameters_.successive > 0, "number of successive convergence checks",
                 parameters_.successive, "at least 1 is expected");
  }

  /// Goes on from what an earlier rule remembered.
  void restore(const State& state) { state_ = state; }

  /// Looks at the average after `step` steps; true once converged. Anything but a multiple of the interval passes by.
  bool check(std::uint64_t step, double average) {
    if (!converged() && step > 0 && step % parameters_.interval == 0) {
      const bool steady =
          state_.checked && std::abs(average - state_.last) < parameters_.tolerance * std::abs(average);
      state_.passed = steady ? state_.passed + 1 : 0;
      state_.last = average;
      state_.checked = true;
    }
    return converged();
  }
  bool converged() const noexcept { return state_.passed >= parameters_.successive; }
  const State& state() const noexcept { return state_; }

private:
  Parameters parameters_;
  State state_;
};

/// First step from which all values stay within `tolerance` of the reference, relative to it, to the end; none if they do
/// not, or only during the last `lasting` steps, too short a time to tell.
///
/// @param step   [values] increasing
/// @param value  [values] one that is not a number is not within
inline std::optional<std::uint64_t> settled_from(std::span<const std::uint64_t> step,
                                                 std::span<const double> value, double reference,
                                                 double tolerance, std::uint64_t lasting = 0) {
  core::expect(step.size() == value.size(), "number of steps", step.size(),
               "the number of values, " + std::to_string(value.size()) + ", is expected");
  std::size_t first = value.size();
  while (first > 0 && std::abs(value[first - 1] - reference) <= tolerance * std::abs(reference))
    --first;
  if (first == value.size() || step[first] + lasting > step.back())
    return std::nullopt;
  return step[first];
}

/// Step at which a rule is met by the averages at these steps; none if it is not.
inline std::optional<std::uint64_t> met_at(ConvergenceRule rule, std::span<const std::uint64_t> step,
                                           std::span<const double> average) {
  core::expect(step.size() == average.size(), "number of steps", step.size(),
               "the number of averages, " + std::to_string(average.size()) + ", is expected");
  for (std::size_t k = 0; k < step.size(); ++k)
    if (rule.check(step[k], average[k]))
      return step[k];
  return std::nullopt;
}

} // namespace cdem::homogenize
