// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <limits>

// NaN and infinity must be seen where input is checked, and the bounds of the exact predicates' filters hold for the
// arithmetic as written. Fused multiply-adds do no harm to either.
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(__ASSOCIATIVE_MATH__)
#error "framehex cannot be compiled with -ffast-math, -ffinite-math-only or -fassociative-math"
#endif

// The target `framehex::compiled` defines FRAMEHEX_COMPILED for itself and for those who link it: long functions are then
// declared only, and defined in the library. Otherwise the bodies are read by everyone (`detail/*_impl.hpp`).
#ifdef FRAMEHEX_COMPILED
#define FRAMEHEX_INLINE
#else
#define FRAMEHEX_INLINE inline
#endif

namespace framehex {

/// Dense 0-based number of a vertex, a cell, a candidate.
using index_t = std::uint32_t;

/// Position in a flat array of a compressed row structure, which may hold more than 2^32 values.
using offset_t = std::uint64_t;

/// "None", where an index is expected.
inline constexpr index_t no_index = std::numeric_limits<index_t>::max();

/// A point or a vector in the plane.
using Vector2 = Eigen::Vector2d;

/// A point or a vector in space.
using Vector3 = Eigen::Vector3d;

/// A frame is a unit quaternion modulo the 24 rotations of the cube: its axes are the columns of its matrix.
using Quaternion = Eigen::Quaterniond;

}  // namespace framehex
