// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/self_intersection.hpp"
#include "framehex/tetrahedralization/tetrahedralizer.hpp"

namespace framehex::detail {

/// For backends that abort, or never end, on surfaces that cross themselves.
///
/// @throws invalid_surface naming two triangles that cross.
inline void refuse_crossings(const TetrahedralizationRequest& request) {
  const auto pairs = find_self_intersections(TriangleView{request.points, request.triangles}, 1);
  if (pairs.empty()) return;
  const auto [i, j] = pairs.front();
  throw invalid_surface("the surface crosses itself at triangles " + std::to_string(i) + " and " + std::to_string(j),
                        Entity::triangle, {i, j});
}

}  // namespace framehex::detail
