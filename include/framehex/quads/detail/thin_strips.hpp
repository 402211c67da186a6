// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/quads/detail/edge_halving.hpp"
#include "framehex/surface/surface_locator.hpp"

namespace framehex::detail {

/// Edges across the strips that are one triangle wide: within a patch, from curve to curve.
///
/// @param places  strips that pass the triangles nearest to these.
/// @par Complexity   O(n log n).
inline std::vector<EdgeHalver::Edge> edges_across_strips(const Surface& surface, std::span<const Vector3> places) {
  const TriangleAdjacency& adjacency = surface.adjacency;
  const FeatureGraph& features = surface.features;
  std::vector<char> on_curve(surface.points.size(), 0), seen(surface.triangles().size(), 0);
  for (const index_t v : features.curves.values) on_curve[v] = 1;
  const SurfaceLocator locator(surface);
  std::vector<index_t> stack;
  for (const Vector3& p : places) stack.push_back(locator.nearest(p).triangle);
  std::vector<EdgeHalver::Edge> across;
  while (!stack.empty()) {
    const index_t t = stack.back();
    stack.pop_back();
    if (std::exchange(seen[t], 1)) continue;
    for (index_t h = 3 * t; h < 3 * t + 3; ++h) {
      const index_t g = adjacency.opposite[h], a = adjacency.from(h), b = adjacency.to(h);
      if (features.is_feature[h] || g == no_index || !on_curve[a] || !on_curve[b]) continue;
      if (!seen[g / 3]) across.push_back({a, b});
      stack.push_back(g / 3);
    }
  }
  return across;
}

}  // namespace framehex::detail
