#pragma once

/// @file
/// Stress averaged over time.

#include <cdem/core/error.hpp>
#include <cdem/stress/stress_estimator.hpp>

#include <cstdint>
#include <string>

namespace cdem::stress {

/// Running weighted average of stress fields on the same specimens, whatever the estimator; couple stresses with them.
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
      for_each_tensor(mean_, [&](Mat3& mean) { mean *= scale; });
    } else {
      const double part = weight / (weight_ + weight);
      const auto move = [&](Mat3& mean, const Mat3& value) { mean += part * (scale * value - mean); };
      for (std::size_t cell = 0; cell < mean_.stress.size(); ++cell)
        move(mean_.stress[cell], field.stress[cell]);
      for (std::size_t cell = 0; cell < mean_.couple_stress.size(); ++cell)
        move(mean_.couple_stress[cell], field.couple_stress[cell]);
      move(mean_.outside, field.outside);
      move(mean_.outside_couple, field.outside_couple);
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
    for_each_tensor(field, [&](Mat3& tensor) { tensor *= scale; });
    return field;
  }

private:
  template <class Function>
  static void for_each_tensor(StressField& field, Function&& function) {
    for (auto* tensors : {&field.stress, &field.couple_stress})
      for (Mat3& tensor : *tensors)
        function(tensor);
    function(field.outside);
    function(field.outside_couple);
  }

  void expect_same_specimens(const StressField& field) const {
    core::expect(field.size() > 0, "number of specimens", field.size(), "1 or more is expected");
    core::expect(field.volume.size() == field.size() && field.particles.size() == field.size(),
                 "number of specimens", field.size(),
                 "stress, volume and particles of one length are expected");
    core::expect(field.couple_stress.empty() || field.couple_stress.size() == field.size(),
                 "number of couple stresses", field.couple_stress.size(),
                 "one per specimen (" + std::to_string(field.size()) + ") is expected, or none at all");
    if (count_ > 0)
      core::expect(field.couple_stress.size() == mean_.couple_stress.size(), "number of couple stresses",
                   field.couple_stress.size(),
                   "as many as in the fields averaged before (" + std::to_string(mean_.couple_stress.size()) +
                       ") are expected");
    if (count_ > 0)
      core::expect(
          field.size() == mean_.size() && field.volume == mean_.volume, "number of specimens", field.size(),
          "the specimens of the fields averaged before (" + std::to_string(mean_.size()) + ") are expected");
  }

  static void expect_finite_stress(const StressField& field) {
    const auto expect_finite = [](const std::vector<Mat3>& tensors, const char* name) {
      for (std::size_t cell = 0; cell < tensors.size(); ++cell)
        if (!tensors[cell].allFinite())
          core::reject(name + std::to_string(cell),
                       tensors[cell].format(Eigen::IOFormat(6, Eigen::DontAlignCols, " ", "; ")),
                       "a finite tensor is expected");
    };
    expect_finite(field.stress, "stress of specimen ");
    expect_finite(field.couple_stress, "couple stress of specimen ");
  }

  StressField mean_;
  double weight_ = 0;
  std::uint64_t count_ = 0;
};

} // namespace cdem::stress
