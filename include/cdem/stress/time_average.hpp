#pragma once

/// @file
/// Stress averaged over time.

#include <cdem/core/error.hpp>
#include <cdem/stress/stress_estimator.hpp>

#include <cstdint>
#include <string>

namespace cdem::stress {

/// Running weighted average of stress fields on the same specimens.
///
/// mean += (w / W) (scale sigma - mean), W the sum of the weights so far      (Welford 1962; West 1979)
///
/// The mean of n equal fields is that field to the last bit, and no sum grows with n. Under a ramp (a face
/// that moves at constant velocity) the stress grows with the strain: average sigma/strain by add(field,
/// 1/strain), and ask for the stress at a strain by result(strain).
class TimeAverage {
public:
  /// Takes one field in.
  ///
  /// @param scale   what the stresses are multiplied by, such as 1/strain; finite
  /// @param weight  above 0, such as the time the field stands for
  /// @throws core::InvalidInput for a scale or weight that is not accepted, a stress that is not finite
  ///         (nothing is added then), or other specimens than the first field's
  void add(const StressField& field, double scale = 1, double weight = 1) {
    core::expect_finite(scale, "scale of the stress");
    core::expect_positive(weight, "weight of the stress");
    expect_same_specimens(field);
    expect_finite_stress(field);
    if (count_ == 0) {
      mean_ = field;
      for (Mat3& stress : mean_.stress)
        stress *= scale;
      mean_.outside *= scale;
    } else {
      const double part = weight / (weight_ + weight);
      for (std::size_t cell = 0; cell < mean_.size(); ++cell)
        mean_.stress[cell] += part * (scale * field.stress[cell] - mean_.stress[cell]);
      mean_.outside += part * (scale * field.outside - mean_.outside);
    }
    weight_ += weight;
    ++count_;
  }

  /// Number of fields taken in.
  std::uint64_t count() const noexcept { return count_; }
  /// Sum of their weights.
  double weight() const noexcept { return weight_; }

  /// The average, its stresses multiplied by `scale` (such as the strain).
  /// @throws core::InvalidInput before the first add, or for a scale that is not finite
  StressField result(double scale = 1) const {
    core::expect(count_ > 0, "number of stress fields averaged", count_, "1 or more is expected");
    core::expect_finite(scale, "scale of the stress");
    StressField field = mean_;
    for (Mat3& stress : field.stress)
      stress *= scale;
    field.outside *= scale;
    return field;
  }

private:
  void expect_same_specimens(const StressField& field) const {
    core::expect(field.size() > 0, "number of specimens", field.size(), "1 or more is expected");
    core::expect(field.volume.size() == field.size() && field.particles.size() == field.size(),
                 "number of specimens", field.size(),
                 "stress, volume and particles of one length are expected");
    if (count_ > 0)
      core::expect(
          field.size() == mean_.size() && field.volume == mean_.volume, "number of specimens", field.size(),
          "the specimens of the fields averaged before (" + std::to_string(mean_.size()) + ") are expected");
  }

  static void expect_finite_stress(const StressField& field) {
    for (std::size_t cell = 0; cell < field.size(); ++cell)
      if (!field.stress[cell].allFinite())
        core::reject("stress of specimen " + std::to_string(cell),
                     field.stress[cell].format(Eigen::IOFormat(6, Eigen::DontAlignCols, " ", "; ")),
                     "a finite tensor is expected");
  }

  StressField mean_;
  double weight_ = 0;
  std::uint64_t count_ = 0;
};

} // namespace cdem::stress
