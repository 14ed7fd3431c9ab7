// The least that an integrator is, of each kind, used by what a caller may do with any of them.

#include <cdem/bond/linear_forces.hpp>
#include <cdem/integrate/integrator.hpp>

namespace archetype {

using namespace cdem;
using integrate::InternalForces;
using integrate::Problem;
using particles::Motion;

class Advancing {
public:
  struct Parameters {};
  struct Report {};
  Advancing() = delete;
  explicit Advancing(Parameters) {}
  template <InternalForces F>
  Report run(const Problem<F>&, Motion&, std::uint64_t, core::ThreadPool&) const {
    return {};
  }
};

class Solving {
public:
  struct Parameters {};
  struct Report {};
  Solving() = delete;
  explicit Solving(Parameters) {}
  template <InternalForces F>
  Report solve(const Problem<F>&, Motion&, core::ThreadPool&) const {
    return {};
  }
};

static_assert(integrate::Integrator<Advancing> && integrate::Integrator<Solving>);

template <integrate::Integrator I, InternalForces F>
typename I::Report move(const typename I::Parameters& parameters, const Problem<F>& problem, Motion& motion,
                        core::ThreadPool& pool) {
  const I integrator(parameters);
  if constexpr (integrate::AdvancesMotion<I>)
    return integrator.run(problem, motion, 1, pool);
  else
    return integrator.solve(problem, motion, pool);
}

template Advancing::Report move<Advancing, bond::LinearForces>(const Advancing::Parameters&,
                                                               const Problem<bond::LinearForces>&, Motion&,
                                                               core::ThreadPool&);
template Solving::Report move<Solving, bond::LinearForces>(const Solving::Parameters&,
                                                           const Problem<bond::LinearForces>&, Motion&,
                                                           core::ThreadPool&);

} // namespace archetype
