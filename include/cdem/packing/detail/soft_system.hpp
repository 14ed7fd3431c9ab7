#pragma once

/// @file
/// Soft spheres on their way to equilibrium: minimisation of their energy at a given scale or a given pressure.

#include <cdem/core/parallel.hpp>
#include <cdem/packing/detail/quad.hpp>
#include <cdem/packing/detail/soft_kernel.hpp>
#include <cdem/packing/detail/sorted_cells.hpp>
#include <cdem/packing/detail/verlet_lists.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace cdem::packing::detail {

/// Soft spheres of mass 1 in the unit cube (see SoftBlock for their energy E) and the descent to a minimum of E, at a
/// fixed scale of the radii or at a fixed pressure.
///
/// The descent is FIRE (Bitzek et al., Phys. Rev. Lett. 97 (2006) 170201) with semi-implicit Euler steps (Guenole et
/// al., Comput. Mater. Sci. 175 (2020) 109584): Newton's equations whose velocities are turned towards the forces
/// while they go downhill, and set to zero when they go uphill. The step is fixed, below what the stiffest sphere
/// bears. At a fixed pressure the logarithm of the scale is one more coordinate, and E - w ln(scale) descends, w the
/// wanted dE/d(ln scale): the spheres swell until they press as they shall.
/// @complexity  O(spheres) a step, in two passes; about 250 bytes a sphere
class SoftSystem {
public:
  /// @param spheres  [spheres] centre in the unit cube and size; the mean size is one half, so that the scale is the
  ///                 mean diameter
  SoftSystem(std::vector<Quad> spheres, double scale, bool periodic, core::ThreadPool& pool,
             const SoftKernels& kernels = SoftKernels::fastest())
      : spheres_(std::move(spheres)), velocity_(spheres_.size()), force_(spheres_.size()),
        identity_(spheres_.size()), cells_(1.4 * scale, periodic), periodic_(periodic), scale_(scale),
        pool_(pool), kernels_(kernels) {
    std::iota(identity_.begin(), identity_.end(), ParticleIndex{0});
    for (const Quad& sphere : spheres_)
      largest_ = std::max(largest_, sphere[3]);
    // A sphere of size s among those of mean size 1/2 has up to about 3 (1 + 2 s)^2 contacts of stiffness 2.
    step_ = 0.6 / (1 + 2 * largest_);
    skin_ = 0.3 * scale;
  }

  std::size_t size() const noexcept { return spheres_.size(); }
  bool periodic() const noexcept { return periodic_; }
  /// Mean diameter.
  double scale() const noexcept { return scale_; }
  /// Centre and size of each sphere, in an order that changes; see identity().
  const std::vector<Quad>& spheres() const noexcept { return spheres_; }
  /// Which sphere of those given to the constructor each is.
  const std::vector<ParticleIndex>& identity() const noexcept { return identity_; }
  /// Force on each sphere (x, y, z) at the last evaluate().
  const std::vector<ShortQuad>& forces() const noexcept { return force_; }
  const SoftSums& sums() const noexcept { return sums_; }
  /// Lists that hold all the contacts at the last evaluate().
  const VerletLists& lists() const noexcept { return lists_; }
  std::uint64_t evaluations() const noexcept { return evaluations_; }

  /// Mean overlap over the diameter, were there three equal contacts a sphere: dE/d(ln scale) / (6 spheres scale^2).
  double overlap() const { return sums_.force[3] / swelling_unit(); }
  /// Root mean square of the forces over the mean force of a contact, were there three equal contacts a sphere; 0 if
  /// nothing touches.
  double residual() const {
    const double mean_square = sum_of(sums_.squares) / static_cast<double>(size());
    return mean_square > 0 ? std::sqrt(mean_square) / (2 * overlap() * scale_) : 0;
  }

  /// From now on the scale is this, and fixed. Velocities are set to zero.
  void fix_scale(double scale) {
    scale_ = scale;
    goal_ = 0;
    rest();
  }
  /// From now on the scale is free, and tends to where overlap() is this.
  void fix_overlap(double overlap) {
    goal_ = overlap;
    rest();
  }

  /// Forces and their sums, at the present places and scale.
  void evaluate() {
    if (!lists_hold())
      renew_lists();
    partial_.resize(lists_.blocks());
    pool_.for_each_block(lists_.blocks(), [&](std::size_t b) {
      kernels_.forces(lists_.block(b, spheres_, scale_, !periodic_), velocity_.data(), force_.data(),
                      partial_[b]);
    });
    sums_ = {};
    for (const SoftSums& partial : partial_)
      sums_ += partial;
    ++evaluations_;
  }

