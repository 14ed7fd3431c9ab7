#pragma once

/// @file
/// A body's 6x6 stiffness: its isotropic part, how far it is from it, Young's modulus in every direction.

#include <cdem/core/error.hpp>
#include <cdem/core/types.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace cdem::homogenize {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// The two tensor indices of each Voigt component: xx, yy, zz, yz, xz, xy.
inline constexpr std::array<std::pair<int, int>, 6> voigt_pairs{
    {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}};

/// Strain tensor of a Voigt vector with engineering shear (gamma = 2 epsilon) in the places yz, xz, xy.
inline Mat3 strain_of_voigt(const Vector6& strain) {
  Mat3 tensor;
  for (int k = 0; k < 6; ++k) {
    const auto [i, j] = voigt_pairs[static_cast<std::size_t>(k)];
    tensor(i, j) = tensor(j, i) = (k < 3 ? 1 : 0.5) * strain[k];
  }
  return tensor;
}

/// Voigt vector of a stress tensor, its symmetric part.
inline Vector6 voigt_of_stress(const Mat3& stress) {
  Vector6 vector;
  for (int k = 0; k < 6; ++k) {
    const auto [i, j] = voigt_pairs[static_cast<std::size_t>(k)];
    vector[k] = 0.5 * (stress(i, j) + stress(j, i));
  }
  return vector;
}

/// Moduli of an isotropic body, Pa.
struct IsotropicModuli {
  double bulk = 0;  ///< K
  double shear = 0; ///< mu, G

  /// E = 9 K mu / (3 K + mu), Pa.
  double youngs_modulus() const { return 9 * bulk * shear / (3 * bulk + shear); }
  /// nu = (3 K - 2 mu) / (2 (3 K + mu)).
  double poissons_ratio() const { return (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)); }
};

/// Smallest and largest Young's modulus over all directions, and where, Pa.
struct YoungsModulusExtremes {
  double smallest = 0, largest = 0;
  Vec3 softest = Vec3::UnitX(), stiffest = Vec3::UnitX(); ///< unit vectors, of either sign
};

/// Stiffness C of a linear elastic body in Voigt's notation with engineering shear: sigma = C epsilon with
/// sigma = (xx, yy, zz, yz, xz, xy) and epsilon = (xx, yy, zz, 2 yz, 2 xz, 2 xy).
class Stiffness {
public:
  Stiffness() = default;
  /// @param voigt  [6 x 6] Pa, in the order above; it may lack symmetry by what a solver left, see asymmetry()
  /// @throws core::InvalidInput for an entry that is not finite
  explicit Stiffness(const Matrix6& voigt)
      : voigt_(0.5 * (voigt + voigt.transpose())),
        asymmetry_(0.5 * (voigt - voigt.transpose()).norm() / voigt.norm()) {
    for (int row = 0; row < 6; ++row)
      for (int column = 0; column < 6; ++column)
        core::expect_finite(voigt(row, column), "stiffness in row " + std::to_string(row + 1) + ", column " +
                                                    std::to_string(column + 1));
  }

  /// Of an isotropic body.
  static Stiffness isotropic(const IsotropicModuli& moduli) {
    Matrix6 c = Matrix6::Zero();
    c.topLeftCorner<3, 3>().setConstant(moduli.bulk - 2.0 / 3.0 * moduli.shear);
    c.diagonal().head<3>().array() += 2 * moduli.shear;
    c.diagonal().tail<3>().setConstant(moduli.shear);
    return Stiffness(c);
  }

  /// C, symmetric, Pa.
  const Matrix6& voigt() const noexcept { return voigt_; }
  /// |antisymmetric part| over |C| of what was given: how well it was solved for.
  double asymmetry() const noexcept { return asymmetry_; }

  /// Kelvin's (Mandel's) form, Pa: shear rows and columns times sqrt 2, so that it is a tensor of second order in six
  /// dimensions, with eigenvalues and a norm that do not depend on the axes.
  Matrix6 kelvin() const {
    Matrix6 c = voigt_;
    c.bottomRows<3>() *= std::numbers::sqrt2;
    c.rightCols<3>() *= std::numbers::sqrt2;
    return c;
  }

  /// The closest isotropic stiffness in the norm of Kelvin's form, 3K J + 2mu K; K and mu are Voigt's averages over
  /// all orientations:
  ///
  ///     9 K = C_iijj = sum of the upper left block,   10 mu = C_ijij - C_iijj / 3 = tr(Kelvin's form) - 3K
  IsotropicModuli isotropic_part() const {
    const double bulk = voigt_.topLeftCorner<3, 3>().sum() / 9;
    return {bulk, (kelvin().trace() - 3 * bulk) / 10};
  }
  double youngs_modulus() const { return isotropic_part().youngs_modulus(); }
  double poissons_ratio() const { return isotropic_part().poissons_ratio(); }

