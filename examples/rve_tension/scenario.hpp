#pragma once

// A homogeneous cube in tension: [L17] section 2.3, alumina and silica glass.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/boundary/symmetric_tension.hpp>
#include <cdem/homogenize/tension_recorder.hpp>
#include <cdem/integrate/density_scaling.hpp>
#include <cdem/integrate/rayleigh_quotient.hpp>
#include <cdem/integrate/velocity_verlet.hpp>
#include <cdem/io/checkpoint.hpp>
#include <cdem/network/anisotropy.hpp>
#include <cdem/network/coordination.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/simulation/specimen.hpp>
#include <cdem/stress/closure.hpp>
#include <cdem/stress/love_weber.hpp>
#include <cdem/stress/statistics.hpp>

#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/packings.hpp"
#include "common/paper_materials.hpp"
#include "common/static_solver.hpp"

namespace cdem::examples::rve_tension {

using Material = PaperMaterial;

inline std::vector<Material> paper_materials() {
  return {alumina(), silica()};
}

/// How the displacements are found; everything after is the same.
enum class Method : std::uint8_t {
  verlet,     ///< the paper's: explicit steps at constant velocity, averaged over time
  statics,    ///< the equilibrium itself, by multigrid
  relaxation, ///< the same by explicit steps with kinetic damping, which serve laws that are not linear too
};

struct Params {
  packing::LubachevskyStillinger::Parameters packing = {};
  PackingSource source = {}; ///< a packing given, and where those made are kept
  std::vector<Material> materials = paper_materials();
  double coordination = 6.2; ///< Z, [L17] section 2.1
  Axis axis = Axis::x;       ///< of the tension
  double velocity = 1e-5;    ///< m/s, [L17] section 2.3; statics take it as m
  Method method = Method::verlet;
  double safety = 0.5;         ///< D_t, [L17] section 2.3
  double damping_ratio = 0.01; ///< of the first axial vibration (not in the paper)
  integrate::DensityScaling scaling = integrate::DensityScaling::per_particle;
  double ramp = 0; ///< over which the loaded face is accelerated, in periods of that vibration; 0: at once
  std::uint64_t most_steps = 50000; ///< end of the run where it has not converged before
  bool until_converged = true;      ///< false: most_steps in any case
  homogenize::ConvergenceRule::Parameters convergence = {}; ///< [L17] section 5.3
  std::uint64_t observe_every = 1;                          ///< steps, of the moduli and their averages
  std::uint64_t sample_every = 50;                          ///< steps, of the curves
  /// Periods of the first axial vibration that the steady averages leave out; the interval of the checks without it.
  std::optional<double> steady_after = {};
  double particles_per_specimen = 80; ///< [L17] section 2.5: CoV of the stress 10 %
  int threads = 0;
  /// Of statics and relaxation.
  double relative_residual = 1e-8;
  std::filesystem::path checkpoints = {}; ///< folder for checkpoints; none when empty
  bool resume = false;                    ///< go on from the checkpoints in it

