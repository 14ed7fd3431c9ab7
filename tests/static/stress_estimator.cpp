// Truth tables of the concepts StressEstimator and Tessellation: the models, and near misses that lack one
// thing.

#include <cdem/stress/love_weber.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace {

using cdem::Vec3;
using cdem::geometry::Segment;
using cdem::network::BondNetwork;
using cdem::particles::ParticleSet;
using cdem::stress::LoveWeber;
using cdem::stress::StressEstimator;
using cdem::stress::StressField;
using namespace cdem::stress::tessellation;

// ---- StressEstimator
// ------------------------------------------------------------------------------------------

struct Smallest {
  StressField estimate(const ParticleSet&, const BondNetwork&, std::span<const Vec3>) const;
};
struct TakesVector { // a vector is made from a span by no conversion
  StressField estimate(const ParticleSet&, const BondNetwork&, const std::vector<Vec3>&) const;
};
struct NotConst {
  StressField estimate(const ParticleSet&, const BondNetwork&, std::span<const Vec3>);
};
struct ReturnsTensors {
  std::vector<cdem::Mat3> estimate(const ParticleSet&, const BondNetwork&, std::span<const Vec3>) const;
};
struct WritesForces {
  StressField estimate(const ParticleSet&, const BondNetwork&, std::span<Vec3>) const;
};
struct ForgetsParticles {
  StressField estimate(const BondNetwork&, std::span<const Vec3>) const;
};
struct OtherName {
  StressField stress(const ParticleSet&, const BondNetwork&, std::span<const Vec3>) const;
};

static_assert(StressEstimator<Smallest>);
static_assert(StressEstimator<LoveWeber<>>);
static_assert(StressEstimator<LoveWeber<Hexahedra>>);
static_assert(!StressEstimator<TakesVector>);
static_assert(!StressEstimator<NotConst>);
static_assert(!StressEstimator<ReturnsTensors>);
static_assert(!StressEstimator<WritesForces>);
static_assert(!StressEstimator<ForgetsParticles>);
static_assert(!StressEstimator<OtherName>);
static_assert(!StressEstimator<Hexahedra>);
static_assert(!StressEstimator<int>);

// ---- Tessellation
// ---------------------------------------------------------------------------------------------

struct Whole {
  std::size_t cell_count() const;
  double volume(std::size_t) const;
  std::optional<std::size_t> locate(const Vec3&) const;
  template <class Callback>
  double for_each_piece(const Segment&, Callback&&) const;
};
struct LosesTheOutside : Whole { // hides the part outside: nothing is returned
  template <class Callback>
  void for_each_piece(const Segment&, Callback&&) const;
};
struct LocatesByNumber : Whole { // a number for a point that lies in no cell
  int locate(const Vec3&) const;
};
struct OneVolume : Whole {
  double volume() const;
};
struct CountNotConst : Whole {
  std::size_t cell_count();
};
struct CallbackWithoutEnd : Whole {
  double for_each_piece(const Segment&, void (*)(std::size_t, double)) const;
};

static_assert(Tessellation<Whole>);
static_assert(Tessellation<Hexahedra>);
static_assert(StressEstimator<LoveWeber<Whole>>);
static_assert(!Tessellation<LosesTheOutside> && !CutsSegments<LosesTheOutside>);
static_assert(HasCells<LosesTheOutside> && LocatesPoints<LosesTheOutside>);
static_assert(!Tessellation<LocatesByNumber> && !LocatesPoints<LocatesByNumber>);
static_assert(!Tessellation<OneVolume> && !HasCells<OneVolume>);
static_assert(!Tessellation<CountNotConst> && !HasCells<CountNotConst>);
static_assert(!Tessellation<CallbackWithoutEnd> && !CutsSegments<CallbackWithoutEnd>);
static_assert(!Tessellation<cdem::geometry::Box>);

template <class Cells>
concept FitsLoveWeber = requires {
  typename LoveWeber<Cells>;
};
static_assert(FitsLoveWeber<Whole>);
static_assert(!FitsLoveWeber<LosesTheOutside>);

} // namespace
