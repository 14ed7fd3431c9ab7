#pragma once

/// @file
/// From the motion of a bond's ends to its deformation, and from its load back to forces on the ends: in small motion,
/// and with rotations of any size. Written for one bond (Real = double) or four side by side (Real = core::Four).

#include <cdem/bond/bond_law.hpp>
#include <cdem/core/dual.hpp>
#include <cdem/core/vector_registers.hpp>

#include <cmath>
#include <cstddef>

namespace cdem::bond::detail {

/// Three components of one bond or of four.
template <class Real>
struct Components {
  Real x, y, z;
};

// By reference and always inlined: vectors of registers have no calling convention of their own.

template <class Real>
[[gnu::always_inline]] inline void cross(Components<Real>& to, const Components<Real>& a,
                                         const Components<Real>& b) {
  to = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class Real>
[[gnu::always_inline]] inline void dot(Real& to, const Components<Real>& a, const Components<Real>& b) {
  to = a.x * b.x + a.y * b.y + a.z * b.z;
}
/// to = a + factor b
template <class Real>
[[gnu::always_inline]] inline void add_scaled(Components<Real>& to, const Components<Real>& a,
                                              const Real& factor, const Components<Real>& b) {
  to = {a.x + factor * b.x, a.y + factor * b.y, a.z + factor * b.z};
}

[[gnu::always_inline]] inline void sign_of(double& to, const double& x) {
  to = x < 0 ? -1 : 1;
}
[[gnu::always_inline]] inline void sign_of(core::Four& to, const core::Four& x) {
  for (int q = 0; q < 4; ++q)
    to[q] = x[q] < 0 ? -1 : 1;
}

template <std::size_t count>
void sign_of(core::Dual<double, count>& to, const core::Dual<double, count>& x) {
  to = x.value < 0 ? -1 : 1;
}

/// n and two unit vectors across it: t, b of the local frame, right-handed.
template <class Real>
struct Frame {
  Components<Real> n, t, b;

  [[gnu::always_inline]] explicit Frame(const Components<Real>& direction) : n(direction) {
    Real sign;
    sign_of(sign, n.z);
    const Real a = -1.0 / (sign + n.z), c = n.x * n.y * a;
    t = {1.0 + sign * n.x * n.x * a, sign * c, -sign * n.x};
    b = {c, sign + n.y * n.y * a, -n.y};
  }
  /// Components along n, t, b.
  [[gnu::always_inline]] void enter(Real* local, const Components<Real>& v) const {
    dot(local[0], n, v);
    dot(local[1], t, v);
    dot(local[2], b, v);
  }
  [[gnu::always_inline]] void leave(Components<Real>& v, const Real* local) const {
    v = {local[0] * n.x + local[1] * t.x + local[2] * b.x, local[0] * n.y + local[1] * t.y + local[2] * b.y,
         local[0] * n.z + local[1] * t.z + local[2] * b.z};
  }
};

/// What a bond's load does to its ends.
template <class Real>
struct EndLoads {
  Components<Real> force; ///< on the first; the second gets the opposite
  Components<Real> moment_first, moment_second;
};

/// Two ends in small motion: displacements and rotations.
template <class Real>
struct SmallEnds {
  Components<Real> displacement_first, displacement_second, rotation_first, rotation_second;
};

/// Kinematics of small displacements and rotations, as deformation_of() and load_of().
template <class Real>
class SmallMotion {
public:
  [[gnu::always_inline]] SmallMotion(const Components<Real>& direction, const Real& length,
                                     const SmallEnds<Real>& ends)
      : frame_(direction), length_(length) {
    const auto &u = ends.displacement_first, &v = ends.displacement_second;
    const auto &r = ends.rotation_first, &s = ends.rotation_second;
    const Components<Real> arm = {0.5 * length * (r.x + s.x), 0.5 * length * (r.y + s.y),
                                  0.5 * length * (r.z + s.z)};
    Components<Real> swing;
    cross(swing, arm, direction);
    frame_.enter(deformation, {v.x - u.x - swing.x, v.y - u.y - swing.y, v.z - u.z - swing.z});
    frame_.enter(deformation + 3, {s.x - r.x, s.y - r.y, s.z - r.z});
  }

  /// @param load  normal, tangential t, b, torsion, bending t, b
  [[gnu::always_inline]] void on_ends(EndLoads<Real>& ends, const Real* load) const {
    Components<Real> moment, couple;
    frame_.leave(ends.force, load);
    frame_.leave(moment, load + 3);
    cross(couple, frame_.n, ends.force);
    const Real half = 0.5 * length_;
    add_scaled(ends.moment_first, moment, half, couple);
    ends.moment_second = {half * couple.x - moment.x, half * couple.y - moment.y, half * couple.z - moment.z};
  }

  Real deformation[6]; ///< stretch, shear t, b, twist, bend t, b

private:
  Frame<Real> frame_;
  Real length_;
};

/// Two ends with orientations (unit quaternions w + v): relative displacement and what turned each.
template <class Real>
struct FiniteEnds {
  Components<Real> relative; ///< displacement of the second less that of the first
  Components<Real> v_first, v_second;
  Real w_first, w_second;
};

/// Kinematics with rotations of any size, seen from the mean rotation R of the two ends.
///
///     slip = R' d - L n,  d: present branch         turn = 2 p(s^2) v,  v: vector part of the quaternion of R_i' R_j
///
/// |v| = s = sin(phi/2) at a relative rotation phi, and p is the series of asin(s)/s, so that turn is the rotation vector
/// from one end to the other (to 1e-5 of itself at phi = 1, 1e-7 at 0.5). Both are the same whichever end is called the
/// first, do not change in a rigid motion however far, and become those of small motion in the limit. Forces are exact
/// derivatives by slip and turn: with f, m the load, tau = R' d x f, k = v/(1 + w),
///
///     F on i = R f,     M on i = R (tau/2 + c),     M on j = R (tau/2 - c),     c = (tau x k)/2 + A m
///     A m = p m + (2 p' w - p/(1 + w)) (v.m) v,     p' = dp/d(s^2)
///
/// so that a closed motion gives back all its work, and forces and moments balance to rounding. R is that of the sum
/// Q = W + V of the two quaternions: R x = x + (W V x x + V x (V x x))/(1 + w).                  (not in the paper)
template <class Real>
class FiniteMotion {
public:
  [[gnu::always_inline]] FiniteMotion(const Components<Real>& direction, const Real& length,
                                      const FiniteEnds<Real>& ends)
      : frame_(direction) {
    const auto &a = ends.v_first, &b = ends.v_second;
    Real w, sign;
    dot(w, a, b);
    w += ends.w_first * ends.w_second;
    sign_of(sign, w); // q and -q are one rotation: the shorter way
    Components<Real> turned;
    cross(turned, a, b);
    relative_ = {sign * (ends.w_first * b.x - ends.w_second * a.x - turned.x),
                 sign * (ends.w_first * b.y - ends.w_second * a.y - turned.y),
                 sign * (ends.w_first * b.z - ends.w_second * a.z - turned.z)};
    w = sign * w;
    sum_ = {a.x + sign * b.x, a.y + sign * b.y, a.z + sign * b.z};
    sum_w_ = ends.w_first + sign * ends.w_second;
    inverse_ = 1.0 / (1.0 + w);
    Real x;
    dot(x, relative_, relative_);
    series_ = 1.0 + x * (1.0 / 6 + x * (3.0 / 40 + x * (5.0 / 112)));
    along_ = 2.0 * w * (1.0 / 6 + x * (3.0 / 20 + x * (15.0 / 112))) - series_ * inverse_;
    const Components<Real> arm = {length * direction.x, length * direction.y, length * direction.z};
    turn(branch_, {arm.x + ends.relative.x, arm.y + ends.relative.y, arm.z + ends.relative.z}, -sum_w_);
    frame_.enter(deformation, {branch_.x - arm.x, branch_.y - arm.y, branch_.z - arm.z});
    const Real twice = 2.0 * series_;
    frame_.enter(deformation + 3, {twice * relative_.x, twice * relative_.y, twice * relative_.z});
  }

  /// @param load  normal, tangential t, b, torsion, bending t, b
  [[gnu::always_inline]] void on_ends(EndLoads<Real>& ends, const Real* load) const {
    Components<Real> force, moment, tau, other;
    frame_.leave(force, load);
    frame_.leave(moment, load + 3);
    cross(tau, branch_, force);
    tau = {0.5 * tau.x, 0.5 * tau.y, 0.5 * tau.z};
    cross(other, tau, relative_);
    Real along;
    dot(along, relative_, moment);
    along = along * along_;
    other = {inverse_ * other.x + series_ * moment.x + along * relative_.x,
             inverse_ * other.y + series_ * moment.y + along * relative_.y,
             inverse_ * other.z + series_ * moment.z + along * relative_.z};
    turn(ends.force, force, sum_w_);
    turn(ends.moment_first, {tau.x + other.x, tau.y + other.y, tau.z + other.z}, sum_w_);
    turn(ends.moment_second, {tau.x - other.x, tau.y - other.y, tau.z - other.z}, sum_w_);
  }

  /// Present branch.
  void branch(Components<Real>& to) const { turn(to, branch_, sum_w_); }

  Real deformation[6]; ///< stretch, shear t, b, twist, bend t, b

private:
  /// By R with W as it is, back with -W.
  [[gnu::always_inline]] void turn(Components<Real>& to, const Components<Real>& x, const Real& w) const {
    Components<Real> once, twice;
    cross(once, sum_, x);
    cross(twice, sum_, once);
    to = {x.x + inverse_ * (w * once.x + twice.x), x.y + inverse_ * (w * once.y + twice.y),
          x.z + inverse_ * (w * once.z + twice.z)};
  }

  Frame<Real> frame_;                        ///< of the bond at rest: the mean rotation turns it
  Components<Real> sum_, relative_, branch_; ///< V, v, R' d
  Real sum_w_, inverse_, series_, along_;    ///< W, 1/(1 + w), p, factor of (v.m) v
};

/// Minus the derivative of the forces on a bond's ends by their motion: its 12x12 stiffness in (u_i, th_i, u_j, th_j),
/// rotations being turns of the present orientation.
///
/// @param respond  void(deformation, load, resistance): load [6] and its derivative 6x6 at a deformation [6]
template <class Respond>
Matrix12 finite_block(const Components<double>& direction, double length, const FiniteEnds<double>& at,
                      Respond&& respond) {
  using Real = core::Dual<double, 12>;
  const auto constants = [](const Components<double>& c) { return Components<Real>{c.x, c.y, c.z}; };
  FiniteEnds<Real> ends{constants(at.relative), constants(at.v_first), constants(at.v_second), at.w_first,
                        at.w_second};
  Real* const relative[] = {&ends.relative.x, &ends.relative.y, &ends.relative.z};
  for (std::size_t k = 0; k < 3; ++k) {
    relative[k]->derivative[k] = -1;
    relative[k]->derivative[6 + k] = 1;
  }
  const auto turn = [](Components<Real>& v, Real& w, std::size_t first) { // dq = (turn/2) q
    const double x = v.x.value, y = v.y.value, z = v.z.value, scalar = w.value;
    const double by[3][4] = {{scalar, -z, y, -x}, {z, scalar, -x, -y}, {-y, x, scalar, -z}};
    for (std::size_t k = 0; k < 3; ++k) {
      v.x.derivative[first + k] = 0.5 * by[k][0];
      v.y.derivative[first + k] = 0.5 * by[k][1];
      v.z.derivative[first + k] = 0.5 * by[k][2];
      w.derivative[first + k] = 0.5 * by[k][3];
    }
  };
  turn(ends.v_first, ends.w_first, 3);
  turn(ends.v_second, ends.w_second, 9);
  const FiniteMotion<Real> motion(constants(direction), length, ends);
  double deformation[6], load[6];
  for (std::size_t k = 0; k < 6; ++k)
    deformation[k] = motion.deformation[k].value;
  Matrix6 resistance;
  respond(deformation, load, resistance);
  Real channel[6];
  for (int row = 0; row < 6; ++row) {
    channel[row] = load[row];
    for (int column = 0; column < 6; ++column)
      for (std::size_t k = 0; k < 12; ++k)
        channel[row].derivative[k] += resistance(row, column) * motion.deformation[column].derivative[k];
  }
  EndLoads<Real> loads;
  motion.on_ends(loads, channel);
  const Components<Real> opposite = {-loads.force.x, -loads.force.y, -loads.force.z};
  Matrix12 block;
  int row = 0;
  const Components<Real>* const rows[] = {&loads.force, &loads.moment_first, &opposite, &loads.moment_second};
  for (const Components<Real>* c : rows)
    for (const Real* component : {&c->x, &c->y, &c->z}) {
      for (int k = 0; k < 12; ++k)
        block(row, k) = -component->derivative[k];
      ++row;
    }
  return block;
}

} // namespace cdem::bond::detail
