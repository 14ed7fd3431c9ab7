// The least that a stress estimator is, used by what a caller may do with any of them.

#include <cdem/stress/stress_estimator.hpp>

namespace archetype {

using namespace cdem;

class Estimator {
public:
  Estimator(const Estimator&) = delete; // nothing copies it
  stress::StressField estimate(const particles::ParticleSet&, const network::BondNetwork&,
                               std::span<const Vec3>) const {
    return {};
  }
};

static_assert(stress::StressEstimator<Estimator>);

template <stress::StressEstimator E>
Mat3 moment_of(const E& estimator, const particles::ParticleSet& particles,
               const network::BondNetwork& network, const std::vector<Vec3>& forces) {
  const stress::StressField field = estimator.estimate(particles, network, forces);
  Mat3 moment = field.outside;
  for (std::size_t cell = 0; cell < field.size(); ++cell)
    moment += field.volume[cell] * field.stress[cell];
  return moment;
}

template Mat3 moment_of<Estimator>(const Estimator&, const particles::ParticleSet&,
                                   const network::BondNetwork&, const std::vector<Vec3>&);

} // namespace archetype
