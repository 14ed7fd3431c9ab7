#pragma once

/// @file
/// Random packings of soft spheres that repel each other, brought to rest at the wanted density or contact number.

#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/core/progress.hpp>
#include <cdem/core/random.hpp>
#include <cdem/packing/detail/random_start.hpp>
#include <cdem/packing/detail/soft_contacts.hpp>
#include <cdem/packing/detail/soft_system.hpp>
#include <cdem/packing/packing_generator.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

namespace cdem::packing {

/// Packing of soft spheres by minimisation of their energy (O'Hern, Silbert, Liu and Nagel, Phys. Rev. E 68 (2003)
/// 011306), to the jamming point, to a density, or to a contact number.
///
/// Spheres are put at random into a loose arrangement. Their radii are a coordinate like any other: they swell until
/// the spheres press on each other as they shall, while the energy of the overlaps descends to a minimum (FIRE). Then
/// the pressure is lowered in steps, each to equilibrium, to where the overlaps vanish: the jamming point. A wanted
/// density above it is reached by compression, with overlaps; one below it by shrinking the radii of the jammed
/// packing, with gaps. See docs/soft_spheres.md.
/// @complexity  5,000 to 15,000 evaluations of all forces, of about 30 ns a sphere on one core; about 250 bytes a
///              sphere
class SoftSpheres {
public:
  /// Where to stop.
  enum class Target : std::uint8_t {
    jamming,       ///< where the mean overlap is `jamming_overlap`
    density,       ///< at `density`
    contact_number ///< where the spheres that are held have `contact_number` contacts on average
  };

  struct Parameters {
    std::uint32_t particles = 10000; ///< number of spheres, 1 to 1e8
    Target target = Target::density;
    double density = 0.64; ///< wanted: volume of the spheres (overlaps counted twice) over that of the cube
    double contact_number = 6.2; ///< wanted, 6.05 to 10: equal spheres have 6 at the jamming point
    /// Standard deviation over mean of the normal law of the radii, 0 to 0.5. The cuts below make the
    /// sample's lower: 0.296 for 0.3 cut at 3 standard deviations.
    double cov = 0.3;
    double truncation = 3; ///< radii further from the mean than this many standard deviations are drawn again
    double smallest_radius = 0.1; ///< so are radii below this part of the mean; if this cuts, the mean rises
    /// Mean overlap at which the spheres find their places, over the sum of two radii: more gives a denser jammed
    /// packing.
    double compression = 0.01;
    double jamming_overlap = 4e-5; ///< mean overlap that counts as the jamming point
    double tolerance =
        0.01; ///< of balance: root mean square of the forces on spheres over the mean contact force
    std::uint32_t most_evaluations = 200000; ///< of all forces; a run that needs more ends unbalanced
    double side = 0.01;                      ///< edge of the cube, m
    Boundary boundary = Boundary::periodic;
    std::uint64_t seed = 1; ///< the same seed gives the same bytes
    int threads = 1;        ///< 0 for all the processors; the bytes do not depend on it
  };

  /// Contacts are those of the last state in equilibrium; where a wanted density is reached by shrinking the radii,
  /// that is before they are shrunk.
  struct Report {
    Target target = Target::density;
    double wanted = 0;     ///< density or contact number; 0 for the jamming point
    bool found = false;    ///< whether the wanted state was reached
    bool balanced = false; ///< whether the forces balance within `tolerance`
    double density = 0;    ///< spheres' volume (overlaps counted twice) over the cube's
    /// Where the overlaps vanish, extrapolated from the states of least overlap.
    double jamming_density = 0;
    double contact_number = 0;   ///< mean number of contacts of the spheres that are held; walls count
    std::uint32_t rattlers = 0;  ///< spheres with fewer than four contacts, taken out again and again
    double residual = 0;         ///< root mean square of the forces on spheres over the mean contact force
    double largest_residual = 0; ///< largest force on a sphere over the mean contact force
    double pressure = 0;         ///< times the mean diameter over the stiffness of a contact at first touch
    double mean_overlap =
        0; ///< of the packing's contacts, over the sum of the two radii (at a wall: the radius)
    double largest_overlap = 0;    ///< of the packing, over the same
    std::uint64_t evaluations = 0; ///< of all forces
    double wall_seconds = 0;       ///< all of pack()
    double mean_radius = 0;        ///< of the sample, m
    double cov = 0;                ///< of the sample's radii

