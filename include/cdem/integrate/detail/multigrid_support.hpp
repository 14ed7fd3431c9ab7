#pragma once

/// @file
/// Which parts of a body hang together, which of their rigid motions are free, and what is done about it.

#include <cdem/integrate/detail/multigrid_bonds.hpp>
#include <cdem/integrate/integrator.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace cdem::integrate::detail {

/// The connected parts of a body, and where their particles stand, in units of length.
///
/// Positions are found by following bonds, so that bonds through a periodic face need no special care; where a loop of
/// bonds does not close, the part goes round a periodic cell and the mismatch tells how.
struct Components {
  std::vector<std::uint32_t> of;    ///< [particles] number of the part, by first particle
  std::vector<Vec3> position;       ///< [particles] from the part's centre
  std::vector<std::uint32_t> size;  ///< [parts] particles
  std::vector<std::uint32_t> first; ///< [parts] first particle
  std::vector<double> radius;       ///< [parts] radius of gyration; at least 1, a bond's length
  std::vector<bool> periodic;       ///< [parts] goes round a periodic cell
  std::vector<Matrix6> held; ///< [parts] sum over what holds it of (row)'(row), rows of rigid motion about
                             ///< the centre, rotations times the radius

  std::size_t count() const { return size.size(); }
};

/// @complexity O(bonds), serial
template <LinearBonds Forces>
Components find_components(const Bonds<Forces>& bonds) {
  const std::uint32_t particles = bonds.particles();
  Components parts;
  parts.of.assign(particles, none);
  parts.position.assign(particles, Vec3::Zero());
  std::vector<std::uint32_t> queue;
  for (std::uint32_t seed = 0; seed < particles; ++seed) {
    if (parts.of[seed] != none)
      continue;
    const auto part = static_cast<std::uint32_t>(parts.count());
    Mat3 mismatch = Mat3::Zero();
    queue.assign(1, seed);
    parts.of[seed] = part;
    Vec3 centre = Vec3::Zero();
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const std::uint32_t i = queue[next];
      centre += parts.position[i];
      for (const auto end : bonds.of(i)) {
        const std::uint32_t j = end.neighbour;
        const Vec3 there = parts.position[i] + bonds.exact_branch(i, end);
        if (parts.of[j] == none) {
          parts.of[j] = part;
          parts.position[j] = there;
          queue.push_back(j);
        } else if (const Vec3 gap = there - parts.position[j]; gap.squaredNorm() > 1e-4) {
          const Mat3 turn = cross_matrix(gap);
          mismatch += turn.transpose() * turn; // a rotation opens the loop: it strains a bond
        }
      }
    }
    centre /= static_cast<double>(queue.size());
    double inertia = 0;
    for (const std::uint32_t i : queue) {
      parts.position[i] -= centre;
      inertia += parts.position[i].squaredNorm();
    }
    const double radius = std::max(1.0, std::sqrt(inertia / static_cast<double>(queue.size())));
    Matrix6 held = Matrix6::Zero();
    held.bottomRightCorner<3, 3>() = mismatch / (radius * radius);
    parts.size.push_back(static_cast<std::uint32_t>(queue.size()));
    parts.first.push_back(seed);
    parts.radius.push_back(radius);
    parts.periodic.push_back(!mismatch.isZero(0));
    parts.held.push_back(held);
  }
  return parts;
}

/// Orthonormal columns: the rigid motions (translation, rotation times the radius) that nothing holds.
inline Eigen::MatrixXd free_motions(const Matrix6& held) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> modes(held);
  const double limit = 1e-9 * std::max(modes.eigenvalues()[5], 1e-30);
  Eigen::Index count = 0;
  while (count < 6 && modes.eigenvalues()[count] <= limit)
    ++count;
  return modes.eigenvectors().leftCols(count);
}

/// "translation along y, rotation about z": the axes among the free motions, and how many oblique ones are left.
inline std::string name_motions(const Eigen::MatrixXd& motions) {
  const Eigen::Index count = motions.cols();
  std::string names;
  Eigen::Index named = 0;
  const auto add = [&](const std::string& name) {
    names += (names.empty() ? "" : ", ") + name;
    ++named;
  };
  for (int axis = 0; axis < 3; ++axis)
    if (motions.row(axis).squaredNorm() > 1 - 1e-6)
      add(std::string("translation along ") + "xyz"[axis]);
  // A rotation about an axis through some point: the free motions' rotations span the axis.
  const Eigen::SelfAdjointEigenSolver<Matrix6> span([&] {
    Matrix6 products = Matrix6::Zero();
    products.topLeftCorner<3, 3>() = motions.bottomRows(3) * motions.bottomRows(3).transpose();
    return products;
  }());
  for (int axis = 0; axis < 3; ++axis) {
    double part = 0;
    for (Eigen::Index k = 0; k < 6; ++k)
      if (span.eigenvalues()[k] > 1e-8)
        part += span.eigenvectors()(axis, k) * span.eigenvectors()(axis, k);
    if (part > 1 - 1e-6)
      add(std::string("rotation about ") + "xyz"[axis]);
  }
  if (named < count)
    add(std::to_string(count - named) + " oblique");
  return names;
}

