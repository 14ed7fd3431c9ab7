// An integrator that advances a motion but accounts for nothing is refused, and the missing part is named.
//
// expect: HasParametersAndReport
// expect: Report

#include <cdem/integrate/integrator.hpp>

#include <cstdint>

class Integrator {
public:
  struct Parameters {};
#ifdef CDEM_REPAIRED
  struct Report {};
#else
  struct Account {};
  using Result = Account;
#endif
  explicit Integrator(Parameters) {}
  template <class Problem>
#ifdef CDEM_REPAIRED
  Report
#else
  Result
#endif
  run(const Problem&, cdem::particles::Motion&, std::uint64_t, cdem::core::ThreadPool&) const {
    return {};
  }
};

static_assert(cdem::integrate::Integrator<Integrator>); // refused here
