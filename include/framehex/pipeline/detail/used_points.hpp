// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/surface.hpp"

#include <algorithm>

namespace framehex::detail {

/// Leaves the points out that no triangle uses; what stays keeps its order, and given edges follow.
inline void leave_out_unused_points(Surface& surface, FeatureOptions& features) {
  const auto is_unused = [&](index_t v) { return surface.adjacency.triangles_of_vertex[v].empty(); };
  const auto n = static_cast<index_t>(surface.points.size());
  if (std::ranges::none_of(std::views::iota(index_t{0}, n), is_unused)) return;
  IndexedTriangleMesh used;
  std::vector<index_t> number(n, no_index);
  for (index_t v = 0; v < n; ++v) {
    if (is_unused(v)) continue;
    number[v] = static_cast<index_t>(used.points.size());
    used.points.push_back(surface.points[v]);
  }
  for (const auto& t : surface.triangles()) used.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  for (auto& edge : features.given_edges) edge = {number[edge[0]], number[edge[1]]};
  surface = Surface(used, features);
}

}  // namespace framehex::detail
