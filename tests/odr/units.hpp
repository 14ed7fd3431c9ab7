#pragma once

#include <cdem/cdem.hpp>

#include <array>

/// Where one translation unit finds some functions and constants of the toolkit.
using Addresses = std::array<const void*, 7>;

inline const void* address(auto* function) {
  return reinterpret_cast<const void*>(function);
}

static Addresses addresses() {
  return {address(&cdem::core::expect_positive),
          address(&cdem::core::index_of),
          address(&cdem::geometry::Box::cube),
          address(&cdem::core::block_size),
          address(&cdem::bond::local_frame),
          address(&cdem::bond::resistance_of<cdem::bond::Matrix12>),
          address(&cdem::bond::Response<cdem::bond::FiniteRotation<cdem::bond::Beam<>>>::load)};
}

Addresses addresses_in_first();
Addresses addresses_in_second();