  /// @throws core::InvalidInput for what no stage would accept, before anything is computed or written
  void validate() const {
    packing::LubachevskyStillinger{packing};
    core::expect_positive(coordination, "coordination");
    core::expect(safety > 0 && safety < 1, "safety", safety, "a number in ]0, 1[ is expected");
    core::expect_not_negative(damping_ratio, "damping");
    core::expect(std::isfinite(velocity) && velocity != 0, "velocity", velocity,
                 "a number other than 0 m/s is expected");
    core::expect_positive(particles_per_specimen, "particles per specimen");
    core::expect(particles_per_specimen <= packing.particles, "particles per specimen",
                 particles_per_specimen,
                 "at most the number of particles, " + std::to_string(packing.particles) + ", is expected");
    homogenize::ConvergenceRule{convergence};
    core::expect_not_negative(ramp, "ramp", "periods");
    core::expect_not_negative(steady_after.value_or(0), "beginning of the steady averages", "periods");
    core::expect(sample_every >= 1, "sample_every", sample_every, "1 step or more is expected");
    core::expect(observe_every >= 1 && sample_every % observe_every == 0 &&
                     convergence.interval % observe_every == 0,
                 "observe_every", observe_every,
                 "a divisor of the " + std::to_string(sample_every) + " steps between samples and the " +
                     std::to_string(convergence.interval) + " between checks is expected");
    core::expect(most_steps > convergence.interval, "steps", most_steps,
                 "more than the interval of the convergence checks, " + std::to_string(convergence.interval) +
                     ", is expected");
  }
};

/// What one material gave.
struct MaterialResult {
  Material material;
  homogenize::TensionModuli moduli;
  std::vector<homogenize::TensionSample> samples;
  particles::Motion motion;             ///< at the end of the run
  std::vector<Vec3> bond_forces;        ///< [bonds] N, averaged over time, at the final strain
  stress::StressField stress;           ///< of those
  double strain = 0;                    ///< eps_L by the faces at the end
  double force_fixed = 0;               ///< N, averaged over time, at that strain
  double force_loaded = 0;              ///< N
  double moment_of_reactions = 0;       ///< N m, axial component of sum of F (x) x
  double section = 0;                   ///< m^2
  double first_frequency = 0;           ///< of the first axial vibration, rad/s, by Rayleigh's quotient
  integrate::Loading loading;           ///< as run
  std::uint64_t steady_from = 0;        ///< step at which the steady averages begin
  integrate::CriticalTimeStep critical; ///< before density scaling
  integrate::DensityScalingReport scaling;
  integrate::EnergyLedger energy; ///< at the end
  StaticSolver::Report solver;    ///< of a static solver
  bool converged = false;
};

struct Result {
  packing::LubachevskyStillinger::Report packing; ///< the density alone for a packing given as a file
  bool packing_loaded = false;                    ///< from a file given, or one kept by an earlier run
  bool packing_reported = false;                  ///< whether there is a generator's report
  simulation::Specimen specimen;
  boundary::TensionSetup setup;
  network::Anisotropy<> anisotropy;
  network::DegreeHistogram degrees;
  std::uint64_t outside_largest = 0; ///< particles that hang on nothing
  stress::tessellation::Hexahedra tessellation;
  std::vector<MaterialResult> materials;
};

namespace detail {

using Recorder = homogenize::TensionRecorder<bond::LinearForces>;

/// Writes or reads one part of the recorder's state; Archive is a CheckpointWriter or a CheckpointReader.
struct Save {
  io::CheckpointWriter& file;
  void operator()(const std::string& name, const homogenize::RunningAverage& average) {
    file.add(name, std::array{average.mean(), static_cast<double>(average.count())});
  }
  void operator()(const std::string& name, const homogenize::ConvergenceRule& rule) {
    const auto& state = rule.state();
    file.add(name, std::array{state.last, state.checked ? 1.0 : 0.0, static_cast<double>(state.passed)});
  }
  void operator()(const std::string& name, const std::vector<Vec3>& values) { file.add(name, values); }
  void operator()(const std::string& name, const std::vector<homogenize::TensionSample>& samples) {
    std::vector<std::array<double, 14>> rows;
    for (const auto& s : samples)
      rows.push_back({s.step, s.time, s.youngs_modulus, s.youngs_modulus_average, s.youngs_modulus_steady,
                      s.poissons_ratio, s.poissons_ratio_average, s.poissons_ratio_steady, s.force_fixed,
                      s.force_loaded, s.kinetic, s.elastic, s.external_work, s.dissipated});
    file.add(name, rows);
  }
};
struct Load {
  const io::CheckpointReader& file;
  void operator()(const std::string& name, homogenize::RunningAverage& average) {
    const auto v = numbers(name, 2);
    average = homogenize::RunningAverage::restore(v[0], static_cast<std::uint64_t>(v[1]));
  }
  void operator()(const std::string& name, homogenize::ConvergenceRule& rule) {
    const auto v = numbers(name, 3);
    rule.restore({v[0], v[1] != 0, static_cast<int>(v[2])});
  }
  void operator()(const std::string& name, std::vector<Vec3>& values) { file.read(name, values); }
  void operator()(const std::string& name, std::vector<homogenize::TensionSample>& samples) {
    samples.clear();
    for (const auto& r : file.read<std::array<double, 14>>(name))
      samples.push_back(
          {r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8], r[9], r[10], r[11], r[12], r[13]});
  }

private:
  std::vector<double> numbers(const std::string& name, std::size_t count) const {
    auto values = file.read<double>(name);
    if (values.size() != count)
      file.fail("its section " + name + " does not hold " + std::to_string(count) + " numbers");
    return values;
  }
};

inline void save(const std::filesystem::path& path, const std::string& identity,
                 const particles::Motion& motion, Recorder& recorder) {
  io::CheckpointWriter file(path);
  file.add("identity", identity);
  file.add("displacement", motion.displacement);
  file.add("velocity", motion.velocity);
  file.add("acceleration", motion.acceleration);
  file.add("energy", std::array{motion.energy.initial, motion.energy.external_work, motion.energy.dissipated,
                                motion.energy.external_power, motion.energy.dissipated_power});
  file.add("time", motion.time);
  file.add("step", motion.step);
  recorder.visit_state(Save{file});
  file.commit();
}

inline void load(const std::filesystem::path& path, const std::string& identity, particles::Motion& motion,
                 Recorder& recorder) {
  const io::CheckpointReader file(path);
  if (file.read_text("identity") != identity)
    file.fail("it belongs to a run with other parameters; run with the same options, or without --resume");
  file.read("displacement", motion.displacement);
  file.read("velocity", motion.velocity);
  file.read("acceleration", motion.acceleration);
  const auto energy = file.read<double>("energy");
  if (energy.size() != 5)
    file.fail("its section energy does not hold 5 numbers");
  motion.energy = {energy[0], energy[1], energy[2], energy[3], energy[4]};
  motion.time = file.read_value<double>("time");
  motion.step = file.read_value<std::uint64_t>("step");
  recorder.visit_state(Load{file});
}

/// The packing; kept beside the checkpoints where there is no cache. One that jams up to a tenth below the density asked for
/// is used all the same, and its report says so; any other is an error.
inline ObtainedPacking<packing::LubachevskyStillinger>
make_packing(const Params& params, core::ThreadPool& pool, const core::Monitor& monitor) {
  const auto judge = [&](const packing::LubachevskyStillinger::Report& report) {
    const bool usable = report.reason == packing::StopReason::pressure_limit &&
                        report.density >= 0.9 * params.packing.density;
    if (!usable)
      report.require_reached();
  };
  const auto& cache = params.source.cache.empty() ? params.checkpoints : params.source.cache;
  return obtain_packing<packing::LubachevskyStillinger>(params.packing, {params.source.file, cache}, judge,
                                                        monitor, &pool);
}

/// Everything that a run of one material depends on: a checkpoint with the same text belongs to the same run.
inline std::string describe(const Params& params) {
  std::ostringstream text;
  text.precision(17);
  text << packing_identity<packing::LubachevskyStillinger>(params.packing, params.source)
       << "coordination = " << params.coordination << "\naxis = " << core::name_of(params.axis)
       << "\nvelocity = " << params.velocity << "\nsafety = " << params.safety
       << "\ndamping_ratio = " << params.damping_ratio << "\nramp = " << params.ramp
       << "\nscaling = " << static_cast<int>(params.scaling) << "\nobserve_every = " << params.observe_every
       << "\nsample_every = " << params.sample_every
       << "\nsteady_after = " << params.steady_after.value_or(-1)
       << "\ninterval = " << params.convergence.interval << "\ntolerance = " << params.convergence.tolerance
       << '\n';
  return text.str();
}

/// The paper's way: explicit steps until the averages have converged, with checkpoints under `name`.
inline void march(const integrate::VelocityVerlet& verlet,
                  const integrate::Problem<bond::LinearForces>& problem, const std::string& name,
                  const Params& params, particles::Motion& motion, Recorder& recorder, core::ThreadPool& pool,
                  const core::Monitor& monitor) {
  const bool keeps = !params.checkpoints.empty();
  const std::filesystem::path checkpoint = params.checkpoints / (name + ".checkpoint");
  const std::string identity = describe(params);
  if (params.resume && keeps && std::filesystem::exists(checkpoint))
    load(checkpoint, identity, motion, recorder);
  const core::Monitor shown([&](const core::Progress& progress) {
    const double done = static_cast<double>(motion.step) / static_cast<double>(params.most_steps);
    monitor.report({name, done, progress.detail + " of at most " + std::to_string(params.most_steps)});
  });
  const auto watch = [&](const integrate::Step& step) { return recorder(step) || !params.until_converged; };
  try {
    while (!(params.until_converged && recorder.converged()) && motion.step < params.most_steps) {
      // in portions, so that a checkpoint is never far behind
      const auto portion = std::min(params.convergence.interval, params.most_steps - motion.step);
      verlet.run(problem, motion, portion, pool, watch, shown);
      if (keeps)
        save(checkpoint, identity, motion, recorder);
    }
  } catch (const core::Interrupted&) {
    if (!keeps)
      throw;
    save(checkpoint, identity, motion, recorder);
    throw core::Interrupted("interrupted in " + name + " at step " + std::to_string(motion.step) +
                            "; the same command with --resume goes on from there");
  }
}

/// One material; `name` is that of the run, for its checkpoint and for who waits.
inline MaterialResult pull(const Material& material, const std::string& name, const Params& params,
                           const Result& shared, core::ThreadPool& pool, const core::Monitor& monitor) {
  const simulation::Specimen& specimen = shared.specimen;
  const bond::LinearForces forces(bond::Beam<>({.materials = {material.micro}}), specimen.particles,
                                  specimen.network);
  particles::Inertia inertia = particles::solid_spheres(specimen.particles, std::vector{material.density});
  const integrate::Problem<bond::LinearForces> problem{forces, inertia, shared.setup.constraints};
  particles::Motion motion = particles::Motion::at_rest(specimen.particles.size());
  MaterialResult result;
  result.material = material;
  result.steady_from = params.convergence.interval;
  const bool moves = params.method == Method::verlet;
  if (moves) {
    result.critical = integrate::critical_time_step(forces, inertia);
    result.scaling =
        integrate::scale_density(forces, inertia, material.time_step, params.safety, params.scaling, pool);
    const auto k = core::index_of(params.axis);
    const double omega = integrate::first_axial_frequency(problem, specimen.particles, specimen.box.lower[k],
                                                          specimen.box.upper[k], params.axis, pool);
    result.first_frequency = omega;
    result.loading.ramp = params.ramp * 2 * std::numbers::pi / omega;
    if (params.steady_after)
      result.steady_from = static_cast<std::uint64_t>(
          std::ceil(*params.steady_after * 2 * std::numbers::pi / omega / material.time_step));
  }
  Recorder recorder(specimen.particles, specimen.network, shared.setup, problem, pool,
                    {.sample_every = params.sample_every,
                     .steady_from = result.steady_from,
                     .convergence = params.convergence});
  if (moves) {
    const integrate::VelocityVerlet verlet(
        {.time_step = material.time_step,
         .damping = integrate::Damping::of_mode(params.damping_ratio, result.first_frequency),
         .observe_every = params.observe_every,
         .loading = result.loading});
    march(verlet, problem, name, params, motion, recorder, pool, monitor);
    result.converged = recorder.converged();
  } else {
    const core::Monitor shown([&](const core::Progress& progress) {
      monitor.report({name, progress.fraction, progress.detail});
    });
    const auto method =
        params.method == Method::statics ? StaticSolver::Method::multigrid : StaticSolver::Method::relaxation;
    result.solver = StaticSolver{params.relative_residual, method}.solve(problem, motion, pool, shown);
    result.converged = true; // solve() throws where it does not
    const std::vector<double> reaction = integrate::static_reactions(problem, motion, pool);
    for (std::size_t c = 0; c < reaction.size(); ++c) // the work of a slow pull is half of force times way
      motion.energy.external_work += 0.5 * reaction[c] * problem.constraints.list()[c].rate;
    recorder.watch_equilibrium({motion, reaction});
  }

  result.moduli = recorder.moduli();
  result.samples = recorder.samples();
  result.strain = recorder.strain(motion);
  result.bond_forces = recorder.bond_forces(result.strain);
  result.force_fixed = recorder.force_fixed(result.strain);
  result.force_loaded = recorder.force_loaded(result.strain);
  result.moment_of_reactions = recorder.moment_of_reactions(result.strain);
  result.section = recorder.section();
  result.energy = integrate::energy_ledger(problem, motion, pool);
  result.stress = stress::LoveWeber<>(shared.tessellation)
                      .estimate(specimen.particles, specimen.network, result.bond_forces, pool);
  result.motion = std::move(motion);
  return result;
}

/// Packs and bonds: all that the materials share.
inline Result prepare(const Params& params, core::ThreadPool& pool, const core::Monitor& monitor) {
  auto [packing, loaded, reported] = make_packing(params, pool, monitor);
  simulation::Specimen specimen =
      simulation::make_specimen(packing.particles, packing.box, params.coordination, pool);
  const boundary::SymmetricTension tension{params.axis, params.velocity, specimen.gap()};
  auto setup = tension.apply(specimen.particles, specimen.network, specimen.box);
  Result result{packing.report,
                loaded,
                reported,
                std::move(specimen),
                std::move(setup),
                {},
                {},
                0,
                stress::tessellation::Hexahedra::holding(packing.box.without_periodicity(),
                                                         packing.particles.size(),
                                                         params.particles_per_specimen),
                {}};
  result.anisotropy = network::anisotropy(result.specimen.network);
  result.degrees = network::degree_histogram(result.specimen.network);
  result.outside_largest = network::clusters(result.specimen.network).outside_largest();
  return result;
}

} // namespace detail

/// Packs, bonds and pulls; every stage reports to the monitor.
inline Result run(const Params& params, const core::Monitor& monitor = {}) {
  params.validate();
  core::ThreadPool pool(params.threads);
  Result result = detail::prepare(params, pool, monitor);
  for (const Material& material : params.materials)
    result.materials.push_back(detail::pull(material, material.name, params, result, pool, monitor));
  return result;
}

} // namespace cdem::examples::rve_tension
