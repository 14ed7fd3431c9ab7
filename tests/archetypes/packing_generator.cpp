// The least that a packing generator is, with the template that it returns.

#include <cdem/packing/packing_generator.hpp>
#include <cdem/packing/tiled.hpp>

namespace archetype {

struct Density { // not a number: only converts to one
  operator double() const { return 0.5; }
};

struct ReportOfGenerator {
  Density density;
};

class Generator {
public:
  struct Parameters {};
  using Report = ReportOfGenerator;
  Generator() = delete;
  explicit Generator(Parameters) {}
  cdem::packing::Packing<Report> pack(const cdem::core::Monitor&) { return {}; }
};

static_assert(cdem::packing::PackingGenerator<Generator>);

/// What a caller may do with any generator.
template <cdem::packing::PackingGenerator G>
double density_of(const typename G::Parameters& parameters) {
  G generator(parameters);
  const cdem::packing::Packing<typename G::Report> packing = generator.pack(cdem::core::Monitor{});
  return packing.report.density + packing.particles.solid_volume() / packing.box.volume();
}

template double density_of<Generator>(const Generator::Parameters&);

} // namespace archetype

template struct cdem::packing::Packing<archetype::ReportOfGenerator>;
template class cdem::packing::Tiled<archetype::Generator>;
