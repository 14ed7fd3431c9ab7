#include <cdem/stress/time_average.hpp>

#include <doctest/doctest.h>

#include <vector>

#include "sample.hpp"

namespace {

using namespace cdem;
using sample::contains;
using sample::not_a_number;
using sample::refusal;
using sample::same_bytes;
using stress::StressField;
using stress::TimeAverage;

StressField random_field(core::Random& random, std::size_t cells) {
  StressField field;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    Mat3 stress;
    for (int column = 0; column < 3; ++column)
      stress.col(column) = sample::random_vector(random, -1e8, 1e8);
    field.stress.push_back(stress);
    field.volume.push_back(1e-9 * static_cast<double>(cell + 1));
    field.particles.push_back(80);
  }
  field.outside = 1e-3 * field.stress[0];
  return field;
}

TEST_CASE("the average of equal fields is that field to the last bit") {
  core::Random random(1);
  const StressField field = random_field(random, 7);
  TimeAverage average;
  for (int n = 0; n < 1000; ++n)
    average.add(field);
  CHECK(average.count() == 1000);
  CHECK(average.weight() == 1000);
  CHECK(same_bytes(average.result(), field));
}

TEST_CASE("the weighted average is sum w s / sum w") {
  core::Random random(2);
  TimeAverage average;
  std::vector<Mat3> sum(4, Mat3::Zero());
  Mat3 outside = Mat3::Zero();
  double weights = 0;
  for (int n = 0; n < 500; ++n) {
    const StressField field = random_field(random, 4);
    const double weight = random.uniform(0.1, 3), scale = random.uniform(-2, 2);
    average.add(field, scale, weight);
    for (std::size_t cell = 0; cell < 4; ++cell)
      sum[cell] += weight * scale * field.stress[cell];
    outside += weight * scale * field.outside;
    weights += weight;
  }
  const StressField result = average.result(5);
  for (std::size_t cell = 0; cell < 4; ++cell)
    CHECK((result.stress[cell] - 5 * sum[cell] / weights).norm() < 1e-13 * 5e8);
  CHECK((result.outside - 5 * outside / weights).norm() < 1e-13 * 5e5);
  CHECK(average.weight() == doctest::Approx(weights).epsilon(1e-13));
}

TEST_CASE("under a ramp, the average of stress over strain gives the stress at any strain") {
  // sigma(t) = C eps(t), eps growing with t: the plain average lags behind, the scaled one does not.
  core::Random random(3);
  const StressField per_strain = random_field(random, 3);
  TimeAverage scaled;
  double strain = 0;
  for (int n = 1; n <= 200; ++n) {
    strain = 1e-6 * n;
    StressField field = per_strain;
    for (Mat3& stress : field.stress)
      stress *= strain;
    scaled.add(field, 1 / strain);
  }
  const StressField result = scaled.result(strain);
  for (std::size_t cell = 0; cell < 3; ++cell)
    CHECK((result.stress[cell] - strain * per_strain.stress[cell]).norm() <
          1e-14 * strain * per_strain.stress[cell].norm());
}

TEST_CASE("volumes and numbers of particles pass unscaled") {
  core::Random random(4);
  const StressField field = random_field(random, 2);
  TimeAverage average;
  average.add(field, 3);
  CHECK(average.result(2).volume == field.volume);
  CHECK(average.result(2).particles == field.particles);
}

TEST_CASE("bad input is refused by name and leaves the average as it was") {
  core::Random random(5);
  const StressField field = random_field(random, 3);
  TimeAverage average;
  CHECK(contains(refusal([&] { (void)average.result(); }), "number of stress fields averaged = 0"));
  CHECK(contains(refusal([&] { average.add(StressField{}); }), "number of specimens = 0"));
  average.add(field);
  CHECK(contains(refusal([&] { average.add(field, 1 / 0.0); }), "scale of the stress = inf"));
  CHECK(contains(refusal([&] { average.add(field, 1, 0); }), "weight of the stress = 0"));
  CHECK(contains(refusal([&] { average.add(field, 1, -1); }), "weight of the stress = -1"));
  CHECK(contains(refusal([&] { average.add(field, 1, not_a_number); }), "weight of the stress = nan"));
  CHECK(contains(refusal([&] { (void)average.result(not_a_number); }), "scale of the stress = nan"));
  CHECK(contains(refusal([&] { average.add(random_field(random, 4)); }), "number of specimens = 4"));
  StressField other = field;
  other.volume[1] *= 2;
  CHECK(contains(refusal([&] { average.add(other); }), "the specimens of the fields averaged before"));
  other = field;
  other.volume.pop_back();
  CHECK(contains(refusal([&] { average.add(other); }), "of one length"));
  other = field;
  other.stress[2](0, 1) = not_a_number;
  CHECK(contains(refusal([&] { average.add(other); }), "stress of specimen 2"));
  CHECK(average.count() == 1);
  CHECK(same_bytes(average.result(), field));
}

} // namespace
