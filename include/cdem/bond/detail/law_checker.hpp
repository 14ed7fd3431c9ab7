#pragma once

/// @file
/// How check_law() tries a law.

#include <cdem/bond/bond_forces.hpp>
#include <cdem/bond/law_report.hpp>
#include <cdem/bond/response.hpp>
#include <cdem/core/random.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace cdem::bond::detail {

/// Two particles and the bond between them.
struct BondedPair {
  particles::ParticleSet particles;
  network::BondNetwork network;

  BondedPair(const Vec3 (&position)[2], const double (&radius)[2], const PhaseIndex (&phase)[2]) {
    particles.resize(2);
    for (std::size_t end = 0; end < 2; ++end) {
      particles.position[end] = position[end];
      particles.radius[end] = radius[end];
      particles.phase[end] = phase[end];
    }
    network.particle_count = 2;
    network.first.push_back(0);
    network.second.push_back(1);
    network.branch.push_back(position[1] - position[0]);
  }

  double length() const { return network.branch[0].norm(); }
  BondGeometry geometry() const { return geometry_of(0, particles, network); }

  /// The same pair, turned about the origin.
  BondedPair turned(const Mat3& turn) const {
    BondedPair pair = *this;
    for (Vec3& position : pair.particles.position)
      position = turn * position;
    pair.network.branch[0] = turn * network.branch[0];
    return pair;
  }
  /// The same pair, its second particle called the first.
  BondedPair exchanged() const {
    BondedPair pair = *this;
    std::swap(pair.particles.position[0], pair.particles.position[1]);
    std::swap(pair.particles.radius[0], pair.particles.radius[1]);
    std::swap(pair.particles.phase[0], pair.particles.phase[1]);
    pair.network.branch[0] = -network.branch[0];
    return pair;
  }
  std::string text() const {
    const auto one = [&](std::size_t end) {
      return "radius " + core::to_text(particles.radius[end]) + " m, phase " +
             core::to_text(particles.phase[end]);
    };
    return "bond of length " + core::to_text(length()) + " m between particles of " + one(0) + " and " +
           one(1);
  }
};

/// All checks of one law.
template <BondLaw Law>
class LawChecker {
  using Field = particles::SpatialField<>;
  using Forces = BondForces<Law>;
  using Ask = Response<Law>;
  using State = bond::StateOf<Law>; // not the helper of the same name

public:
  LawChecker(const Law& law, const LawCheckParameters& parameters)
      : law_(law), parameters_(parameters), random_(parameters.seed) {}

  LawReport run() {
    for (int b = 0; b < parameters_.bonds; ++b) {
      const BondedPair pair = random_pair();
      name_ = pair.text();
      length_ = pair.length();
      Forces forces(law_, pair.particles, pair.network); // validates
      check_response(pair);
      check_balance(pair, forces);
      check_frame(pair, forces);
      check_order(pair, forces);
      check_rigid_motion(pair, forces);
      if constexpr (HasState<Law>)
        check_paths(pair);
    }
    LawReport report{{finite_, action_, moments_, frame_, rigid_}};
    if (!parameters_.loaded_at_rest)
      report.checks.push_back(rest_);
    report.checks.insert(report.checks.end(), {order_, gradient_, tangent_, symmetry_});
    if constexpr (HasState<Law>)
      report.checks.insert(report.checks.end(), {dissipation_, ledger_});
    return report;
  }

private:
  // --- what is tried -------------------------------------------------------------------------------------------------

