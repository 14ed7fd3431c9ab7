#include <cdem/homogenize/stiffness.hpp>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include <limits>

using namespace cdem;
using homogenize::Matrix6;
using homogenize::Stiffness;

namespace {

Stiffness cubic(double c11, double c12, double c44) {
  Matrix6 c = Matrix6::Zero();
  c.topLeftCorner<3, 3>().setConstant(c12);
  c.diagonal().head<3>().setConstant(c11);
  c.diagonal().tail<3>().setConstant(c44);
  return Stiffness(c);
}

/// Any turn.
Mat3 turn() {
  return Eigen::AngleAxisd(0.7, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
}

} // namespace

TEST_CASE("an isotropic stiffness gives its moduli back and has no anisotropy") {
  const homogenize::IsotropicModuli alumina{350e9 / (3 * (1 - 2 * 0.24)), 350e9 / (2 * 1.24)};
  const Stiffness c = Stiffness::isotropic(alumina);
  CHECK(c.youngs_modulus() == doctest::Approx(350e9).epsilon(1e-13));
  CHECK(c.poissons_ratio() == doctest::Approx(0.24).epsilon(1e-13));
  CHECK(c.reuss_average().bulk == doctest::Approx(alumina.bulk).epsilon(1e-12));
  CHECK(c.reuss_average().shear == doctest::Approx(alumina.shear).epsilon(1e-12));
  CHECK(c.distance_from_isotropy() < 1e-14);
  CHECK(std::abs(c.universal_anisotropy()) < 1e-12);
  CHECK((c.rotated(turn()).voigt() - c.voigt()).norm() < 1e-13 * c.voigt().norm());
  CHECK(c.youngs_modulus(Vec3(1, 2, 3).normalized()) == doctest::Approx(350e9).epsilon(1e-12));
}

TEST_CASE("iron: a cubic crystal's published anisotropy, its extremes along [100] and [111]") {
  // C11, C12, C44 = 230, 135, 117 GPa: Zener's ratio 2.463, A^U = 6/5 (sqrt A - 1/sqrt A)^2 = 1.043
  // (Ranganathan & Ostoja-Starzewski 2008, equation 9 and table I: bcc iron)
  const Stiffness iron = cubic(230e9, 135e9, 117e9);
  const double zener = 2 * 117.0 / (230 - 135);
  CHECK(iron.universal_anisotropy() ==
        doctest::Approx(1.2 * std::pow(std::sqrt(zener) - 1 / std::sqrt(zener), 2)).epsilon(1e-12));
  CHECK(iron.isotropic_part().bulk == doctest::Approx((230e9 + 2 * 135e9) / 3).epsilon(1e-13));
  CHECK(iron.isotropic_part().shear == doctest::Approx((230e9 - 135e9 + 3 * 117e9) / 5).epsilon(1e-13));
  CHECK(iron.reuss_average().shear == doctest::Approx(5 / (4 / (230e9 - 135e9) + 3 / 117e9))
                                          .epsilon(1e-12)); // 5 (C11-C12) C44/(4 C44+3 (C11-C12))

  const double s11 = (230.0 + 135) / ((230.0 - 135) * (230 + 2 * 135)),
               s12 = -135.0 / ((230.0 - 135) * (230 + 2 * 135)), s44 = 1.0 / 117;
  const double along_cube = 1e9 / s11, along_diagonal = 1e9 / (s11 - 2.0 / 3 * (s11 - s12 - 0.5 * s44));
  for (const Mat3& r : {Mat3(Mat3::Identity()), turn()}) {
    const auto extremes = iron.rotated(r).youngs_modulus_extremes();
    CHECK(extremes.smallest == doctest::Approx(along_cube).epsilon(1e-10));
    CHECK(extremes.largest == doctest::Approx(along_diagonal).epsilon(1e-10));
    CHECK((r.transpose() * extremes.softest).cwiseAbs().maxCoeff() == doctest::Approx(1).epsilon(1e-6));
    CHECK((r.transpose() * extremes.stiffest).cwiseAbs().minCoeff() ==
          doctest::Approx(1 / std::sqrt(3.0)).epsilon(1e-3));
  }
}

TEST_CASE("turning a body leaves its invariants, and the isotropic part is the closest") {
  const Stiffness iron = cubic(230e9, 135e9, 117e9), turned = iron.rotated(turn());
  CHECK((turned.voigt() - iron.voigt()).norm() > 0.05 * iron.voigt().norm());
  CHECK(turned.kelvin().norm() == doctest::Approx(iron.kelvin().norm()).epsilon(1e-13));
  CHECK(turned.distance_from_isotropy() == doctest::Approx(iron.distance_from_isotropy()).epsilon(1e-12));
  CHECK(turned.universal_anisotropy() == doctest::Approx(iron.universal_anisotropy()).epsilon(1e-11));
  CHECK((turned.rotated(turn().transpose()).voigt() - iron.voigt()).norm() < 1e-13 * iron.voigt().norm());

  const auto best = iron.isotropic_part();
  const auto distance = [&](double bulk, double shear) {
    return (iron.kelvin() - Stiffness::isotropic({bulk, shear}).kelvin()).norm();
  };
  for (const double part : {0.99, 1.01}) {
    CHECK(distance(part * best.bulk, best.shear) > distance(best.bulk, best.shear));
    CHECK(distance(best.bulk, part * best.shear) > distance(best.bulk, best.shear));
  }
}

TEST_CASE("what is not a stiffness is refused by name") {
  Matrix6 c = cubic(3, 1, 1).voigt();
  c(3, 1) = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(Stiffness{c},
                       "stiffness in row 4, column 2 = nan is not accepted: a finite number is expected",
                       core::InvalidInput);
  CHECK_THROWS_WITH_AS(static_cast<void>(cubic(3, 1, 0).compliance()),
                       "rank of the stiffness = 3 is not accepted: 6 is expected", core::InvalidInput);
}
