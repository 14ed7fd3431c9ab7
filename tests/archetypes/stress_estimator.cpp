// The least that a stress estimator, a tessellation and a kernel are, used by what a caller may do with any of them.

#include <cdem/stress/coarse_graining.hpp>
#include <cdem/stress/love_weber.hpp>
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

// One that reads the moments is handed forces alone just as well.
class CoupleEstimator {
public:
  CoupleEstimator(const CoupleEstimator&) = delete;
  stress::StressField estimate(const particles::ParticleSet&, const network::BondNetwork&,
                               const stress::BondLoads&) const {
    return {};
  }
};

static_assert(stress::StressEstimator<CoupleEstimator> && stress::EstimatesCoupleStress<CoupleEstimator>);
template Mat3 moment_of<CoupleEstimator>(const CoupleEstimator&, const particles::ParticleSet&,
                                         const network::BondNetwork&, const std::vector<Vec3>&);

// Only what the concepts name, and moves.
struct Cells {
  Cells(Cells&&) = default;
  std::size_t cell_count() const { return 1; }
  double volume(std::size_t) const { return 1; }
  std::optional<std::size_t> locate(const Vec3&) const { return 0; }
  template <class Callback>
  double for_each_piece(const geometry::Segment&, Callback&& callback) const {
    callback(std::size_t{0}, 0.0, 1.0);
    return 0;
  }
};

struct Kernel {
  Kernel(Kernel&&) = default;
  double reach() const { return 1; }
  double density(double) const { return 1; }
  double integral(double begin, double end, double) const { return end - begin; }
  double first_moment(double, double, double) const { return 0; }
};

} // namespace archetype

template class cdem::stress::LoveWeber<archetype::Cells>;
template class cdem::stress::CoarseGraining<archetype::Kernel>;