  /// Reuss' averages over all orientations, Pa: of the compliance, as isotropic_part() of the stiffness.
  IsotropicModuli reuss_average() const {
    const Matrix6 s = compliance();
    const double dilatation = s.topLeftCorner<3, 3>().sum(); // 1/K
    // Kelvin's trace of the compliance is the sum of the diagonal with shear over 2: s_kk(4..6) holds 1/mu, not 1/2mu
    const double trace = s.diagonal().head<3>().sum() + 0.5 * s.diagonal().tail<3>().sum();
    return {1 / dilatation, 5 / (2 * (trace - dilatation / 3))};
  }

  /// |C - its isotropic part| / |C| in the norm of Kelvin's form: 0 for an isotropic body.
  double distance_from_isotropy() const {
    const Matrix6 c = kelvin();
    return (c - isotropic(isotropic_part()).kelvin()).norm() / c.norm();
  }

  /// A^U = 5 mu_V / mu_R + K_V / K_R - 6, 0 for an isotropic body.   Ranganathan & Ostoja-Starzewski, PRL 101 (2008)
  double universal_anisotropy() const {
    const IsotropicModuli voigt = isotropic_part(), reuss = reuss_average();
    return 5 * voigt.shear / reuss.shear + voigt.bulk / reuss.bulk - 6;
  }

  /// S = C^-1 in Voigt's notation with engineering shear, 1/Pa.
  /// @throws core::InvalidInput if C is singular
  Matrix6 compliance() const {
    const Eigen::FullPivLU<Matrix6> factor(voigt_);
    core::expect(factor.isInvertible(), "rank of the stiffness", factor.rank(), "6 is expected");
    return factor.inverse();
  }

  /// Young's modulus under tension along n, Pa: 1/E = n n : S : n n.
  double youngs_modulus(const Vec3& n) const { return 1 / (compliance() * outer(n)).dot(outer(n)); }

  /// Extremes of Young's modulus over all directions, by a grid and Newton-like refinement of it.
  /// @complexity O(10^4) evaluations
  YoungsModulusExtremes youngs_modulus_extremes() const {
    const Matrix6 s = compliance();
    const auto modulus = [&](const Vec3& n) { return 1 / (s * outer(n)).dot(outer(n)); };
    YoungsModulusExtremes found;
    found.smallest = found.largest = modulus(Vec3::UnitX());
    const auto look = [&](const Vec3& n) {
      const double e = modulus(n);
      if (e < found.smallest)
        found.smallest = e, found.softest = n;
      if (e > found.largest)
        found.largest = e, found.stiffest = n;
    };
    constexpr int rings = 45;
    for (int ring = 0; ring <= rings; ++ring) // the upper half sphere in steps of 2 degrees
      for (int step = 0; step < 4 * rings; ++step)
        look(direction(0.5 * std::numbers::pi * ring / rings, 0.5 * std::numbers::pi * step / rings));
    for (const bool largest : {false, true}) // then around the best in ever smaller circles
      for (double size = 0.04; size > 1e-9; size *= 0.5)
        for (int step = 0; step < 8; ++step) {
          const Vec3 n = largest ? found.stiffest : found.softest;
          const Vec3 across = n.unitOrthogonal(), third = n.cross(across);
          const double angle = 0.25 * std::numbers::pi * step;
          look((n + size * (std::cos(angle) * across + std::sin(angle) * third)).normalized());
        }
    return found;
  }

  /// The same body turned by the rotation r: C'_ijkl = r_ia r_jb r_kc r_ld C_abcd.
  Stiffness rotated(const Mat3& r) const {
    Matrix6 turn; // of Voigt stress: sigma' = turn sigma
    for (int k = 0; k < 6; ++k) {
      const auto [i, j] = voigt_pairs[static_cast<std::size_t>(k)];
      for (int l = 0; l < 6; ++l) {
        const auto [a, b] = voigt_pairs[static_cast<std::size_t>(l)];
        turn(k, l) = l < 3 ? r(i, a) * r(j, a) : r(i, a) * r(j, b) + r(i, b) * r(j, a);
      }
    }
    return Stiffness(turn * voigt_ * turn.transpose());
  }

private:
  /// n (x) n as a Voigt stress.
  static Vector6 outer(const Vec3& n) {
    Vector6 v;
    v << n.x() * n.x(), n.y() * n.y(), n.z() * n.z(), n.y() * n.z(), n.x() * n.z(), n.x() * n.y();
    return v;
  }
  static Vec3 direction(double from_pole, double around) {
    return {std::sin(from_pole) * std::cos(around), std::sin(from_pole) * std::sin(around),
            std::cos(from_pole)};
  }

  Matrix6 voigt_ = Matrix6::Zero();
  double asymmetry_ = 0;
};

} // namespace cdem::homogenize
