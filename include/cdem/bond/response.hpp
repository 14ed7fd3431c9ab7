#pragma once

/// @file
/// Load, energy and tangent of a bond from any kind of law: what forces are computed with, and what a law that wraps
/// another calls it by.

#include <cdem/bond/bond_law.hpp>
#include <cdem/bond/detail/bond_kinematics.hpp>
#include <cdem/core/error.hpp>

#include <cmath>
#include <cstddef>

namespace cdem::bond {

namespace detail {

/// Member `k` of a Deformation or a ChannelLoad, in the order stretch, shear t, b, twist, bend t, b.
template <class Real>
Real& component(Deformation<Real>& d, std::size_t k) {
  Real* const members[] = {&d.stretch, &d.shear.t, &d.shear.b, &d.twist, &d.bend.t, &d.bend.b};
  return *members[k];
}
template <class Real>
Real component(const Deformation<Real>& d, std::size_t k) {
  return component(const_cast<Deformation<Real>&>(d), k);
}
inline double component(const ChannelLoad<>& f, std::size_t k) {
  const double members[] = {f.normal, f.tangential.t, f.tangential.b, f.torsion, f.bending.t, f.bending.b};
  return members[k];
}

inline ChannelLoad<> channel_load(const double* f) {
  return {f[0], {f[1], f[2]}, f[3], {f[4], f[5]}};
}

inline Vector6 vector_of(const Deformation<>& d) {
  Vector6 v;
  v << d.stretch, d.shear.t, d.shear.b, d.twist, d.bend.t, d.bend.b;
  return v;
}
inline Vector6 vector_of(const ChannelLoad<>& f) {
  Vector6 v;
  v << f.normal, f.tangential.t, f.tangential.b, f.torsion, f.bending.t, f.bending.b;
  return v;
}

/// The deformation with the six variables of a derivative in place of its numbers.
template <class Real>
Deformation<core::Dual<Real, 6>> variables(const Deformation<Real>& d) {
  using Variable = core::Dual<Real, 6>;
  return {Variable::variable(d.stretch, 0),
          {Variable::variable(d.shear.t, 1), Variable::variable(d.shear.b, 2)},
          Variable::variable(d.twist, 3),
          {Variable::variable(d.bend.t, 4), Variable::variable(d.bend.b, 5)}};
}

} // namespace detail

/// n and two unit vectors across it, t and b: the columns of the local frame, right-handed.
///
/// @param n  a unit vector
inline Mat3 local_frame(const Vec3& n) {
  const detail::Frame<double> axes({n.x(), n.y(), n.z()});
  Mat3 frame;
  frame << axes.n.x, axes.t.x, axes.b.x, axes.n.y, axes.t.y, axes.b.y, axes.n.z, axes.t.z, axes.b.z;
  return frame;
}

/// The four channels of a linear law as a diagonal matrix.
inline Matrix6 matrix_of(const ChannelStiffness& k) {
  Vector6 diagonal;
  diagonal << k.normal, k.tangential, k.tangential, k.torsion, k.bending, k.bending;
  return diagonal.asDiagonal();
}

/// The 6x6 stiffness against deformation that a bond's 12x12 matrix comes to, in the local frame.
///
/// A bond in balance that resists no rigid motion is known by its stiffness against slip and turn: 12x12 = B' H B.
/// @throws core::InvalidInput if the matrix is not finite, not symmetric, or resists rigid motions, by more than 1e-9 of
///         itself
template <class Block>
Matrix6 resistance_of(const Block& block, const BondGeometry& geometry) {
  const Mat3 frame = local_frame(geometry.direction);
  const std::string name = "12x12 stiffness of the bond of particles " + std::to_string(geometry.first) +
                           " and " + std::to_string(geometry.second);
  if (!block.allFinite())
    core::reject(name, "not finite", "finite numbers are expected");
  Block scaled = block; // rotations times the length: all entries N/m
  for (const int first : {3, 9}) {
    scaled.template middleRows<3>(first) /= geometry.length;
    scaled.template middleCols<3>(first) /= geometry.length;
  }
  const double scale = scaled.cwiseAbs().maxCoeff();
  const double skew = (scaled - scaled.transpose()).cwiseAbs().maxCoeff();
  if (!(skew <= 1e-9 * scale))
    core::reject(name, core::to_text(skew / scale) + " of it is not symmetric",
                 "a symmetric matrix is expected");
  Eigen::Matrix<double, 12, 6> rigid = Eigen::Matrix<double, 12, 6>::Zero();
  Eigen::Matrix<double, 12, 6> deformed = Eigen::Matrix<double, 12, 6>::Zero();
  for (int k = 0; k < 3; ++k) {
    rigid(k, k) = rigid(6 + k, k) = 1;
    rigid(3 + k, 3 + k) = rigid(9 + k, 3 + k) = 1; // about the first particle, L = 1
    rigid.block<3, 1>(6, 3 + k) = Vec3::Unit(k).cross(geometry.direction);
    deformed.block<3, 1>(6, k) = frame.col(k);
    deformed.block<3, 1>(3, 3 + k) = -0.5 * frame.col(k);
    deformed.block<3, 1>(9, 3 + k) = 0.5 * frame.col(k);
  }
  const double resisted = (scaled * rigid).cwiseAbs().maxCoeff();
  if (!(resisted <= 1e-9 * scale))
    core::reject(name, "resists a rigid motion by " + core::to_text(resisted / scale) + " of itself",
                 "no force in rigid motion is expected");
  return deformed.transpose() * block * deformed;
}

/// One way to ask a law of any kind. Static functions over (law, prepared bond, deformation, state). What a step calls is
/// always inlined, here and in the laws that wrap, so that it is compiled for the vector registers of the loop around it.
///
/// @tparam Law  its kind is taken in the order linear, force, energy
template <class Law>
struct Response {
  using State = StateOf<Law>;