  BondedPair random_pair() {
    const auto radius = [&] { return parameters_.radius * random_.uniform(0.7, 1.3); };
    const auto phase = [&] {
      const auto count = static_cast<double>(parameters_.phases.size());
      return parameters_.phases[std::min(static_cast<std::size_t>(count * random_.uniform()),
                                         parameters_.phases.size() - 1)];
    };
    const double first = radius(), second = radius();
    const PhaseIndex phase_first = phase(), phase_second = phase();
    const Vec3 at = random_vector(parameters_.radius);
    const Vec3 branch = (first + second) * random_.uniform(0.95, 1.1) * random_direction();
    return BondedPair({at, at + branch}, {first, second}, {phase_first, phase_second});
  }
  Vec3 random_vector(double size) {
    const double x = random_.uniform(-size, size), y = random_.uniform(-size, size);
    return {x, y, random_.uniform(-size, size)};
  }
  Vec3 random_direction() {
    for (;;)
      if (const Vec3 v = random_vector(1); v.norm() > 0.1 && v.norm() < 1)
        return v.normalized();
  }
  Mat3 random_turn(double angle) { return Eigen::AngleAxisd(angle, random_direction()).toRotationMatrix(); }
  Field random_motion() {
    Field motion(2);
    const double size = random_.uniform(0.1, 1);
    for (auto& end : motion) {
      end.linear() = random_vector(size * parameters_.strain * length_);
      end.angular() = random_vector(size * parameters_.angle);
    }
    return motion;
  }
  Deformation<> random_deformation() {
    const double size = random_.uniform(0.1, 1);
    const Vec3 slip = random_vector(size * parameters_.strain * length_);
    const Vec3 turn = random_vector(size * parameters_.angle);
    return {slip.x(), {slip.y(), slip.z()}, turn.x(), {turn.y(), turn.z()}};
  }

  // --- what the law answers ------------------------------------------------------------------------------------------

  /// Force, moment over the length, of the first end, then of the second, N.
  using Loads = Eigen::Matrix<double, 12, 1>;
  Loads loads(const Forces& forces, const Field& motion) {
    Field force(2);
    forces.evaluate(motion, force, pool_);
    Loads all;
    all << force[0].linear(), force[0].angular() / length_, force[1].linear(), force[1].angular() / length_;
    return all;
  }
  static Loads turned(const Loads& loads, const Mat3& turn) {
    Loads all;
    for (int k = 0; k < 12; k += 3)
      all.segment<3>(k) = turn * loads.segment<3>(k);
    return all;
  }
  /// Derivative of the load by deformation, or a load, in N where moments count by the length.
  Vector6 in_newton(const ChannelLoad<>& load) const {
    Vector6 f = vector_of(load);
    f.tail<3>() /= length_;
    return f;
  }
  Matrix6 in_newton(Matrix6 slope) const { // by the length of a displacement, by a rotation of 1
    slope.bottomRows<3>() /= length_;
    slope.leftCols<3>() *= length_;
    return slope;
  }
  void note(LawCheck& check, double difference, double scale) const {
    check.note(difference == 0 ? 0 : difference / scale, name_);
  }

  // --- load, energy and tangent at a deformation, the state held ------------------------------------------------------

  void check_response(const BondedPair& pair) {
    const typename Ask::Prepared prepared = Ask::prepare(law_, pair.geometry());
    force_ = stiffness_ = 0;
    expect_finite(prepared, {}, {});
    for (std::size_t k = 0; k < 6; ++k) {
      Deformation<> alone;
      component(alone, k) = k < 3 ? parameters_.strain * length_ : parameters_.angle;
      State state{};
      Ask::update(law_, prepared, alone, state);
      expect_finite(prepared, alone, state);
    }
    State state{};
    for (int n = 0; n < parameters_.deformations; ++n) {
      const Deformation<> d = random_deformation();
      Ask::update(law_, prepared, d, state);
      expect_finite(prepared, d, state);
      check_derivatives(prepared, d, state);
    }
  }

  void expect_finite(const typename Ask::Prepared& prepared, const Deformation<>& d, const State& state) {
    const ChannelLoad<> load = Ask::load(law_, prepared, d, state);
    const Matrix6 tangent = Ask::tangent(law_, prepared, d, state, length_);
    const double energy = Ask::energy(law_, prepared, d, state);
    finite_.note(vector_of(load).allFinite() && tangent.allFinite() && std::isfinite(energy) ? 0 : 1, name_);
    force_ = std::max(force_, in_newton(load).norm());
  }

