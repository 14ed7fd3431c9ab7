#include <cdem/stress/statistics.hpp>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include <cmath>

#include "sample.hpp"

namespace {

using namespace cdem;
using sample::contains;
using sample::not_a_number;
using sample::refusal;
using stress::Statistics;
using stress::StressField;

StressField two_specimens() {
  StressField field;
  field.stress = {Mat3::Zero(), Mat3::Zero()};
  field.stress[0](0, 1) = 2;
  field.stress[1](0, 1) = 6;
  field.volume = {3, 1};
  field.particles = {0, 0};
  return field;
}

TEST_CASE("statistics of a component, by hand") {
  const Statistics xy = stress::statistics(two_specimens(), Axis::x, Axis::y);
  CHECK(xy.mean == doctest::Approx(3)); // (3*2 + 1*6)/4
  CHECK(xy.minimum == 2);
  CHECK(xy.maximum == 6);
  CHECK(xy.standard_deviation == doctest::Approx(std::sqrt(3.0))); // (3*1 + 1*9)/4 = 3
  CHECK(xy.coefficient_of_variation() == doctest::Approx(std::sqrt(3.0) / 3));
  const Statistics yx = stress::statistics(two_specimens(), Axis::y, Axis::x);
  CHECK(yx.mean == 0);
  CHECK(yx.standard_deviation == 0);
  CHECK(stress::mean_stress(two_specimens())(0, 1) == doctest::Approx(3));
}

TEST_CASE("one pass gives the two-pass figures, also far from zero") {
  core::Random random(6);
  for (const double offset : {0.0, 1e9}) {
    StressField field;
    for (int n = 0; n < 2000; ++n) {
      field.stress.push_back(Mat3::Constant(offset + random.normal()));
      field.volume.push_back(random.uniform(0.5, 2));
    }
    long double volume = 0, sum = 0, squares = 0;
    for (std::size_t c = 0; c < field.size(); ++c) {
      volume += field.volume[c];
      sum += static_cast<long double>(field.volume[c]) * field.stress[c](2, 2);
    }
    for (std::size_t c = 0; c < field.size(); ++c)
      squares += field.volume[c] * std::pow(field.stress[c](2, 2) - sum / volume, 2.0L);
    const Statistics zz = stress::statistics(field, Axis::z, Axis::z);
    CHECK(std::abs(zz.mean - static_cast<double>(sum / volume)) < 1e-14 * (offset + 100));
    CHECK(zz.standard_deviation ==
          doctest::Approx(static_cast<double>(std::sqrt(squares / volume))).epsilon(1e-6));
  }
}

TEST_CASE("von Mises: tension, shear, pressure, and no change under rotation or an antisymmetric part") {
  Mat3 tension = Mat3::Zero();
  tension(1, 1) = -5;
  CHECK(stress::von_mises(tension) == doctest::Approx(5));
  Mat3 shear = Mat3::Zero();
  shear(0, 2) = shear(2, 0) = 2;
  CHECK(stress::von_mises(shear) == doctest::Approx(2 * std::sqrt(3.0)));
  CHECK(stress::von_mises(7 * Mat3::Identity()) < 1e-14);
  CHECK(stress::hydrostatic(7 * Mat3::Identity()) == doctest::Approx(7));
  CHECK(stress::hydrostatic(tension) == doctest::Approx(-5.0 / 3));

  const Mat3 any = (Mat3() << 3, -1, 0.5, 2, -4, 0.25, 1.5, -0.75, 7).finished();
  const Mat3 symmetric = (any + any.transpose()) / 2;
  CHECK(stress::von_mises(any) == doctest::Approx(stress::von_mises(symmetric)).epsilon(1e-14));
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  CHECK(stress::von_mises(turn * any * turn.transpose()) ==
        doctest::Approx(stress::von_mises(any)).epsilon(1e-13));
  // By the textbook's formula of the six components.
  const Mat3& s = symmetric;
  const double squares = std::pow(s(0, 0) - s(1, 1), 2) + std::pow(s(1, 1) - s(2, 2), 2) +
                         std::pow(s(2, 2) - s(0, 0), 2) +
                         6 * (s(0, 1) * s(0, 1) + s(1, 2) * s(1, 2) + s(2, 0) * s(2, 0));
  CHECK(stress::von_mises(any) == doctest::Approx(std::sqrt(squares / 2)).epsilon(1e-14));
  CHECK(stress::statistics(two_specimens(), stress::von_mises).maximum ==
        doctest::Approx(3 * std::sqrt(3.0)));
}

TEST_CASE("bad input is refused by name") {
  CHECK(contains(refusal([] { (void)stress::statistics(StressField{}, Axis::x, Axis::x); }),
                 "number of specimens = 0"));
  CHECK(contains(refusal([] { (void)stress::mean_stress(StressField{}); }), "number of specimens = 0"));
  const auto message = [](auto&& spoil) {
    StressField field = two_specimens();
    spoil(field);
    return refusal([&] { (void)stress::statistics(field, Axis::x, Axis::x); });
  };
  CHECK(contains(message([](StressField& f) { f.volume.pop_back(); }), "number of specimen volumes = 1"));
  CHECK(contains(message([](StressField& f) { f.volume[1] = 0; }), "volume of specimen 1 = 0"));
  CHECK(contains(message([](StressField& f) { f.volume[0] = not_a_number; }), "volume of specimen 0 = nan"));
  CHECK(contains(message([](StressField& f) { f.stress[1](0, 0) = not_a_number; }),
                 "quantity in specimen 1 = nan"));
}

} // namespace
