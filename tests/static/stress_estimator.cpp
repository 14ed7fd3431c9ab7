// Truth tables of the concepts StressEstimator, Tessellation and SmoothingKernel: the models, and near misses that lack
// one thing.

#include <cdem/stress/coarse_graining.hpp>
#include <cdem/stress/halo.hpp>
#include <cdem/stress/love_weber.hpp>
#include <cdem/stress/tessellation/polyhedra.hpp>
#include <cdem/stress/tessellation/tetrahedra.hpp>
#include <cdem/stress/tessellation/wedges.hpp>

#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace {

using cdem::Vec3;
using cdem::geometry::Segment;
using cdem::network::BondNetwork;
using cdem::particles::ParticleSet;
using cdem::stress::BondLoads;
using cdem::stress::CoarseGraining;
using cdem::stress::EstimatesCoupleStress;
using cdem::stress::Halo;
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
static_assert(StressEstimator<LoveWeber<Wedges>> && EstimatesCoupleStress<LoveWeber<Wedges>>);
static_assert(StressEstimator<LoveWeber<Tetrahedra>> && EstimatesCoupleStress<LoveWeber<Tetrahedra>>);
static_assert(StressEstimator<LoveWeber<Polyhedra>> && EstimatesCoupleStress<LoveWeber<Polyhedra>>);
static_assert(StressEstimator<Halo> && EstimatesCoupleStress<Halo>);
static_assert(StressEstimator<CoarseGraining<>> && EstimatesCoupleStress<CoarseGraining<>>);
static_assert(!StressEstimator<TakesVector>);
static_assert(!StressEstimator<NotConst>);
static_assert(!StressEstimator<ReturnsTensors>);
static_assert(!StressEstimator<WritesForces>);
static_assert(!StressEstimator<ForgetsParticles>);
static_assert(!StressEstimator<OtherName>);
static_assert(!StressEstimator<Hexahedra>);
static_assert(!StressEstimator<int>);

struct TakesLoads { // and so forces alone, too
  StressField estimate(const ParticleSet&, const BondNetwork&, const BondLoads&) const;
};
struct ReturnsNothing {
  void estimate(const ParticleSet&, const BondNetwork&, const BondLoads&) const;
};
static_assert(StressEstimator<TakesLoads> && EstimatesCoupleStress<TakesLoads>);
static_assert(!EstimatesCoupleStress<Smallest>); // forces alone: an estimator all the same
static_assert(!EstimatesCoupleStress<ReturnsNothing> && !StressEstimator<ReturnsNothing>);
static_assert(std::convertible_to<std::vector<Vec3>, BondLoads>);
static_assert(std::convertible_to<std::span<const Vec3>, BondLoads>);
static_assert(!std::convertible_to<std::vector<double>, BondLoads>);
static_assert(!std::convertible_to<int, BondLoads>);

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
static_assert(Tessellation<Hexahedra> && Tessellation<Wedges> && Tessellation<Tetrahedra>);
static_assert(Tessellation<Polyhedra>);
static_assert(!Tessellation<cdem::geometry::Mesh>);
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

// ---- SmoothingKernel
// ------------------------------------------------------------------------------------------

using namespace cdem::stress;

struct Tent {
  double reach() const;
  double density(double) const;
  double integral(double, double, double) const;
  double first_moment(double, double, double) const;
};
struct WithoutReach : private Tent {
  using Tent::density, Tent::first_moment, Tent::integral;
};
struct IntegratesOneEnd : Tent {
  double integral(double, double) const;
};
struct WithoutMoment : private Tent {
  using Tent::density, Tent::integral, Tent::reach;
};
struct DensityOfInteger : Tent {
  int density(double) const;
};

static_assert(SmoothingKernel<Lucy> && SmoothingKernel<Gaussian> && SmoothingKernel<Tent>);
static_assert(!SmoothingKernel<WithoutReach> && !HasReach<WithoutReach> && GivesDensity<WithoutReach>);
static_assert(!SmoothingKernel<IntegratesOneEnd> && !IntegratesAlongLines<IntegratesOneEnd>);
static_assert(!SmoothingKernel<WithoutMoment> && !IntegratesAlongLines<WithoutMoment>);
static_assert(!SmoothingKernel<DensityOfInteger> && !GivesDensity<DensityOfInteger>);
static_assert(!SmoothingKernel<double>);

template <class Kernel>
concept FitsCoarseGraining = requires {
  typename CoarseGraining<Kernel>;
};
static_assert(FitsCoarseGraining<Tent> && !FitsCoarseGraining<WithoutMoment>);

} // namespace
