#pragma once

/// @file
/// Memory of the static multigrid's arrays.

#include <cdem/core/huge_pages.hpp>
#include <cdem/particles/spatial_field.hpp>

#include <vector>

namespace cdem::integrate::detail {

/// Levels are swept and gathered from hundreds of times.
template <class T>
using LevelArray = std::vector<T, core::HugePageAllocator<T>>;

/// Translation and rotation of nodes in single precision, a line of 32 bytes each.
using Field = LevelArray<particles::Spatial<float>>;

} // namespace cdem::integrate::detail
