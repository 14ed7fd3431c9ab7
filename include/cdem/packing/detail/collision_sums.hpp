#pragma once

/// @file
/// Sums over collisions, the same whatever the order in which the collisions are added.

#include <algorithm>
#include <cstdint>

namespace cdem::packing::detail {

/// Sums over the collisions of a period, from which its pressure follows.
struct CollisionSums {
  std::uint64_t events = 0;     ///< collisions, renewals of lists and second looks
  std::uint64_t collisions = 0; ///< with spheres and walls
  double duration = 0;
  double virial = 0; ///< sum of exchanged momentum times distance of contact
  double action = 0; ///< integral of the kinetic energy over time

  /// Reduced pressure PV/(NkT) = 1 + virial/(2 integral of E_kin dt), the virial theorem with NkT = 2 E_kin/3; each
  /// exchange of momentum J counts J times the distance between the centres, or J times the radius at a wall.
  /// Infinity if no time has passed.
  double reduced_pressure() const { return 1 + virial / (2 * action); }

  friend CollisionSums operator+(CollisionSums a, const CollisionSums& b) {
    a.events += b.events;
    a.collisions += b.collisions;
    a.duration += b.duration;
    a.virial += b.virial;
    a.action += b.action;
    return a;
  }
};

/// Non-negative numbers of order 1, summed in units of 2^-40: whole numbers add up to the same in any order.
class ExactSum {
public:
  void add(double value) { units_ += static_cast<std::int64_t>(value * unit_ + 0.5); }
  void add(const ExactSum& other) { units_ += other.units_; }
  double value() const { return static_cast<double>(units_) / unit_; }

private:
  static constexpr double unit_ = 0x1p40;
  std::int64_t units_ = 0;
};

/// What happened in a window of time.
struct WindowSums {
  std::uint64_t events = 0, collisions = 0;
  ExactSum virial; ///< momentum times distance over the mean diameter at the cycle's start
  ExactSum work;   ///< of the growing surfaces
  ExactSum heat;   ///< work times the part of the window that was left

  void add(const WindowSums& other) {
    events += other.events;
    collisions += other.collisions;
    virial.add(other.virial);
    work.add(other.work);
    heat.add(other.heat);
  }
};

/// Notices that time has come to a standstill: rounding near contact can make a few spheres collide again and again
/// without time passing.
///
/// A cycle has a fixed number of events, and the time it takes shrinks slowly. One that takes less than a thousandth of
/// the last sound cycle's time hesitates (the caller shrinks the radii by a rounding or two and tries again); after
/// twenty in a row the system is stalled.
class StallWatch {
public:
  enum class Verdict : std::uint8_t { advances, hesitates, stalled };

  StallWatch() = default;
  StallWatch(double sound_duration, int hesitations)
      : sound_duration_(sound_duration), hesitations_(hesitations) {}

  /// @param duration  time that passed in the cycle
  Verdict judge(double duration) {
    if (duration > 1e-3 * sound_duration_) {
      sound_duration_ = duration;
      hesitations_ = 0;
      return Verdict::advances;
    }
    return ++hesitations_ < 20 ? Verdict::hesitates : Verdict::stalled;
  }

  double sound_duration() const noexcept { return sound_duration_; }
  int hesitations() const noexcept { return hesitations_; }

private:
  double sound_duration_ = 0;
  int hesitations_ = 0;
};

} // namespace cdem::packing::detail
