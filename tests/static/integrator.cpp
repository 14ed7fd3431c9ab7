// Who is an integrator, who gives internal forces, and who only looks like one.

#include <cdem/bond/linear_forces.hpp>
#include <cdem/integrate/integrator.hpp>
#include <cdem/integrate/velocity_verlet.hpp>

namespace {

using namespace cdem;
using core::ThreadPool;
using integrate::Integrator;
using integrate::InternalForces;
using integrate::Problem;
using particles::Motion;
using Field = particles::SpatialField<>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// ---- InternalForces

static_assert(InternalForces<bond::LinearForces>);

struct Smallest {
  unsigned particle_count() const; // whatever converts to a number
  void evaluate(const Field&, Field&, ThreadPool&) const;
  float elastic_energy(const Field&, ThreadPool&) const;
  Matrix6 diagonal_block(ParticleIndex) const;
};
static_assert(InternalForces<Smallest>);

// Near misses, each short of one thing.

struct EvaluateNotConst : Smallest { // shared by threads: must be const
  void evaluate(const Field&, Field&, ThreadPool&);
};
static_assert(!InternalForces<EvaluateNotConst> && !integrate::EvaluatesForces<EvaluateNotConst>);
static_assert(integrate::KnowsParticleCount<EvaluateNotConst>);

struct EvaluateReturnsForces : Smallest {
  Field evaluate(const Field&, ThreadPool&) const;
};
static_assert(!integrate::EvaluatesForces<EvaluateReturnsForces>);

struct EvaluateChangesDisplacement : Smallest {
  void evaluate(Field&, Field&, ThreadPool&) const;
};
static_assert(!integrate::EvaluatesForces<EvaluateChangesDisplacement>);

struct EnergyWithoutPool : Smallest {
  double elastic_energy(const Field&) const;
};
static_assert(!InternalForces<EnergyWithoutPool> && !integrate::GivesElasticEnergy<EnergyWithoutPool>);

struct NoEnergy {
  std::size_t particle_count() const;
  void evaluate(const Field&, Field&, ThreadPool&) const;
  Matrix6 diagonal_block(ParticleIndex) const;
};
static_assert(!InternalForces<NoEnergy> && integrate::GivesDiagonalBlock<NoEnergy>);

struct TranslationsOnly : Smallest {
  Mat3 diagonal_block(ParticleIndex) const;
};
static_assert(!InternalForces<TranslationsOnly> && !integrate::GivesDiagonalBlock<TranslationsOnly>);

struct CountNotConst : Smallest {
  std::size_t particle_count();
};
static_assert(!InternalForces<CountNotConst> && !integrate::KnowsParticleCount<CountNotConst>);

static_assert(!InternalForces<int>);

template <class F>
concept FitsProblem = requires {
  typename Problem<F>;
};
static_assert(FitsProblem<Smallest> && !FitsProblem<NoEnergy>);

// ---- Integrator

static_assert(Integrator<integrate::VelocityVerlet>);
static_assert(integrate::AdvancesMotion<integrate::VelocityVerlet>);
static_assert(!integrate::SolvesStatics<integrate::VelocityVerlet>);

struct Parts {
  struct Parameters {};
  struct Report {};
};

struct Advances : Parts {
  explicit Advances(Parameters);
  template <InternalForces F>
  Report run(const Problem<F>&, Motion&, std::uint64_t, ThreadPool&) const;
};
static_assert(Integrator<Advances> && !integrate::SolvesStatics<Advances>);

struct Solves : Parts {
  explicit Solves(Parameters);
  template <InternalForces F>
  Report solve(const Problem<F>&, Motion&, ThreadPool&) const;
};
static_assert(Integrator<Solves> && !integrate::AdvancesMotion<Solves>);

struct NotMadeFromParameters : Parts {
  template <InternalForces F>
  Report run(const Problem<F>&, Motion&, std::uint64_t, ThreadPool&) const;
  explicit NotMadeFromParameters(double);
};
static_assert(!Integrator<NotMadeFromParameters> && integrate::AdvancesMotion<NotMadeFromParameters>);

struct NoReport {
  struct Parameters {};
  explicit NoReport(Parameters);
  template <InternalForces F>
  void run(const Problem<F>&, Motion&, std::uint64_t, ThreadPool&) const;
};
static_assert(!Integrator<NoReport> && !integrate::HasParametersAndReport<NoReport>);

struct ReportsOtherwise : Parts {
  explicit ReportsOtherwise(Parameters);
  template <InternalForces F>
  bool run(const Problem<F>&, Motion&, std::uint64_t, ThreadPool&) const;
};
static_assert(!Integrator<ReportsOtherwise> && integrate::HasParametersAndReport<ReportsOtherwise>);

struct RunNotConst : Parts {
  explicit RunNotConst(Parameters);
  template <InternalForces F>
  Report run(const Problem<F>&, Motion&, std::uint64_t, ThreadPool&);
};
static_assert(!Integrator<RunNotConst>);

struct OneLawOnly : Parts { // an integrator is not written for one kind of forces
  explicit OneLawOnly(Parameters);
  Report run(const Problem<bond::LinearForces>&, Motion&, std::uint64_t, ThreadPool&) const;
};
static_assert(!Integrator<OneLawOnly>);

struct Idle : Parts {
  explicit Idle(Parameters);
};
static_assert(!Integrator<Idle>);
static_assert(!Integrator<int>);

} // namespace
