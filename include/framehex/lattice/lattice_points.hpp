// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/boundary_axes.hpp"
#include "framehex/lattice/lattice_map.hpp"
#include "framehex/lattice/singular_points.hpp"
#include "framehex/surface/surface_sample.hpp"

namespace framehex {

/// Points with whole coordinates on a curve: arc lengths from its first vertex.
struct CurveLattice {
  Csr<double> arcs;                     ///< a row a curve: its inner points, ascending
  std::vector<std::uint8_t> is_usable;  ///< per curve: does the map follow the curve from end to end?
};

/// Points with whole coordinates in a mesh and on its boundary, and where these are all that a lattice has there.
struct LatticePoints {
  std::vector<Vector3> interior;       ///< in the order of the tetrahedra in which they were found
  std::vector<SurfaceSample> surface;  ///< in the order of triangles; none on another patch's
  CurveLattice curves;
  std::vector<std::uint8_t> complete_tets;       ///< 1 where the map is regular: more points would only split cells
  std::vector<std::uint8_t> complete_triangles;  ///< the same for the boundary
  std::size_t n_singular_tets = 0;
  std::size_t n_defect_tets = 0;  ///< through which a dislocation passes
  double complete_volume = 0;     ///< share of the volume in complete tetrahedra, 0 to 1
};

/// Finds the points of a map's lattice: in tetrahedra, on boundary triangles and on feature curves.
///
/// @param sizes      n_vertices of the mesh: wished distance of neighbours, host's unit.
/// @param singular   points on its singular lines, which the tetrahedra do not show.
/// @param vertex_of  surface vertex -> vertex of the mesh; empty: the same number.
/// @return points no two of which, on one patch or inside, are within half a size.
/// @par Complexity   O(tetrahedra + points); the same for any executor.
LatticePoints extract_lattice_points(const LatticeMap& map, const Surface& surface, const BoundaryAxes& boundary,
                                     std::span<const double> sizes, const SingularPoints& singular = {},
                                     std::span<const index_t> vertex_of = {});

}  // namespace framehex

#ifndef FRAMEHEX_COMPILED
#include "framehex/lattice/detail/lattice_points_impl.hpp"
#endif
