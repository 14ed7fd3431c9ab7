#pragma once

/// @file
/// The internal forces that fit a law.

#include <cdem/bond/bond_forces.hpp>
#include <cdem/bond/linear_forces.hpp>

#include <type_traits>

namespace cdem::bond {

/// LinearForces for a law of four linear channels in small motion, BondForces for every other.
template <BondLaw Law>
using ForcesOf = std::conditional_t<GivesChannelStiffness<Law>, LinearForces, BondForces<Law>>;

} // namespace cdem::bond