    /// Whether the wanted state was reached, and balances.
    bool reached() const noexcept { return found && balanced; }

    /// @throws core::NotReached  if it was not; names what was wanted and where the run ended
    void require_reached() const {
      if (!reached())
        throw core::NotReached(
            std::string(to_string(target)) + (wanted > 0 ? " " + core::to_text(wanted) : "") +
            " was not reached: density " + core::to_text(density) + ", contact number " +
            core::to_text(contact_number) + ", unbalanced force " + core::to_text(residual) +
            " of the mean contact force after " + core::to_text(evaluations) +
            " evaluations; more evaluations or a larger tolerance is needed");
    }
  };

  /// "jamming point", "density" or "contact number".
  static constexpr std::string_view to_string(Target target) {
    switch (target) {
    case Target::jamming:
      return "jamming point";
    case Target::density:
      return "density";
    case Target::contact_number:
      break;
    }
    return "contact number";
  }

  /// Checks the parameters and draws the radii.
  /// @throws core::InvalidInput  if a parameter is out of its range, or the spheres would be too large for the box:
  ///         periodic images may not see each other, so the largest diameter must stay below 0.45 of the side (walls:
  ///         below the side)
  explicit SoftSpheres(const Parameters& parameters);

  const Parameters& parameters() const noexcept { return parameters_; }

  /// Packs the spheres. Their order has nothing to do with their radii.
  ///
  /// The monitor hears of stage "packing" about four times a second, and once at the end.
  /// @return             report.reached() says whether the target is reached; report.require_reached() throws if not
  /// @throws core::Interrupted  when the monitor asks to stop
  Packing<Report> pack(const core::Monitor& monitor = core::Monitor()) const;

private:
  using Clock = std::chrono::steady_clock;
  class Run;

  static void validate(const Parameters& parameters);
  void draw_sizes();
  double density_at(double scale) const { return size_volume_ * scale * scale * scale; }
  double scale_at(double density) const { return std::cbrt(density / size_volume_); }
  std::vector<detail::Quad> start_loose() const;

