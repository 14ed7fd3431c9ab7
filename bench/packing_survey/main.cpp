// Whether packings end, and what they cost.
//
//   packing_survey                      200 seeds, 1,000 to 20,000 spheres, CoV 0 to 0.3, growth 0.3 to 0.003: all must end
//   packing_survey SEEDS FIRST          so many seeds, beginning with the FIRST
//   packing_survey run PARTICLES COV GROWTH PRESSURE THREADS [DENSITY [SEED]]   one packing: time, memory, checksum

#include <cdem/packing/lubachevsky_stillinger.hpp>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace {

using cdem::packing::Boundary;
using cdem::packing::LubachevskyStillinger;
using cdem::packing::StopReason;
using Packing = cdem::packing::Packing<LubachevskyStillinger::Report>;

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

double largest_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

std::uint64_t checksum(const Packing& packing) {
  std::uint64_t sum = 0xcbf29ce484222325U;
  for (const cdem::Vec3& position : packing.particles.position)
    for (int k = 0; k < 3; ++k) {
      std::uint64_t word;
      std::memcpy(&word, &position[k], sizeof word);
      sum = (sum ^ word) * 0x100000001b3U;
    }
  return sum;
}

void print(const Packing& packing) {
  const auto& report = packing.report;
  std::printf("%-16s density %.6f pressure %.3g collisions a sphere %.0f overlap %.1e rattlers %.4f Z %.4f "
              "%.1f s\n",
              std::string(to_string(report.reason)).c_str(), report.density, report.pressure,
              report.collisions_per_particle, report.largest_overlap,
              static_cast<double>(report.rattlers) / static_cast<double>(packing.particles.size()),
              report.contact_number, report.wall_seconds);
  std::fflush(stdout);
}

int survey(int seeds, int first) {
  const std::vector<std::uint32_t> sizes{1000, 1000, 1000, 2000, 2000, 3000, 5000, 20000};
  const std::vector<double> covs{0, 0.03, 0.1, 0.2, 0.3};
  const std::vector<double> growths{0.3, 0.1, 0.03, 0.01, 0.003};
  int bad = 0;
  for (int seed = first; seed < first + seeds; ++seed) {
    const auto k = static_cast<std::size_t>(seed);
    LubachevskyStillinger::Parameters p{.particles = sizes[k % 8],
                                        .density = 0.74,
                                        .cov = covs[k / 8 % 5],
                                        .growth_rate = growths[k % 8 == 7 ? k / 40 % 3 : k / 40 % 5],
                                        .pressure_limit = k % 3 == 0 ? 1e12 : 1e8,
                                        .boundary = k % 4 == 3 ? Boundary::walls : Boundary::periodic,
                                        .seed = k};
    const Packing packing = LubachevskyStillinger(p).pack();
    std::printf("%3d: %5u spheres CoV %.2f growth %.3f %-8s ", seed, p.particles, p.cov, p.growth_rate,
                p.boundary == Boundary::walls ? "walls" : "periodic");
    print(packing);
    const bool sound =
        packing.report.reason == StopReason::pressure_limit && packing.report.largest_overlap < 1e-10;
    bad += sound ? 0 : 1;
  }
  std::printf("%d of %d did not end at the pressure limit without overlap\n", bad, seeds);
  return bad == 0 ? 0 : 1;
}

int run(int argc, char** argv) {
  LubachevskyStillinger::Parameters p{.particles = static_cast<std::uint32_t>(std::stoul(argv[2])),
                                      .density = argc > 7 ? std::stod(argv[7]) : 0.74,
                                      .cov = std::stod(argv[3]),
                                      .growth_rate = std::stod(argv[4]),
                                      .pressure_limit = std::stod(argv[5]),
                                      .seed = argc > 8 ? std::stoull(argv[8]) : 1};
  cdem::core::ThreadPool pool(std::stoi(argv[6]));
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  double told = 0;
  const cdem::core::Monitor monitor([&](const cdem::core::Progress& progress) {
    if (seconds() > 1.3 * told + 1) {
      told = seconds();
      std::printf("%8.1f s  %s\n", told, progress.detail.c_str());
      std::fflush(stdout);
    }
  });
  const Packing packing = LubachevskyStillinger(p).pack(pool, monitor);
  print(packing);
  std::printf("wall %.1f s, processor %.1f s, %.3f million collisions a second, %.0f bytes a sphere, "
              "checksum %016llx\n",
              packing.report.wall_seconds, cpu_seconds(),
              1e-6 * static_cast<double>(packing.report.collisions) / packing.report.wall_seconds,
              largest_memory() / p.particles, static_cast<unsigned long long>(checksum(packing)));
  return 0;
}

} // namespace

int main(int argc, char** argv) {
  if (argc >= 7 && std::string(argv[1]) == "run")
    return run(argc, argv);
  return survey(argc > 1 ? std::stoi(argv[1]) : 200, argc > 2 ? std::stoi(argv[2]) : 0);
}
