// A generator that cannot pack is refused where it is declared to be one, and the missing part is named.
//
// expect: Packs
// expect: generator\.pack\(monitor\)

#include <cdem/packing/packing_generator.hpp>

struct Report {
  double density;
};

class Generator {
public:
  struct Parameters {};
  using Report = ::Report;
  explicit Generator(Parameters) {}
#ifdef CDEM_REPAIRED
  cdem::packing::Packing<Report> pack(const cdem::core::Monitor&) {
    return {};
  }
#endif
};

static_assert(cdem::packing::PackingGenerator<Generator>); // refused here