/// What can move, and what is left alone.
struct Support {
  std::vector<HeldMask>
      held;                 ///< [particles] held degrees of freedom, all six of particles that are left alone
  std::size_t rattlers = 0; ///< particles without a bond that resists
  std::size_t floating_clusters = 0;
  std::size_t floating_particles = 0;
  std::size_t loose_clusters = 0; ///< clusters that constraints do not hold in every motion
  std::vector<std::uint32_t>
      drifting; ///< [particles] of a periodic body without a held translation, else empty
};

/// Decides what is free, from the constraints and loads on each connected part.
///
/// The largest part is the body; it must be held, or be periodic and free to translate under balanced loads.
/// @param loads  [particles], null for none
/// @throws core::InvalidInput naming the body's free rigid motions, or the cluster on which a load does work
template <LinearBonds Forces>
Support find_support(const Problem<Forces>& problem, const Bonds<Forces>& bonds,
                     const particles::SpatialField<>* loads) {
  const std::uint32_t particles = bonds.particles();
  Components parts = find_components(bonds);
  Support support;
  support.held.assign(particles, 0);
  std::vector<bool> constrained(parts.count(), false);
  for (const auto& constraint : problem.constraints.list()) {
    const std::uint32_t part = parts.of[constraint.particle];
    support.held[constraint.particle] =
        static_cast<HeldMask>(support.held[constraint.particle] | 1U << constraint.dof);
    constrained[part] = true;
    Vector6 row = Vector6::Zero();
    if (constraint.dof < 3) {
      row[constraint.dof] = 1;
      row.tail<3>() =
          parts.position[constraint.particle].cross(Vec3::Unit(constraint.dof)) / parts.radius[part];
    } else if (bonds.stiffness_of_particle(constraint.particle)(constraint.dof, constraint.dof) > 0) {
      row[constraint.dof] = 1;
    }
    parts.held[part] += row * row.transpose();
  }

  std::vector<Vector6> wrench(loads ? parts.count() : 0, Vector6::Zero());
  std::vector<double> load_size(wrench.size(), 0);
  if (loads)
    for (std::size_t i = 0; i < particles; ++i) {
      const auto& load = (*loads)[i];
      const std::uint32_t part = parts.of[i];
      const Vec3 moment = load.angular() / bonds.units().length + parts.position[i].cross(load.linear());
      wrench[part].head<3>() += load.linear();
      wrench[part].tail<3>() += moment / parts.radius[part];
      load_size[part] += load.linear().norm() + moment.norm() / parts.radius[part];
    }

  const auto body =
      static_cast<std::size_t>(std::max_element(parts.size.begin(), parts.size.end()) - parts.size.begin());
  std::vector<bool> left_alone(parts.count(), false);
  for (std::size_t part = 0; part < parts.count(); ++part) {
    const Eigen::MatrixXd motions = free_motions(parts.held[part]);
    const bool is_body = part == body && parts.size[part] > 1;
    if (motions.cols() == 0)
      continue;
    const std::string who =
        std::to_string(parts.size[part]) + " particle(s), the first is " + std::to_string(parts.first[part]);
    if (!wrench.empty() && (motions.transpose() * wrench[part]).norm() > 1e-9 * load_size[part])
      core::reject("free rigid motion of the " + std::string(is_body ? "body" : "cluster") + " (" + who +
                       ") under load",
                   name_motions(motions),
                   "constraints that hold it, or no load in this direction, are expected");
    if (is_body) {
      core::expect(parts.periodic[part], "free rigid motion of the body (" + who + ")", name_motions(motions),
                   "constraints that hold it are expected");
    } else if (!constrained[part] && (wrench.empty() || load_size[part] == 0)) {
      left_alone[part] = true;
      if (parts.size[part] == 1) {
        ++support.rattlers;
      } else {
        ++support.floating_clusters;
        support.floating_particles += parts.size[part];
      }
      continue;
    }
    if (parts.size[part] > 1)
      ++support.loose_clusters;
    left_alone[part] = parts.size[part] == 1;
    if (!is_body && !constrained[part]) // its loads are balanced: held at one particle it needs no reaction
      support.held[parts.first[part]] = parts.periodic[part] ? all_translations_held : all_held;
  }
  const Eigen::MatrixXd body_motions = free_motions(parts.held[body]);
  const bool drifts = parts.periodic[body] && body_motions.cols() > 0 && !constrained[body];
  for (std::uint32_t i = 0; i < particles; ++i) {
    if (left_alone[parts.of[i]])
      support.held[i] = all_held;
    if (drifts && parts.of[i] == body)
      support.drifting.push_back(i);
  }
  return support;
}

} // namespace cdem::integrate::detail
