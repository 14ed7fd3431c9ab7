#pragma once

// What every example shares: the common options, one-line errors, the plotting script.

#include <cdem/core/error.hpp>
#include <cdem/core/progress.hpp>
#include <cdem/io/interrupt.hpp>
#include <cdem/io/terminal_progress.hpp>

#include <CLI/CLI.hpp>

#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include "packings.hpp"

namespace cdem::examples {

/// The options that every example takes.
struct CommonOptions {
  std::uint32_t particles = 10000;
  std::uint64_t seed = 1;
  int threads = 0; ///< 0: all processors
  std::filesystem::path out;
  bool quick = false;
  bool plot = true;

  void add_to(CLI::App& app, std::uint32_t fewest_particles) {
    app.add_option("--particles", particles, "Number of particles")
        ->check(CLI::Range(fewest_particles, std::uint32_t{100000000}))
        ->capture_default_str();
    app.add_option("--seed", seed, "Seed of the random numbers: the same seed gives the same results")
        ->capture_default_str();
    app.add_option("--threads", threads, "Threads, 0 for all processors; results do not depend on it")
        ->check(CLI::Range(0, 4096))
        ->capture_default_str();
    app.add_option("--out", out, "Folder for the results")
        ->capture_default_str()
        ->check([](const std::string& text) {
          return text.empty() ? std::string("a folder's name is expected") : std::string();
        });
    app.add_flag("--quick", quick, "A small run of a few seconds, to see that everything works");
    app.add_flag("!--no-plot", plot, "Draw no pictures");
  }
};

/// The options of an example that packs: add them after those that say how, which a packing given makes void.
struct PackingOptions {
  std::filesystem::path file;
  std::filesystem::path cache;
  bool keep = true;

  void add_to(CLI::App& app, const std::vector<std::string>& void_options) {
    auto* given =
        app.add_option("--packing", file,
                       "File with the packing, instead of making one: .cdem, CSV, YADE, LAMMPS, VTK")
            ->check(CLI::ExistingFile);
    for (const std::string& name : void_options)
      given->excludes(app.get_option(name));
    app.add_option("--cache", cache,
                   "Folder in which packings are kept for later runs; default: packings beside --out")
        ->check([](const std::string& text) {
          return text.empty() ? std::string("a folder's name is expected") : std::string();
        });
    app.add_flag("!--no-cache", keep, "Keep no packing, use none that was kept");
  }

  /// What they come to, given the folder of the results. A packing given is read once to see that it can be.
  /// @throws core::InvalidInput if it cannot: a bad value like any other
  PackingSource source(const std::filesystem::path& out) const {
    try {
      if (!file.empty())
        io::FromFile({.file = file}).pack();
    } catch (const core::FileError& error) {
      throw core::InvalidInput(error.what());
    }
    if (!keep)
      return {file, {}};
    const std::filesystem::path results = (out / "").lexically_normal().parent_path();
    return {file, cache.empty() ? results.parent_path() / "packings" : cache};
  }
};

/// Adds an option that takes one of a few words; `value` holds the default.
template <class Value>
void add_choice(CLI::App& app, const std::string& option, Value& value,
                const std::vector<std::pair<std::string, Value>>& choices, const std::string& help) {
  std::vector<std::string> words;
  std::string standard;
  for (const auto& [word, meaning] : choices) {
    words.push_back(word);
    if (meaning == value)
      standard = word;
  }
  app.add_option_function<std::string>(
         option,
         [&value, choices](const std::string& text) {
           for (const auto& [word, meaning] : choices)
             if (word == text)
               value = meaning;
         },
         help)
      ->check(CLI::IsMember(words))
      ->default_str(standard);
}

/// Adds the options of a packing by the Lubachevsky–Stillinger algorithm; the number of particles and the seed are common ones.
inline void add_packing_parameters(CLI::App& app, packing::LubachevskyStillinger::Parameters& packing) {
  app.add_option("--cov", packing.cov, "CoV of the Gaussian radii")->capture_default_str();
  app.add_option("--density", packing.density, "Volume fraction of the packing")->capture_default_str();
  app.add_option("--growth", packing.growth_rate, "Growth rate of the spheres: slower packs denser")
      ->capture_default_str();
  add_choice<packing::Boundary>(
      app, "--boundary", packing.boundary,
      {{"periodic", packing::Boundary::periodic}, {"walls", packing::Boundary::walls}},
      "Box of the packing: periodic (then cut to a cube) or walls");
}

/// Runs `body` and turns what goes wrong into one line on stderr and an exit status: 2 for a bad option or value,
/// 130 for Ctrl-C, 1 for anything else.
template <class Body>
int guarded(const char* program, Body&& body) {
  try {
    body();
    return 0;
  } catch (const core::InvalidInput& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return 2;
  } catch (const core::Interrupted& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return 130;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return 1;
  }
}

/// Parses the command line; -1 to go on, else the exit status (0 after --help, 2 after one line of complaint).
inline int parse(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return -1;
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    std::string text = error.what();
    for (char& c : text)
      if (c == '\n')
        c = ' ';
    std::fprintf(stderr, "%s: %s; --help lists what is accepted\n", app.get_name().c_str(), text.c_str());
    return 2;
  }
}

/// Draws the pictures of a results folder with scripts/plot; says in one line why there are none.
inline void draw(const std::filesystem::path& folder) {
#ifdef CDEM_PLOT_SCRIPT
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    execlp(CDEM_PLOT_SCRIPT, CDEM_PLOT_SCRIPT, folder.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  if (child > 0)
    waitpid(child, &status, 0);
  if (child < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
    std::printf("No pictures were drawn; scripts/plot %s draws them where Python has Matplotlib.\n",
                folder.c_str());
#else
  std::printf("scripts/plot %s draws the pictures.\n", folder.c_str());
#endif
}

} // namespace cdem::examples
