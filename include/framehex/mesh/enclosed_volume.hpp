// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/indexed_mesh.hpp"

namespace framehex {

/// Volume inside a closed surface, in its unit cubed; negative when it is inside out.
///
/// Summed about one of the surface's own points, which keeps the digits far from the origin.
/// @par Complexity   O(n).
template <TriangleMesh M>
double enclosed_volume(const M& mesh) {
  const auto& surface = detail::flat(mesh);
  if (surface.triangles.empty()) return 0;
  const Vector3 origin = surface.points[surface.triangles[0][0]];
  double sum = 0;
  for (const auto& t : surface.triangles)
    sum += (surface.points[t[0]] - origin).dot((surface.points[t[1]] - origin).cross(surface.points[t[2]] - origin));
  return sum / 6;
}

}  // namespace framehex