  void check_derivatives(const typename Ask::Prepared& prepared, const Deformation<>& d, const State& state) {
    const Matrix6 tangent = Ask::tangent(law_, prepared, d, state, length_);
    const Vector6 load = vector_of(Ask::load(law_, prepared, d, state));
    Vector6 slope;
    Matrix6 load_slope;
    for (std::size_t k = 0; k < 6; ++k) {
      const double step = 1e-4 * (k < 3 ? parameters_.strain * length_ : parameters_.angle);
      Deformation<> ahead = d, behind = d;
      component(ahead, k) += step;
      component(behind, k) -= step;
      const auto column = static_cast<Eigen::Index>(k);
      slope[column] =
          (Ask::energy(law_, prepared, ahead, state) - Ask::energy(law_, prepared, behind, state)) /
          (2 * step);
      load_slope.col(column) = (vector_of(Ask::load(law_, prepared, ahead, state)) -
                                vector_of(Ask::load(law_, prepared, behind, state))) /
                               (2 * step);
    }
    note(gradient_, in_newton(channel_load(Vector6(load - slope).data())).norm(), force_);
    stiffness_ = std::max(stiffness_, in_newton(tangent).norm());
    note(tangent_, in_newton(tangent - load_slope).norm(), stiffness_);
    note(symmetry_, in_newton(tangent - tangent.transpose()).norm(), stiffness_);
  }

  // --- the two ends --------------------------------------------------------------------------------------------------

  void check_balance(const BondedPair& pair, const Forces& forces) {
    for (int n = 0; n < parameters_.deformations; ++n) {
      const Field motion = random_motion();
      const Loads one = loads(forces, motion), other = loads(forces, motion);
      const Vec3 force = one.head<3>() + other.segment<3>(6);
      Vec3 branch = pair.network.branch[0];
      if constexpr (TurnsWithItsEnds<Law>)
        branch += motion[1].linear() - motion[0].linear();
      const Vec3 moment =
          one.segment<3>(3) + other.segment<3>(9) + branch.cross(other.segment<3>(6)) / length_;
      note(action_, force.norm(), force_);
      note(moments_, moment.norm(), force_);
    }
  }

  void check_frame(const BondedPair& pair, const Forces& forces) {
    for (int n = 0; n < parameters_.deformations; ++n) {
      const Mat3 turn = random_turn(random_.uniform(0, 3));
      const BondedPair other = pair.turned(turn);
      const Forces elsewhere(law_, other.particles, other.network);
      const Field motion = random_motion();
      Field same(2);
      for (std::size_t end = 0; end < 2; ++end) {
        same[end].linear() = turn * motion[end].linear();
        same[end].angular() = turn * motion[end].angular();
      }
      compare(forces, motion, elsewhere, same, turn);
      if constexpr (TurnsWithItsEnds<Law>) { // the deformed bond turned, the bond at rest left
        for (std::size_t end = 0; end < 2; ++end) {
          const Vec3& x = pair.particles.position[end];
          same[end].linear() = turn * (x + motion[end].linear()) - x;
          same[end].angular() = rotation_vector(turn * rotation(motion[end].angular()));
        }
        compare(forces, motion, forces, same, turn);
      }
    }
  }
  static Mat3 rotation(const Vec3& v) {
    const double angle = v.norm();
    return angle > 0 ? Eigen::AngleAxisd(angle, v / angle).toRotationMatrix() : Mat3(Mat3::Identity());
  }
  static Vec3 rotation_vector(const Mat3& turn) {
    const Eigen::AngleAxisd found(turn);
    return found.angle() * found.axis();
  }

  /// That a motion elsewhere gives the same energy, and the load turned.
  void compare(const Forces& here, const Field& motion, const Forces& elsewhere, const Field& same,
               const Mat3& turn) {
    const double energy = here.elastic_energy(motion, pool_);
    const Loads load = loads(here, motion);
    note(frame_, std::abs(elsewhere.elastic_energy(same, pool_) - energy),
         std::abs(energy) + force_ * parameters_.strain * length_);
    note(frame_, (loads(elsewhere, same) - turned(load, turn)).norm(), force_);
  }