  /// One step of the descent, from the forces of evaluate().
  void advance() {
    const double unit = scale_ * std::sqrt(static_cast<double>(size())); // of ln(scale) as a coordinate
    const double swell = goal_ > 0 ? swelling_unit() * (goal_ - overlap()) / unit : 0; // the force along it
    const double power = sum_of(sums_.power) + swell * swelling_;
    const double squares = sum_of(sums_.squares) + swell * swell;
    SoftStep step{1, 0, step_};
    if (power > 0) {
      if (++downhill_ > 5)
        mixing_ = std::max(mixing_ * 0.98, 0.02);
    } else {
      step.keep = 0;
      downhill_ = 0;
      mixing_ = 0.1;
    }
    const double speed =
        std::sqrt(step.keep * (sum_of(sums_.velocity) + swelling_ * swelling_ + 2 * step_ * power) +
                  step_ * step_ * squares);
    step.push = (1 - mixing_) * step_ + (squares > 0 ? mixing_ * speed / std::sqrt(squares) : 0);
    step.push = std::min(step.push, 2 * step_); // what the stiffest springs bear
    step.keep *= 1 - mixing_;
    if (goal_ > 0) {
      swelling_ = step.keep * swelling_ + step.push * swell;
      scale_ *= std::exp(std::clamp(step.step * swelling_ / unit, -0.01, 0.01));
    }
    farthest_.resize(lists_.blocks());
    pool_.for_each_block(lists_.blocks(), [&](std::size_t b) {
      const SoftBlock block = lists_.block(b, spheres_, scale_, !periodic_);
      farthest_[b] =
          kernels_.move(step, block.begin, block.end, force_.data(), velocity_.data(), spheres_.data());
    });
    moved_ += std::sqrt(*std::max_element(farthest_.begin(), farthest_.end()));
  }

private:
  static double sum_of(const Quad& sums) { return sums[0] + sums[1] + sums[2]; }
  double swelling_unit() const { return 6 * static_cast<double>(size()) * scale_ * scale_; }

  void rest() {
    std::fill(velocity_.begin(), velocity_.end(), ShortQuad{});
    swelling_ = 0;
    mixing_ = 0.1;
    downhill_ = 0;
  }

  /// Whether no pair can have come closer than the lists allow for: no sphere has moved by more than half the skin,
  /// less what the radii have grown by.
  bool lists_hold() {
    if (lists_.blocks() == 0)
      return false;
    const double room = listed_skin_ - 2 * largest_ * (scale_ - listed_scale_);
    if (2 * moved_ > room && room > 0)
      moved_ = farthest_move(); // so far the sum of the farthest moves, an upper bound
    return 2 * moved_ <= room;
  }

  double farthest_move() {
    pool_.for_each_block(lists_.blocks(), [&](std::size_t b) {
      const SoftBlock block = lists_.block(b, spheres_, scale_, !periodic_);
      farthest_[b] = 0;
      for (ParticleIndex i = block.begin; i < block.end; ++i) {
        double square = 0;
        for (int k = 0; k < 3; ++k)
          square += (spheres_[i][k] - listed_[i][k]) * (spheres_[i][k] - listed_[i][k]);
        farthest_[b] = std::max(farthest_[b], square);
      }
    });
    return std::sqrt(*std::max_element(farthest_.begin(), farthest_.end()));
  }

  /// Sorts the spheres in space and makes their lists anew.
  void renew_lists() {
    adapt_skin();
    if (periodic_)
      core::parallel_for(pool_, size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          for (int k = 0; k < 3; ++k)
            spheres_[i][k] -= std::floor(spheres_[i][k]);
      });
    cells_.sort(spheres_, order_, pool_);
    listed_.resize(size());
    permute(spheres_, listed_);
    permute(velocity_, force_);
    std::vector<ParticleIndex> identity(size());
    permute(identity_, identity);
    listed_ = spheres_;
    listed_scale_ = scale_;
    listed_skin_ = skin_;
    moved_ = 0;
    listed_at_ = evaluations_;
    lists_.build(spheres_, cells_, scale_, skin_, largest_, pool_);
  }

  /// A wide skin while spheres travel, a narrow one when they have settled: any gives the same motion but for
  /// rounding.
  void adapt_skin() {
    if (lists_.blocks() > 0) {
      const std::uint64_t lasted = evaluations_ - listed_at_;
      skin_ = std::clamp(skin_ * (lasted < 20 ? 1.25 : lasted > 100 ? 0.8 : 1), 0.04 * scale_, 0.3 * scale_);
    }
    if (periodic_) // lists hold the nearest images alone
      skin_ = std::min(skin_, 0.499 - 2 * largest_ * scale_);
  }

  template <class Value>
  void permute(std::vector<Value>& values, std::vector<Value>& scratch) {
    core::parallel_for(pool_, size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        scratch[i] = values[order_[i]];
    });
    values.swap(scratch);
  }

  std::vector<Quad> spheres_;                   ///< [spheres]
  std::vector<ShortQuad> velocity_, force_;     ///< [spheres]
  std::vector<Quad> listed_;                    ///< [spheres] places for which the lists were made
  std::vector<ParticleIndex> identity_, order_; ///< [spheres]
  SortedCells cells_;
  VerletLists lists_;
  std::vector<SoftSums> partial_; ///< [blocks]
  std::vector<double> farthest_;  ///< [blocks] squares
  SoftSums sums_;
  bool periodic_;
  double scale_, largest_ = 0, step_, skin_;
  double listed_scale_ = 0, listed_skin_ = 0, moved_ = 0;
  double goal_ = 0;                    ///< wanted overlap(), 0 at a fixed scale
  double swelling_ = 0, mixing_ = 0.1; ///< velocity of the scale's coordinate; FIRE's alpha
  int downhill_ = 0;                   ///< steps since the last uphill one
  std::uint64_t evaluations_ = 0, listed_at_ = 0;
  core::ThreadPool& pool_;
  SoftKernels kernels_;
};

} // namespace cdem::packing::detail
