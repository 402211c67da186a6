// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/surface.hpp"

#include <utility>

namespace framehex::detail {

/// Halves the longest edge of a feature curve, and the triangles on it.
inline void split_longest_edge(Surface& surface, index_t curve) {
  FeatureGraph& features = surface.features;
  const auto row = features.curves[curve];
  const auto length = [&](std::size_t i) {
    return (surface.points[row[i + 1]] - surface.points[row[i]]).squaredNorm();
  };
  std::size_t longest = 0;
  for (std::size_t i = 1; i + 1 < row.size(); ++i)
    if (length(i) > length(longest)) longest = i;
  const index_t a = row[longest], b = row[longest + 1], middle = static_cast<index_t>(surface.points.size());
  surface.points.push_back((surface.points[a] + surface.points[b]) / 2);

  IndexedTriangleMesh mesh{std::move(surface.points), std::move(surface.adjacency.triangles)};
  for (const index_t t : surface.adjacency.triangles_of_vertex[a])
    for (std::size_t i = 0; i < 3; ++i) {
      const auto v = mesh.triangles[t];
      const index_t from = v[i], to = v[(i + 1) % 3], apex = v[(i + 2) % 3];
      if (!((from == a && to == b) || (from == b && to == a))) continue;
      const std::array<std::uint8_t, 3> flags{features.is_feature[3 * t + i], features.is_feature[3 * t + (i + 1) % 3],
                                              features.is_feature[3 * t + (i + 2) % 3]};
      mesh.triangles[t] = {from, middle, apex};
      mesh.triangles.push_back({middle, to, apex});
      features.triangle_patch.push_back(index_t{features.triangle_patch[t]});
      std::copy_n(std::array<std::uint8_t, 3>{flags[0], 0, flags[2]}.begin(), 3, features.is_feature.begin() + 3 * t);
      features.is_feature.insert(features.is_feature.end(), {flags[0], flags[1], 0});
      break;
    }
  Csr<index_t> curves;
  for (std::size_t c = 0; c < features.curves.size(); ++c) {
    const auto old = features.curves[c];
    for (std::size_t i = 0; i < old.size(); ++i) {
      curves.values.push_back(old[i]);
      if (c == curve && i == longest) curves.values.push_back(middle);
    }
    curves.end_row();
  }
  features.curves = std::move(curves);
  surface.adjacency = make_adjacency(mesh, Junctions::open);
  surface.points = std::move(mesh.points);
}

}  // namespace framehex::detail
