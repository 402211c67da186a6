// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/singular_phases.hpp"
#include "framehex/surface/surface.hpp"
#include "framehex/surface/surface_point.hpp"

namespace framehex {

/// A point on a singular line.
struct SingularPoint {
  Vector3 point;
  index_t vertex;  ///< of the mesh, near it
};

/// Points of a lattice on its singular lines, which no tetrahedron shows: the map has no value there.
struct SingularPoints {
  std::vector<SingularPoint> interior;  ///< along the lines
  std::vector<SurfacePoint> surface;    ///< where lines leave through the boundary
  bool are_exact = false;               ///< they take the place of what tetrahedra show within half a size
};

/// Finds the lattice points on singular lines that have whole coordinates across: where also the coordinate along is
/// whole, and where they leave through the boundary.
///
/// @param all_whole  all lines have whole coordinates across, wherever the map has them: it is seamless.
/// @par Complexity   O(singular facets).
SingularPoints find_singular_points(const LatticeGraph& graph, const SingularLines& lines,
                                    const std::vector<Vector3>& phases, const Surface& surface,
                                    std::span<const double> sizes, bool all_whole = false);

}  // namespace framehex

#ifndef FRAMEHEX_COMPILED
#include "framehex/lattice/detail/singular_points_impl.hpp"
#endif