  void check_rigid_motion(const BondedPair& pair, Forces& forces) {
    const Loads at_rest = loads(forces, Field(2));
    note(rest_, at_rest.norm(), force_);
    constexpr int steps = 10;
    const Vec3 axis = random_direction(), shift = random_vector(length_);
    Field motion(2), force(2);
    for (int step = 1; step <= steps; ++step) {
      const double angle = parameters_.turn * step / steps;
      for (std::size_t end = 0; end < 2; ++end) {
        const Vec3& x = pair.particles.position[end];
        motion[end].angular() = angle * axis;
        motion[end].linear() = shift + (TurnsWithItsEnds<Law> ? Vec3(rotation(angle * axis) * x - x)
                                                              : Vec3(angle * axis.cross(x)));
      }
      if constexpr (TurnsWithItsEnds<Law> || HasState<Law>)
        forces.advance(motion, force, pool_);
    }
    const Mat3 turn = TurnsWithItsEnds<Law> ? rotation(parameters_.turn * axis) : Mat3(Mat3::Identity());
    note(rigid_, (loads(forces, motion) - turned(at_rest, turn)).norm(), force_);
  }

  void check_order(const BondedPair& pair, const Forces& here) {
    const BondedPair other = pair.exchanged();
    const Forces there(law_, other.particles, other.network);
    for (int n = 0; n < parameters_.deformations; ++n) {
      const Field motion = random_motion();
      Field same(2);
      same[0] = motion[1];
      same[1] = motion[0];
      const Loads load = loads(here, motion), exchanged = loads(there, same);
      Loads back;
      back << exchanged.tail<6>(), exchanged.head<6>();
      note(order_, (back - load).norm(), force_);
    }
  }

  // --- paths of a law with a memory ----------------------------------------------------------------------------------

  /// Along a closed path, the first end held: what was lost is work done less what is stored, and what the forces book.
  void check_paths(const BondedPair& pair) {
    constexpr int legs = 4, steps = 200;
    Forces forces(law_, pair.particles, pair.network);
    Field motion(2), force(2), before(2);
    forces.advance(motion, before, pool_);
    const double stored = forces.elastic_energy(motion, pool_);
    double work = 0, turnover = 0;
    for (int leg = 1; leg <= legs; ++leg) {
      Field goal = leg == legs ? Field(2) : random_motion();
      goal[0] = {};
      const Field start = motion;
      for (int step = 1; step <= steps; ++step) {
        const auto last = motion[1];
        for (int c = 0; c < 6; ++c)
          motion[1][c] = start[1][c] + (goal[1][c] - start[1][c]) * step / steps;
        forces.advance(motion, force, pool_);
        double done = 0;
        for (int c = 0; c < 6; ++c)
          done -= 0.5 * (force[1][c] + before[1][c]) * (motion[1][c] - last[c]);
        work += done;
        turnover += std::abs(done);
        std::swap(force, before);
      }
    }
    const double lost = work - (forces.elastic_energy(motion, pool_) - stored);
    note(dissipation_, std::max(0.0, -lost), turnover);
    note(ledger_, std::abs(lost - forces.dissipated_energy()), turnover);
  }

  const Law& law_;
  const LawCheckParameters& parameters_;
  core::Random random_;
  core::ThreadPool pool_{1};
  std::string name_;     ///< of the bond at hand
  double length_ = 0;    ///< of it, m
  double force_ = 0;     ///< largest load on it, N
  double stiffness_ = 0; ///< largest slope of its load, N for a strain or angle of 1

  LawCheck finite_{"finite values", 0};
  LawCheck action_{"action and reaction", 1e-12};
  LawCheck moments_{"balance of moments", 1e-12};
  LawCheck frame_{"frame indifference", 1e-8};
  LawCheck rigid_{"rigid motion", 1e-8};
  LawCheck rest_{"no load at rest", 1e-8};
  LawCheck order_{"same law from either end", 1e-10};
  LawCheck gradient_{"load = dE/dx", 1e-5};
  LawCheck tangent_{"tangent = dF/dx", 1e-5};
  LawCheck symmetry_{"symmetric tangent", 1e-6};
  LawCheck dissipation_{"dissipation not negative", 1e-3};
  LawCheck ledger_{"work = stored + lost", 2e-2};
};

} // namespace cdem::bond::detail
