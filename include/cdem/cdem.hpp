#pragma once

/// @file
/// Every header of the toolkit. One that takes only what it uses compiles faster.

#include <cdem/bond/beam.hpp>
#include <cdem/bond/bond_law.hpp>
#include <cdem/bond/linear_forces.hpp>
#include <cdem/bond/material.hpp>
#include <cdem/bond/spring.hpp>
#include <cdem/core/error.hpp>
#include <cdem/core/parallel.hpp>
#include <cdem/core/progress.hpp>
#include <cdem/core/random.hpp>
#include <cdem/core/types.hpp>
#include <cdem/geometry/box.hpp>
#include <cdem/network/bond_network.hpp>
#include <cdem/packing/packing_generator.hpp>
#include <cdem/particles/constraints.hpp>
#include <cdem/particles/inertia.hpp>
#include <cdem/particles/motion.hpp>
#include <cdem/particles/particle_set.hpp>
#include <cdem/particles/spatial_field.hpp>
#include <cdem/stress/stress_estimator.hpp>
