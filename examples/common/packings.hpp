#pragma once

// Where an example's packing comes from: a file given, the cache of those made before, or the generator.

#include <cdem/core/parallel.hpp>
#include <cdem/io/csv.hpp>
#include <cdem/io/from_file.hpp>
#include <cdem/io/output_directory.hpp>
#include <cdem/packing/lubachevsky_stillinger.hpp>
#include <cdem/packing/soft_spheres.hpp>

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <map>
#include <mutex>
#include <sstream>
#include <string>
#include <vector>

namespace cdem::examples {

/// What the options say of the packing.
struct PackingSource {
  std::filesystem::path file = {};  ///< --packing: read instead of packed; empty: none
  std::filesystem::path cache = {}; ///< folder in which packings are kept; empty: nothing is kept
};

/// What a generator is called in the cache, with a number that is raised when the same parameters give another packing.
template <class Generator>
struct GeneratorTraits;

template <>
struct GeneratorTraits<packing::LubachevskyStillinger> {
  using Generator = packing::LubachevskyStillinger;
  static constexpr const char* name = "lubachevsky_stillinger";
  static constexpr int generation = 2;

  /// Names every parameter that the packing depends on.
  template <class Visit>
  static void visit_parameters(const Generator::Parameters& p, Visit&& visit) {
    visit("particles", p.particles);
    visit("density", p.density);
    visit("cov", p.cov);
    visit("truncation", p.truncation);
    visit("smallest_radius", p.smallest_radius);
    visit("growth_rate", p.growth_rate);
    visit("fluid_growth_rate", p.fluid_growth_rate);
    visit("late_growth_rate", p.late_growth_rate);
    visit("late_pressure", p.late_pressure);
    visit("pressure_limit", p.pressure_limit);
    visit("side", p.side);
    visit("boundary", p.boundary == packing::Boundary::periodic ? "periodic" : "walls");
    visit("seed", p.seed);
  }

  /// Names what is kept of the report; the numbers of events are left out.
  template <class Report, class Visit>
  static void visit_report(Report& r, Visit&& visit) {
    visit("reason", r.reason);
    visit("wanted_density", r.wanted_density);
    visit("density", r.density);
    visit("pressure", r.pressure);
    visit("collisions", r.collisions);
    visit("collisions_per_particle", r.collisions_per_particle);
    visit("wall_seconds", r.wall_seconds);
    visit("largest_overlap", r.largest_overlap);
    visit("contact_tolerance", r.contact_tolerance);
    visit("rattlers", r.rattlers);
    visit("contact_number", r.contact_number);
    visit("mean_radius", r.mean_radius);
    visit("cov", r.cov);
  }

  /// The part of the file's name that a person reads.
  static std::string label(const Generator::Parameters& p) {
    return std::to_string(p.particles) + "-density" + core::to_text(p.density) + "-cov" +
           core::to_text(p.cov) + "-growth" + core::to_text(p.growth_rate) +
           (p.boundary == packing::Boundary::periodic ? "-periodic" : "-walls") + "-seed" +
           std::to_string(p.seed);
  }
};

template <>
struct GeneratorTraits<packing::SoftSpheres> {
  using Generator = packing::SoftSpheres;
  static constexpr const char* name = "soft_spheres";
  static constexpr int generation = 2;

  /// Names every parameter that the packing depends on; the number of threads is none.
  template <class Visit>
  static void visit_parameters(const Generator::Parameters& p, Visit&& visit) {
    visit("particles", p.particles);
    visit("target", p.target);
    visit("density", p.density);
    visit("contact_number", p.contact_number);
    visit("cov", p.cov);
    visit("truncation", p.truncation);
    visit("smallest_radius", p.smallest_radius);
    visit("compression", p.compression);
    visit("jamming_overlap", p.jamming_overlap);
    visit("tolerance", p.tolerance);
    visit("most_evaluations", p.most_evaluations);
    visit("side", p.side);
    visit("boundary", p.boundary == packing::Boundary::periodic ? "periodic" : "walls");
    visit("seed", p.seed);
  }

