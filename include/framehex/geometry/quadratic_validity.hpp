// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/cell_kinds.hpp"

#include <span>

namespace framehex {

/// Whether the map of a cell with a node on each edge (10, 13, 15 or 20 nodes) is surely invertible: its Jacobian is
/// positive on the whole closed reference cell, at a pyramid's apex in the limit.
///
/// Looks at the Jacobian's Bezier coefficients, which bound it from below, in floating point with a bound on its rounding.
///
/// @param corners  n_corners(kind) points. @param middles  a node for each of edges_of(kind).
/// @return true only if it is; false also for cells that are valid by less than the bounds can tell.
/// @pre finite coordinates, the Jacobian within the range of a double.
/// @par Complexity   O(1): some 20 to 200 microseconds.
/// @par Source       A. Johnen, J.-F. Remacle, C. Geuzaine, Geometrical validity of curvilinear finite elements, J. Comput.
///                   Phys. 233 (2013) 359-372. Departs: coefficients by multiplication of homogeneous polynomials, no
///                   subdivision, pyramids.
bool is_surely_valid(CellKind kind, std::span<const Vector3> corners, std::span<const Vector3> middles);

}  // namespace framehex

#ifndef FRAMEHEX_COMPILED
#include "framehex/geometry/detail/quadratic_validity_impl.hpp"
#endif