  Parameters parameters_;
  core::Random random_; ///< as it is once the sizes are drawn
  bool periodic_;
  std::vector<double> sizes_; ///< [spheres] radii at a mean diameter of 1
  double size_volume_ = 0;    ///< of the spheres at a mean diameter of 1
};

inline SoftSpheres::SoftSpheres(const Parameters& parameters)
    : parameters_(parameters), random_(parameters.seed),
      periodic_(parameters.boundary == Boundary::periodic) {
  validate(parameters_);
  draw_sizes();
}

inline void SoftSpheres::validate(const Parameters& p) {
  detail::expect_size_law(p);
  core::expect(p.target == Target::jamming || p.target == Target::density ||
                   p.target == Target::contact_number,
               "target", static_cast<int>(p.target), "jamming, density or contact_number is expected");
  core::expect(p.density > 0 && p.density < 1, "density", p.density, "above 0 and below 1 is expected");
  core::expect(p.contact_number >= 6.05 && p.contact_number <= 10, "contact number", p.contact_number,
               "6.05 to 10 is expected: 6 is the jamming point");
  core::expect(p.compression >= 1e-3 && p.compression <= 0.1, "compression", p.compression,
               "a mean overlap of 1e-3 to 0.1 is expected");
  core::expect(p.jamming_overlap >= 1e-7 && p.jamming_overlap <= 1e-3, "overlap at the jamming point",
               p.jamming_overlap, "1e-7 to 1e-3 is expected");
  core::expect(p.tolerance >= 1e-8 && p.tolerance <= 0.1, "tolerance", p.tolerance,
               "1e-8 to 0.1 is expected");
  core::expect(p.most_evaluations >= 1, "most evaluations", p.most_evaluations, "1 or more is expected");
  core::expect_positive(p.side, "side of the cube", "m");
  core::expect(p.boundary == Boundary::periodic || p.boundary == Boundary::walls, "boundary",
               static_cast<int>(p.boundary), "periodic or walls is expected");
  core::expect(p.threads >= 0 && p.threads <= 4096, "threads", p.threads,
               "0 (all processors) to 4096 is expected");
}

inline void SoftSpheres::draw_sizes() {
  sizes_ = detail::draw_sizes(parameters_, random_);
  size_volume_ = detail::volume_of_spheres(sizes_);

  if (!periodic_ && parameters_.target != Target::density)
    return;
  const double density =
      periodic_ ? std::max(parameters_.density, 0.7) : parameters_.density; // 0.7 on the way
  const double diameter = 2 * *std::max_element(sizes_.begin(), sizes_.end()) * scale_at(density);
  detail::expect_room(parameters_, diameter, periodic_);
}

/// Random places of a loose arrangement without overlaps.
inline std::vector<detail::Quad> SoftSpheres::start_loose() const {
  core::Random random = random_;
  std::vector<Vec3> centres;
  for (double density = 0.2; centres.empty(); density /= 2) {
    std::vector<double> radii = sizes_;
    for (double& radius : radii)
      radius *= scale_at(density);
    centres = detail::add_sequentially(radii, periodic_, random);
  }
  std::vector<detail::Quad> spheres(centres.size());
  for (std::size_t i = 0; i < spheres.size(); ++i)
    spheres[i] = {{centres[i][0], centres[i][1], centres[i][2], sizes_[i]}};
  return spheres;
}

/// One call of pack().
class SoftSpheres::Run {
public:
  Run(const SoftSpheres& generator, const core::Monitor& monitor)
      : generator_(generator), parameters_(generator.parameters_), monitor_(monitor),
        pool_(parameters_.threads),
        system_(generator.start_loose(), generator.scale_at(0.6), generator.periodic_, pool_) {}

  Packing<Report> pack() {
    report_.target = parameters_.target;
    report_.wanted = parameters_.target == Target::jamming   ? 0
                     : parameters_.target == Target::density ? parameters_.density
                                                             : parameters_.contact_number;
    descend();
    report_.density = generator_.density_at(final_scale_ > 0 ? final_scale_ : system_.scale());
    complete();
    fraction_ = 1;
    report_progress();
    report_.wall_seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    return result();
  }

private:
  static constexpr double step_down = 0.3; // of the overlap, from one state to the next
  static constexpr std::uint64_t first_settling = 1200, settling = 1500; // evaluations for states on the way
  /// Evaluations of a state at least: spheres that still swing are for moments near balance, before contacts have
  /// found their places.
  static constexpr std::uint64_t least_settling = 600;

  double density() const { return generator_.density_at(system_.scale()); }

  /// From the compressed state to the wanted one.
  void descend() {
    double overlap = parameters_.compression;
    stages_ = 2 + static_cast<int>(
                      std::ceil(std::log(parameters_.jamming_overlap / overlap) / std::log(step_down)));
    for (;; ++stage_) {
      const bool jamming = overlap <= parameters_.jamming_overlap * (1 + 1e-9);
      relax_at_overlap(overlap, jamming && parameters_.target == Target::jamming);
      note_jamming_density();
      if (parameters_.target == Target::density && density() <= parameters_.density)
        return compress();
      if (parameters_.target == Target::contact_number && contact_number() <= parameters_.contact_number)
        return find_contact_number(overlap);
      if (jamming)
        break;
      overlap = std::max(overlap * step_down, parameters_.jamming_overlap);
    }
    if (parameters_.target == Target::density) { // jammed above it: shrunk, the spheres no longer touch
      relax_at_overlap(overlap, true);
      note_jamming_density();
      final_scale_ = generator_.scale_at(parameters_.density);
    }
    report_.found = parameters_.target != Target::contact_number;
  }