  /// Names what is kept of the report.
  template <class Report, class Visit>
  static void visit_report(Report& r, Visit&& visit) {
    visit("target", r.target);
    visit("wanted", r.wanted);
    visit("found", r.found);
    visit("balanced", r.balanced);
    visit("density", r.density);
    visit("jamming_density", r.jamming_density);
    visit("contact_number", r.contact_number);
    visit("rattlers", r.rattlers);
    visit("residual", r.residual);
    visit("largest_residual", r.largest_residual);
    visit("pressure", r.pressure);
    visit("mean_overlap", r.mean_overlap);
    visit("largest_overlap", r.largest_overlap);
    visit("evaluations", r.evaluations);
    visit("wall_seconds", r.wall_seconds);
    visit("mean_radius", r.mean_radius);
    visit("cov", r.cov);
  }

  static std::string label(const Generator::Parameters& p) {
    return std::to_string(p.particles) + "-density" + core::to_text(p.density) + "-cov" +
           core::to_text(p.cov) + (p.boundary == packing::Boundary::periodic ? "-periodic" : "-walls") +
           "-seed" + std::to_string(p.seed);
  }
};

namespace detail {

/// Lines `name = value` that read back to the same numbers; an enumeration is its number.
class Lines {
public:
  template <class Value>
  void operator()(const char* name, const Value& value) {
    text += std::string(name) + " = ";
    if constexpr (std::is_enum_v<Value>)
      text += io::number_to_text(static_cast<int>(value));
    else if constexpr (std::is_arithmetic_v<Value>)
      text += io::number_to_text(value);
    else
      text += value;
    text += '\n';
  }
  std::string text;
};

/// Takes the values back out of such lines; what is missing there stays as it is.
class LineValues {
public:
  explicit LineValues(const std::string& text) {
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);)
      if (const auto at = line.find(" = "); at != line.npos)
        values_[line.substr(0, at)] = line.substr(at + 3);
  }
  template <class Value>
  void operator()(const char* name, Value& value) const {
    const auto found = values_.find(name);
    if (found == values_.end())
      return;
    if constexpr (std::is_same_v<Value, bool>)
      value = found->second == "1";
    else if constexpr (std::is_enum_v<Value>)
      value = static_cast<Value>(io::detail::number_in<int>(found->second).value_or(0));
    else
      value = io::detail::number_in<Value>(found->second).value_or(value);
  }

private:
  std::map<std::string, std::string> values_;
};

/// FNV-1a.
inline std::uint64_t hash_of(std::string_view text) {
  std::uint64_t value = 0xcbf29ce484222325U;
  for (const char c : text)
    value = (value ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return value;
}

inline std::string in_hexadecimal(std::uint64_t value) {
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(value));
  return digits.data();
}

} // namespace detail

/// A text that two runs share only if they have the same packing: every parameter, or the content of the file given.
/// @throws core::FileError if the file given cannot be read
template <class Generator>
std::string packing_identity(const typename Generator::Parameters& parameters, const PackingSource& source) {
  if (!source.file.empty())
    return "file = " + detail::in_hexadecimal(detail::hash_of(io::detail::whole_file(source.file))) + '\n';
  detail::Lines lines;
  lines("generator", GeneratorTraits<Generator>::name);
  lines("generation", GeneratorTraits<Generator>::generation);
  GeneratorTraits<Generator>::visit_parameters(parameters, lines);
  return lines.text;
}

/// Where the cache keeps the packing of these parameters: what a person reads, then a number for all the rest.
template <class Generator>
std::filesystem::path cached_packing(const typename Generator::Parameters& parameters,
                                     const PackingSource& source) {
  const std::string identity = packing_identity<Generator>(parameters, {});
  return source.cache / (std::string(GeneratorTraits<Generator>::name) + "-" +
                         GeneratorTraits<Generator>::label(parameters) + "-" +
                         detail::in_hexadecimal(detail::hash_of(identity)).substr(0, 8) + ".cdem");
}

/// A packing and how it was come by.
template <class Generator>
struct ObtainedPacking {
  packing::Packing<typename Generator::Report>
      packing;          ///< the report of a file given holds the density alone
  bool loaded = false;  ///< from the file given or the cache
  bool reported = true; ///< whether there is a generator's report
};

