// Who is a packing generator and who only looks like one.

#include <cdem/packing/lubachevsky_stillinger.hpp>

namespace {

using namespace cdem;
using packing::HasDensityReport;
using packing::HasParameters;
using packing::Packing;
using packing::PackingGenerator;
using packing::Packs;

static_assert(PackingGenerator<packing::LubachevskyStillinger>);

struct DensityReport {
  double density;
};

struct Smallest {
  struct Parameters {};
  using Report = DensityReport;
  explicit Smallest(Parameters);
  Packing<Report> pack(const core::Monitor&);
};
static_assert(PackingGenerator<Smallest>);

struct DensityInSinglePrecision { // converts to double
  struct Parameters {};
  struct Report {
    float density;
  };
  explicit DensityInSinglePrecision(const Parameters&);
  Packing<Report> pack(const core::Monitor&) const;
};
static_assert(PackingGenerator<DensityInSinglePrecision>);

// Near misses, each short of one thing.

struct NoParameters {
  using Report = DensityReport;
  Packing<Report> pack(const core::Monitor&);
};
static_assert(!PackingGenerator<NoParameters>);
static_assert(!HasParameters<NoParameters> && HasDensityReport<NoParameters> && Packs<NoParameters>);

struct NotMadeFromItsParameters {
  struct Parameters {};
  using Report = DensityReport;
  Packing<Report> pack(const core::Monitor&);
};
static_assert(!PackingGenerator<NotMadeFromItsParameters>);
static_assert(!HasParameters<NotMadeFromItsParameters> && Packs<NotMadeFromItsParameters>);

struct NoReport {
  struct Parameters {};
  explicit NoReport(Parameters);
  Packing<DensityReport> pack(const core::Monitor&);
};
static_assert(!PackingGenerator<NoReport>);
static_assert(HasParameters<NoReport> && !HasDensityReport<NoReport> && !Packs<NoReport>);

struct ReportWithoutDensity {
  struct Parameters {};
  struct Report {
    double pressure;
  };
  explicit ReportWithoutDensity(Parameters);
  Packing<Report> pack(const core::Monitor&);
};
static_assert(!PackingGenerator<ReportWithoutDensity>);
static_assert(!HasDensityReport<ReportWithoutDensity> && Packs<ReportWithoutDensity>);

struct PacksInSilence { // takes no monitor
  struct Parameters {};
  using Report = DensityReport;
  explicit PacksInSilence(Parameters);
  Packing<Report> pack();
};
static_assert(!PackingGenerator<PacksInSilence>);
static_assert(HasParameters<PacksInSilence> && HasDensityReport<PacksInSilence> && !Packs<PacksInSilence>);

struct ChangesTheMonitor { // a monitor is lent for reading
  struct Parameters {};
  using Report = DensityReport;
  explicit ChangesTheMonitor(Parameters);
  Packing<Report> pack(core::Monitor&);
};
static_assert(!PackingGenerator<ChangesTheMonitor> && !Packs<ChangesTheMonitor>);

struct ReturnsBareParticles {
  struct Parameters {};
  using Report = DensityReport;
  explicit ReturnsBareParticles(Parameters);
  particles::ParticleSet pack(const core::Monitor&);
};
static_assert(!PackingGenerator<ReturnsBareParticles> && !Packs<ReturnsBareParticles>);

struct ReportsOtherwise { // the packing's report is not the generator's
  struct Parameters {};
  using Report = DensityReport;
  struct Other {
    double density;
  };
  explicit ReportsOtherwise(Parameters);
  Packing<Other> pack(const core::Monitor&);
};
static_assert(!PackingGenerator<ReportsOtherwise> && !Packs<ReportsOtherwise>);

static_assert(!PackingGenerator<int> && !PackingGenerator<void>);

} // namespace
