// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/pipeline/detail/mesh_quads.hpp"
#include "framehex/surface/outline_triangulation.hpp"

namespace framehex {

/// From the outline of a planar domain to quadrilaterals in its plane that follow it.
///
/// Each region gets an even number of intervals on its boundary, where need be one more than the size asks for on a long
/// curve; without any triangle left then, given an exact matcher.
///
/// Vertices of the outline where it bends by more than `features.corner_angle`, or by less but between straight parts
/// longer than the size (`QuadMeshingOptions::bends`), are vertices of the mesh; between them curves have points at the
/// mesh's own distances, smaller where the sides would be too far from the outline
/// (`RetriangulationOptions::max_deviation`; infinite: nowhere), and the result tells how far they are.
///
/// @param outline  loops in any direction, holes, inner polylines; see `PlanarOutline`. Coordinates in the host's unit.
/// @param size     wished edge length at a point: a callable `double(const Vector3&)` > 0, host's unit.
/// @param matcher  exact, e.g. `LemonMatcher`; with `GreedyMatcher` and `QuadGoal::pairs` some triangles stay.
/// @return all cells convex, decided exactly; vertices of curves on the outline's segments.
/// @throws invalid_outline, invalid_coordinate, invalid_connectivity  as `triangulate_outline`; invalid_surface  with
///         three vertices of the outline near which no convex cell fits; invalid_option, invalid_field.
/// @par Complexity   about O(n log n) in the number of points, beside the matcher's.
/// @par Determinism  The same everywhere up to rounding.
/// @par Source       The paper, equation (1), section 3.2, and its reference [4] for the quadrilaterals. Departs: parity,
///                   improvement.
template <Matcher Match, SizeField Size>
QuadMeshing mesh_planar(const PlanarOutline& outline, const Size& size, const Match& matcher,
                        const QuadMeshingOptions& options = {}) {
  check_options(options);
  if (!std::isfinite(outline.z)) throw invalid_coordinate("z of the outline is not finite");
  QuadMeshingOptions planar = options;
  // As thin as strips may be: the outline's vertices on them are to go all the same.
  planar.retriangulation.least_shape = std::min(planar.retriangulation.least_shape, detail::least_curve_distance);
  QuadMeshing result =
      detail::mesh_quads(triangulate_outline(outline).surface(options.features), size, matcher, planar);
  for (Vector3& p : result.mesh.points) p.z() = outline.z;
  for (Vector3& p : result.background.points) p.z() = outline.z;
  return result;
}

}  // namespace framehex