/// The packing: read from the file given, else from the cache, else made and kept there. A file of the cache that is damaged
/// or belongs to other parameters is named on stderr, and made anew.
/// @param judge  called with the report of a packing that was made or kept; throws if it will not do, before it is kept
/// @param pool   for a generator that takes one
/// @throws core::FileError for a file given that cannot be read; what Generator and judge throw
template <packing::PackingGenerator Generator, class Judge>
ObtainedPacking<Generator> obtain_packing(const typename Generator::Parameters& parameters,
                                          const PackingSource& source, Judge&& judge,
                                          const core::Monitor& monitor, core::ThreadPool* pool = nullptr) {
  using Traits = GeneratorTraits<Generator>;
  ObtainedPacking<Generator> obtained;
  if (!source.file.empty()) {
    auto given = io::FromFile({.file = source.file}).pack(monitor);
    obtained.packing = {std::move(given.particles), given.box, {}};
    obtained.packing.report.density = given.report.density;
    obtained.loaded = true;
    obtained.reported = false;
    return obtained;
  }
  const std::string identity = packing_identity<Generator>(parameters, source);
  const std::filesystem::path file = cached_packing<Generator>(parameters, source);
  std::error_code ignored;
  if (!source.cache.empty() && std::filesystem::exists(file, ignored)) {
    try {
      io::PackingFile kept = io::load_packing(file);
      if (kept.parameters != identity)
        throw core::FileError("cannot read " + file.string() + ": it holds a packing of other parameters");
      obtained.packing = {std::move(kept.particles), kept.box, {}};
      Traits::visit_report(obtained.packing.report, detail::LineValues(kept.report));
      obtained.loaded = true;
    } catch (const core::FileError& error) {
      std::fprintf(stderr, "%s; the packing is made anew\n", error.what());
    }
    if (obtained.loaded) {
      judge(obtained.packing.report);
      return obtained;
    }
  }
  const Generator generator(parameters);
  if constexpr (requires { generator.pack(*pool, monitor); })
    obtained.packing = pool ? generator.pack(*pool, monitor) : generator.pack(monitor);
  else
    obtained.packing = generator.pack(monitor);
  judge(obtained.packing.report);
  if (!source.cache.empty()) {
    const io::OutputDirectory folder(source.cache);
    detail::Lines report;
    Traits::visit_report(obtained.packing.report, report);
    io::save_packing(file, obtained.packing.particles, obtained.packing.box,
                     {.parameters = identity, .report = report.text});
  }
  return obtained;
}

/// Makes the packings that the cache lacks, several at a time with one thread each: of many packings that is the quicker way,
/// since the threads of one packing wait for each other. Without a cache nothing is done.
/// @param monitor  called by one thread at a time
/// @throws what obtain_packing() does; packings that were finished before are kept
template <packing::PackingGenerator Generator, class Judge>
void make_packings_ahead(const std::vector<typename Generator::Parameters>& wanted,
                         const PackingSource& source, Judge&& judge, const core::Monitor& monitor,
                         core::ThreadPool& pool) {
  if (source.cache.empty() || !source.file.empty())
    return;
  std::vector<typename Generator::Parameters> missing;
  std::error_code ignored;
  for (const auto& parameters : wanted)
    if (!std::filesystem::exists(cached_packing<Generator>(parameters, source), ignored))
      missing.push_back(parameters);
  if (missing.size() < static_cast<std::size_t>(pool.size()))
    return; // fewer than threads: each is made in its turn, by all of them
  std::mutex one_at_a_time;
  std::vector<double> fraction(missing.size(), 0);
  pool.for_each_block(missing.size(), [&](std::size_t number) {
    const core::Monitor own([&](const core::Progress& progress) {
      const std::lock_guard lock(one_at_a_time);
      fraction[number] = progress.fraction;
      double sum = 0;
      for (const double done : fraction)
        sum += done / static_cast<double>(missing.size());
      monitor.report({std::to_string(missing.size()) + " packings", sum, progress.detail});
    });
    obtain_packing<Generator>(missing[number], source, judge, own);
  });
}

} // namespace cdem::examples
