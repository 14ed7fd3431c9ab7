// The least that a law of each kind is, through forces, their tangent, every integrator and check_law: what compiles
// here asks no more of a law than the concept does.

#include <cdem/bond/bond_forces.hpp>
#include <cdem/bond/check_law.hpp>
#include <cdem/integrate/dynamic_relaxation.hpp>
#include <cdem/integrate/static_multigrid.hpp>
#include <cdem/integrate/velocity_verlet.hpp>

namespace {

using namespace cdem;
using bond::BondGeometry;
using bond::Deformation;

/// What every law is: it can be copied, and looks at the particles.
struct Least {
  Least() = delete;
  explicit Least(int) {}
  Least(const Least&) = default;
  Least& operator=(const Least&) = delete;
  void validate(const particles::ParticleSet&) const {}
};

struct Block : Least {
  using Least::Least;
  bond::Matrix12 stiffness(const BondGeometry&) const { return bond::Matrix12::Zero(); }
};

struct Force : Least {
  using Least::Least;
  bond::ChannelLoad<> load(const BondGeometry&, const Deformation<>&) const { return {}; }
  double energy(const BondGeometry&, const Deformation<>&) const { return 0; }
};

/// No arithmetic on what is prepared or remembered: it is handed on.
struct Energy : Least {
  using Least::Least;
  struct Kept {
    Kept() = delete;
    explicit Kept(double k) : stiffness(k) {}
    double stiffness;
  };
  struct State {
    double longest = 0;
  };
  Kept prepare(const BondGeometry& geometry) const { return Kept(1 / geometry.length); }
  template <class Real>
  Real energy(const Kept& kept, const Deformation<Real>& d, const State&) const {
    return kept.stiffness * d.stretch * d.stretch;
  }
  void update(const Kept&, const Deformation<>& d, State& state) const {
    state.longest = d.stretch > state.longest ? d.stretch : state.longest;
  }
};

static_assert(bond::BondLaw<Block> && bond::BondLaw<Force> && bond::BondLaw<Energy>);

template <class Law>
void through_everything(const Law& law, const particles::ParticleSet& particles,
                        const network::BondNetwork& network, const particles::Inertia& inertia,
                        particles::Motion& motion, core::ThreadPool& pool) {
  bond::BondForces<Law> forces(law, particles, network);
  const particles::Constraints constraints;
  const integrate::Problem<bond::BondForces<Law>> problem{forces, inertia, constraints};
  integrate::VelocityVerlet({.time_step = 1}).run(problem, motion, 1, pool);
  integrate::DynamicRelaxation().solve(problem, motion, pool);
  integrate::StaticMultigrid().solve(problem, motion, pool);
  integrate::critical_time_step(forces, inertia);
  integrate::energy_ledger(problem, motion, pool);
  if constexpr (bond::HasState<Law>) // once is enough
    bond::check_law(law);
}

} // namespace

template class cdem::bond::BondForces<Energy>;

void compile_all(const particles::ParticleSet& particles, const network::BondNetwork& network,
                 const particles::Inertia& inertia, particles::Motion& motion, core::ThreadPool& pool) {
  through_everything(Block(1), particles, network, inertia, motion, pool);
  through_everything(Force(1), particles, network, inertia, motion, pool);
  through_everything(Energy(1), particles, network, inertia, motion, pool);
}
