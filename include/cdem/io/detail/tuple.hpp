#pragma once

/// @file
/// The values a file can hold: a number, or a fixed number of them.

#include <cdem/particles/spatial_field.hpp>

#include <array>
#include <concepts>
#include <type_traits>

namespace cdem::io::detail {

/// Scalar type and number of components of a value; what is not specialised cannot be written.
template <class T>
struct Tuple {
  static constexpr std::size_t components = 0;
};

template <class T>
requires std::is_arithmetic_v<T>
struct Tuple<T> {
  using Scalar = T;
  static constexpr std::size_t components = 1;
  static Scalar component(const T& value, std::size_t) { return value; }
};

template <class T, std::size_t N>
requires std::is_arithmetic_v<T>
struct Tuple<std::array<T, N>> {
  using Scalar = T;
  static constexpr std::size_t components = N;
  static Scalar component(const std::array<T, N>& value, std::size_t c) { return value[c]; }
};

/// Fixed-size Eigen matrix. Components are numbered row by row (xx xy xz yx ...), whatever its storage.
template <class T, int Rows, int Columns, int Options>
requires(std::is_arithmetic_v<T>&& Rows > 0 &&
         Columns > 0) struct Tuple<Eigen::Matrix<T, Rows, Columns, Options, Rows, Columns>> {
  using Scalar = T;
  static constexpr std::size_t components = static_cast<std::size_t>(Rows * Columns);
  static Scalar component(const Eigen::Matrix<T, Rows, Columns, Options, Rows, Columns>& value,
                          std::size_t c) {
    const auto k = static_cast<Eigen::Index>(c);
    return value(k / Columns, k % Columns);
  }
};

/// The eight components of particles::Spatial, padding included.
template <class Real>
struct Tuple<particles::Spatial<Real>> {
  using Scalar = Real;
  static constexpr std::size_t components = 8;
  static Scalar component(const particles::Spatial<Real>& value, std::size_t c) { return value.component[c]; }
};

/// A number, std::array of numbers, fixed-size Eigen matrix or particles::Spatial.
template <class T>
concept TupleValue = Tuple<T>::components >
0;

} // namespace cdem::io::detail