  /// What is kept of a bond at rest.
  static auto prepare(const Law& law, const BondGeometry& geometry) {
    if constexpr (GivesChannelStiffness<Law>)
      return law.stiffness(geometry);
    else if constexpr (GivesBlockStiffness<Law>)
      return resistance_of(law.stiffness(geometry), geometry);
    else if constexpr (PreparesBonds<Law>)
      return law.prepare(geometry);
    else
      return geometry;
  }
  using Prepared = decltype(prepare(std::declval<const Law&>(), std::declval<const BondGeometry&>()));

  /// Lets the law's memory follow the deformation. Nothing where it has none.
  [[gnu::always_inline]] static void update(const Law& law, const Prepared& prepared,
                                            const Deformation<>& deformation, State& state) {
    if constexpr (HasState<Law>)
      law.update(prepared, deformation, state);
  }

  /// Load at a deformation, N and N m.
  [[gnu::always_inline]] static ChannelLoad<> load(const Law& law, const Prepared& prepared,
                                                   const Deformation<>& d, const State& state) {
    if constexpr (GivesChannelStiffness<Law>) {
      return {prepared.normal * d.stretch,
              {prepared.tangential * d.shear.t, prepared.tangential * d.shear.b},
              prepared.torsion * d.twist,
              {prepared.bending * d.bend.t, prepared.bending * d.bend.b}};
    } else if constexpr (GivesBlockStiffness<Law>) {
      const Vector6 f = prepared * detail::vector_of(d);
      return detail::channel_load(f.data());
    } else if constexpr (ForceLaw<Law>) {
      if constexpr (requires { law.load(prepared, d, state); })
        return law.load(prepared, d, state);
      else
        return law.load(prepared, d);
    } else {
      return detail::channel_load(energy_of(law, prepared, detail::variables(d), state).derivative);
    }
  }

  /// Energy stored at a deformation, J.
  static double energy(const Law& law, const Prepared& prepared, const Deformation<>& d, const State& state) {
    if constexpr (LinearLaw<Law>)
      return 0.5 * detail::vector_of(d).dot(detail::vector_of(load(law, prepared, d, state)));
    else
      return energy_of(law, prepared, d, state);
  }

  /// Derivative of the load by the deformation, rows and columns stretch, shear t, b, twist, bend t, b.
  ///
  /// Exact for linear and energy laws and where the law has a `tangent` of its own; else by central differences of the
  /// load, to some 1e-9 of itself.
  static Matrix6 tangent(const Law& law, const Prepared& prepared, const Deformation<>& d, const State& state,
                         double length) {
    if constexpr (GivesChannelStiffness<Law>) {
      return matrix_of(prepared);
    } else if constexpr (GivesBlockStiffness<Law>) {
      return prepared;
    } else if constexpr (requires { law.tangent(prepared, d, state, length); }) {
      return law.tangent(prepared, d, state, length);
    } else if constexpr (!GivesLoad<Law> && GivesEnergy<Law, core::Dual<Differentiable, 6>>) {
      const auto second = energy_of(law, prepared, detail::variables(detail::variables(d)), state);
      Matrix6 hessian;
      for (int row = 0; row < 6; ++row)
        for (int column = 0; column < 6; ++column)
          hessian(row, column) = second.derivative[row].derivative[column];
      return hessian;
    } else {
      return differences(law, prepared, d, state, length);
    }
  }

private:
  template <class Real>
  [[gnu::always_inline]] static Real energy_of(const Law& law, const Prepared& prepared,
                                               const Deformation<Real>& d, const State& state) {
    if constexpr (requires { law.energy(prepared, d, state); })
      return law.energy(prepared, d, state);
    else
      return law.energy(prepared, d);
  }

  static Matrix6 differences(const Law& law, const Prepared& prepared, const Deformation<>& d,
                             const State& state, double length) {
    Matrix6 slope;
    for (std::size_t k = 0; k < 6; ++k) {
      const double step = 1e-6 * (k < 3 ? length : 1); // of a strain, of an angle
      Deformation<> ahead = d, behind = d;
      detail::component(ahead, k) += step;
      detail::component(behind, k) -= step;
      slope.col(static_cast<Eigen::Index>(k)) = (detail::vector_of(load(law, prepared, ahead, state)) -
                                                 detail::vector_of(load(law, prepared, behind, state))) /
                                                (2 * step);
    }
    return slope;
  }
};

} // namespace cdem::bond
