#pragma once

/// @file
/// Sums over all spheres of exp(-i k x), for the longest waves that fit a periodic box.

#include <cdem/core/parallel.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/particles/particle_set.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace cdem::packing::detail {

/// Powers of exp(-i phase), from `-most` to `most`.
struct WavePowers {
  std::vector<double> re, im;

  explicit WavePowers(int most) : re(static_cast<std::size_t>(2 * most + 1)), im(re.size()) {}

  void set(double phase) {
    const std::size_t zero = re.size() / 2;
    const double c = std::cos(phase), s = -std::sin(phase);
    re[zero] = 1;
    im[zero] = 0;
    for (std::size_t k = 1; k <= zero; ++k) {
      re[zero + k] = re[zero + k - 1] * c - im[zero + k - 1] * s;
      im[zero + k] = re[zero + k - 1] * s + im[zero + k - 1] * c;
      re[zero - k] = re[zero + k];
      im[zero - k] = -im[zero + k];
    }
  }
};

/// The wave vectors k = 2 pi (n_x/L_x, n_y/L_y, n_z/L_z), |n_k| <= most, of the half space n_x > 0, or n_x = 0 and n_y > 0, or
/// n_x = n_y = 0 and n_z > 0; n_z runs fastest. Both sums are of w exp(-i k x), with w = 1 and w = the sphere's volume
/// over the mean.
struct WaveSums {
  int most = 0;
  std::vector<std::array<double, 4>> sum; ///< [(most + 1) (2 most + 1)^2] real, imaginary; the same by volume

  std::size_t index(int a, int b, int c) const {
    const int n = 2 * most + 1;
    return static_cast<std::size_t>((a * n + b + most) * n + c + most);
  }
};

/// @param most  1 to 64
/// @complexity  O(spheres most^3), shared by the threads; summed in an order that does not depend on their number
inline WaveSums wave_sums(const particles::ParticleSet& spheres, const geometry::Box& box, int most,
                          core::ThreadPool& pool, std::size_t blocks) {
  const std::size_t count = spheres.size(), width = static_cast<std::size_t>(2 * most + 1);
  const double mean_cube =
      spheres.solid_volume() / (4.0 / 3.0 * std::numbers::pi * static_cast<double>(count));
  const Vec3 wave = 2 * std::numbers::pi * box.size().cwiseInverse();
  const std::size_t rows = static_cast<std::size_t>(most + 1) * width; // of one n_x and n_y
  std::vector<std::array<std::vector<double>, 4>> part(std::min(blocks, count));
  pool.for_each_block(part.size(), [&](std::size_t block) {
    auto& [re, im, volume_re, volume_im] = part[block];
    for (auto* values : {&re, &im, &volume_re, &volume_im})
      values->assign(rows * width, 0);
    std::array<WavePowers, 3> power{WavePowers(most), WavePowers(most), WavePowers(most)};
    const std::size_t zero = static_cast<std::size_t>(most);
    for (std::size_t i = count * block / part.size(); i < count * (block + 1) / part.size(); ++i) {
      for (int k = 0; k < 3; ++k)
        power[static_cast<std::size_t>(k)].set(wave[k] * (spheres.position[i][k] - box.lower[k]));
      const double weight = std::pow(spheres.radius[i], 3) / mean_cube;
      const double *zr = power[2].re.data(), *zi = power[2].im.data();
      for (std::size_t a = 0; a <= zero; ++a)
        for (std::size_t b = a == 0 ? zero : 0; b < width; ++b) {
          const double xr = power[0].re[zero + a], xi = power[0].im[zero + a];
          const double yr = power[1].re[b], yi = power[1].im[b];
          const double tr = xr * yr - xi * yi, ti = xr * yi + xi * yr;
          const std::size_t row = (a * width + b) * width;
          for (std::size_t c = 0; c < width; ++c) {
            const double r = tr * zr[c] - ti * zi[c], s = tr * zi[c] + ti * zr[c];
            re[row + c] += r;
            im[row + c] += s;
            volume_re[row + c] += weight * r;
            volume_im[row + c] += weight * s;
          }
        }
    }
  });
  WaveSums result{most, std::vector<std::array<double, 4>>(rows * width, std::array<double, 4>{})};
  for (const auto& own : part)
    for (std::size_t k = 0; k < result.sum.size(); ++k)
      for (std::size_t q = 0; q < 4; ++q)
        result.sum[k][q] += own[q][k];
  return result;
}

} // namespace cdem::packing::detail
