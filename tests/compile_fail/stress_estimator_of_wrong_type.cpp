// A stress estimator that returns bare tensors, without volumes, is refused, and what it must do is named.
//
// expect: EstimatesStress
// expect: estimator\.estimate\(particles, network, forces\)

#include <cdem/stress/stress_estimator.hpp>

#include <span>
#include <vector>

struct Estimator {
#ifdef CDEM_REPAIRED
  using Field = cdem::stress::StressField;
#else
  using Field = std::vector<cdem::Mat3>;
#endif
  Field estimate(const cdem::particles::ParticleSet&, const cdem::network::BondNetwork&,
                 std::span<const cdem::Vec3>) const {
    return {};
  }
};

static_assert(cdem::stress::StressEstimator<Estimator>); // refused here