  /// To a density above the present one.
  void compress() {
    system_.fix_scale(generator_.scale_at(parameters_.density));
    relax(parameters_.most_evaluations);
    report_.found = true;
  }

  /// Searches for the overlap at which the contact number is the wanted one; (Z - 6)^2 is about linear in it.
  void find_contact_number(double overlap) {
    double low = overlap, high = 0; // overlaps with too few and too many contacts
    const double wanted = parameters_.contact_number;
    for (int trial = 0; trial < 20; ++trial) {
      relax_at_overlap(overlap, true);
      note_jamming_density();
      const double number = contact_number();
      if (std::abs(number - wanted) <= 0.01) {
        report_.found = report_.balanced;
        return;
      }
      (number < wanted ? low : high) = overlap;
      const double excess = std::max(number - 6, 0.02);
      const double guess = overlap * std::pow((wanted - 6) / excess, 2);
      overlap = std::clamp(guess, high > 0 && high > low ? low + 0.1 * (high - low) : overlap / 3,
                           high > low ? high - 0.1 * (high - low) : std::min(3 * overlap, 0.15));
    }
  }

  double contact_number() { return detail::survey_soft_contacts(system_, pool_).contact_number; }

  void relax_at_overlap(double overlap, bool last) {
    system_.fix_overlap(overlap);
    goal_ = overlap;
    least_evaluations_ = system_.evaluations() + least_settling;
    relax(last ? parameters_.most_evaluations
               : system_.evaluations() + (stage_ == 0 ? first_settling : settling));
    goal_ = 0;
    least_evaluations_ = 0;
  }

  /// Descends until the forces balance, or there are none.
  void relax(std::uint64_t most_evaluations) {
    const std::uint64_t most = std::min<std::uint64_t>(most_evaluations, parameters_.most_evaluations);
    first_residual_ = 0;
    first_evaluation_ = system_.evaluations();
    for (report_.balanced = false;; system_.advance()) {
      system_.evaluate();
      if (monitor_.stop_requested() || Clock::now() - reported_ > std::chrono::milliseconds(250))
        report_progress(most);
      const bool pressed = goal_ == 0 || std::abs(system_.overlap() / goal_ - 1) < parameters_.tolerance;
      if (pressed && system_.evaluations() >= least_evaluations_ &&
          system_.residual() <= parameters_.tolerance) {
        report_.balanced = true;
        return;
      }
      if (system_.evaluations() >= most)
        return;
    }
  }

  /// Near jamming the overlaps are in proportion to the excess density: a line through the two states of least overlap,
  /// or through one with the slope of an affine swelling.
  void note_jamming_density() {
    states_.push_back({system_.overlap(), density()});
    std::sort(states_.begin(), states_.end(),
              [](const State& a, const State& b) { return a.overlap < b.overlap; });
    const State least = states_.front();
    const auto next = std::find_if(states_.begin(), states_.end(),
                                   [&](const State& state) { return state.overlap > 1.1 * least.overlap; });
    const double slope = next == states_.end()
                             ? 3 * least.density
                             : (next->density - least.density) / (next->overlap - least.overlap);
    report_.jamming_density = least.density - slope * least.overlap;
  }

  /// Share of the run that lies before a state: in the first two spheres travel and lists are renewed often.
  double share_before(double stage) const {
    const auto work = [](double k) { return k < 1 ? 3 * k : k < 2 ? 3 + 2 * (k - 1) : k + 3; };
    return work(stage) / work(stages_);
  }

