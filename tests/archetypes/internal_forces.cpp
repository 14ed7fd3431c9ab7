// The least that internal forces are, through every template that takes them: what compiles here asks no more of
// them than the concept does.

#include <cdem/integrate/critical_time_step.hpp>
#include <cdem/integrate/velocity_verlet.hpp>

namespace {

using namespace cdem;
using Field = particles::SpatialField<>;

struct Count { // not a number: only converts to one
  operator std::size_t() const { return 2; }
};

/// Two particles, each tied to its place.
class Ties {
public:
  Ties() = default;
  Ties(const Ties&) = delete; // a problem refers to its forces
  Ties& operator=(const Ties&) = delete;
  Count particle_count() const { return {}; }
  void evaluate(const Field& displacement, Field& force, core::ThreadPool&) const {
    for (std::size_t i = 0; i < 2; ++i)
      for (int dof = 0; dof < 6; ++dof)
        force[i][dof] = -displacement[i][dof];
  }
  double elastic_energy(const Field& displacement, core::ThreadPool&) const {
    double sum = 0;
    for (const auto& entry : displacement)
      sum += 0.5 * (entry.linear().squaredNorm() + entry.angular().squaredNorm());
    return sum;
  }
  Eigen::Matrix<double, 6, 6> diagonal_block(ParticleIndex) const {
    return Eigen::Matrix<double, 6, 6>::Identity();
  }
};

static_assert(integrate::InternalForces<Ties>);

} // namespace

template struct cdem::integrate::Problem<Ties>;
template cdem::integrate::CriticalTimeStep
cdem::integrate::critical_time_step<Ties>(const Ties&, const cdem::particles::Inertia&);
template double cdem::integrate::largest_frequency<Ties>(const Problem<Ties>&, cdem::core::ThreadPool&,
                                                         double, int);
template cdem::integrate::EnergyLedger cdem::integrate::energy_ledger<Ties>(const Problem<Ties>&,
                                                                            const cdem::particles::Motion&,
                                                                            cdem::core::ThreadPool&);
template std::vector<double> cdem::integrate::static_reactions<Ties>(const Problem<Ties>&,
                                                                     const cdem::particles::Motion&,
                                                                     cdem::core::ThreadPool&);
template cdem::integrate::VelocityVerlet::Report
cdem::integrate::VelocityVerlet::run<Ties>(const Problem<Ties>&, cdem::particles::Motion&, std::uint64_t,
                                           cdem::core::ThreadPool&, cdem::integrate::NoObserver&&,
                                           const cdem::core::Monitor&) const;