  /// @param most  evaluations at which the present state is left at the latest
  void report_progress(std::uint64_t most = 0) {
    reported_ = Clock::now();
    if (fraction_ < 1) {
      double part; // of the present state: on the way evaluations run out sooner than forces balance
      if (most < parameters_.most_evaluations) {
        part = static_cast<double>(system_.evaluations() - first_evaluation_) /
               static_cast<double>(std::max(most, first_evaluation_ + 1) - first_evaluation_);
      } else {
        const double residual = std::max(system_.residual(), parameters_.tolerance);
        first_residual_ = std::max(first_residual_, residual);
        part = std::log(first_residual_ / residual) /
               std::max(std::log(first_residual_ / parameters_.tolerance), 1e-9);
      }
      fraction_ = std::max(fraction_, std::min(share_before(stage_ + std::min(part, 1.0)), 0.99));
    }
    monitor_.report({"packing", fraction_,
                     "density " + core::to_text(density()) + ", overlap " + core::to_text(system_.overlap()) +
                         ", unbalanced force " + core::to_text(system_.residual())});
  }

  /// What the report says of contacts, and of the sample.
  void complete() {
    const detail::SoftContacts contacts = detail::survey_soft_contacts(system_, pool_);
    report_.contact_number = contacts.contact_number;
    report_.rattlers = contacts.rattlers;
    report_.residual = contacts.residual;
    report_.largest_residual = contacts.largest_residual;
    report_.pressure = contacts.virial / 3 * system_.scale() / 2; // the stiffness is 2
    report_.mean_overlap = contacts.mean_overlap;
    report_.largest_overlap = contacts.largest_overlap;
    report_.evaluations = system_.evaluations();
    if (final_scale_ > 0) {
      const double shrinking = system_.scale() / final_scale_; // 1 - r/D of r = (1 - o) D shrunk
      report_.mean_overlap = std::max(0.0, 1 - shrinking * (1 - contacts.mean_overlap));
      report_.largest_overlap = std::max(0.0, 1 - shrinking * (1 - contacts.largest_overlap));
    }
    double square = 0;
    for (const double size : generator_.sizes_)
      square += (2 * size - 1) * (2 * size - 1);
    report_.cov = std::sqrt(square / static_cast<double>(generator_.sizes_.size()));
  }

  Packing<Report> result() {
    Packing<Report> packing;
    packing.box = geometry::Box::cube(parameters_.side, generator_.periodic_);
    packing.particles.resize(system_.size());
    const double scale = (final_scale_ > 0 ? final_scale_ : system_.scale()) * parameters_.side;
    for (std::size_t i = 0; i < system_.size(); ++i) {
      const detail::Quad& sphere = system_.spheres()[i];
      packing.particles.position[i] =
          packing.box.wrap(Vec3(sphere[0], sphere[1], sphere[2]) * parameters_.side);
      packing.particles.radius[i] = sphere[3] * scale;
    }
    report_.mean_radius = packing.particles.mean_radius();
    packing.report = report_;
    return packing;
  }

  struct State {
    double overlap, density;
  };

  Clock::time_point start_ = Clock::now(), reported_ = start_;
  const SoftSpheres& generator_;
  const Parameters& parameters_;
  const core::Monitor& monitor_;
  core::ThreadPool pool_;
  detail::SoftSystem system_;
  Report report_;
  std::vector<State> states_;
  double goal_ = 0;                     ///< wanted overlap, 0 at a fixed scale
  std::uint64_t least_evaluations_ = 0; ///< before which no state is taken for balanced
  std::uint64_t first_evaluation_ = 0;  ///< of the present state
  double final_scale_ = 0;              ///< to which the radii are set at the end, 0 for the present one
  double first_residual_ = 0, fraction_ = 0;
  int stage_ = 0, stages_ = 1;
};

inline Packing<SoftSpheres::Report> SoftSpheres::pack(const core::Monitor& monitor) const {
  return Run(*this, monitor).pack();
}

static_assert(PackingGenerator<SoftSpheres>);

} // namespace cdem::packing
