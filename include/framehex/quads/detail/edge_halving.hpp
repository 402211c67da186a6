// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/surface.hpp"

#include <span>
#include <unordered_map>
#include <utility>

namespace framehex::detail {

/// Puts a vertex in the middle of some edges of a surface, and divides the triangles beside them. Curves and patches
/// keep their numbers, vertices theirs.
class EdgeHalver {
public:
  using Edge = std::array<index_t, 2>;

  explicit EdgeHalver(Surface& surface) : surface_(surface), features_(surface.features) {}

  void run(std::span<const Edge> edges) {
    for (const auto& [a, b] : edges) {
      const auto at = static_cast<index_t>(surface_.points.size());
      if (middles_.try_emplace(edge_key(a, b), at).second)
        surface_.points.push_back((surface_.points[a] + surface_.points[b]) / 2);
    }
    triangles_ = std::move(surface_.adjacency.triangles);
    for (index_t t = 0; t < triangles_.size();)
      if (!bisect(t)) ++t;
    divide_curves();
    IndexedTriangleMesh mesh{std::move(surface_.points), std::move(triangles_)};
    surface_.adjacency = make_adjacency(mesh, Junctions::open);
    surface_.points = std::move(mesh.points);
  }

private:
  index_t middle(index_t a, index_t b) const {
    const auto found = middles_.find(edge_key(a, b));
    return found == middles_.end() ? no_index : found->second;
  }

  /// Cuts a triangle from the middle of its longest edge that has one. @return false: none has.
  bool bisect(index_t t) {
    const std::array<index_t, 3> v = triangles_[t];
    std::size_t side = 3;
    double longest = -1;
    for (std::size_t i = 0; i < 3; ++i) {
      const double length = (surface_.points[v[(i + 1) % 3]] - surface_.points[v[i]]).squaredNorm();
      if (middle(v[i], v[(i + 1) % 3]) == no_index || length <= longest) continue;
      longest = length;
      side = i;
    }
    if (side == 3) return false;
    const std::size_t after = (side + 1) % 3, before = (side + 2) % 3;
    const index_t m = middle(v[side], v[after]);
    std::uint8_t* const flags = &features_.is_feature[3 * t];
    const std::uint8_t cut = flags[side], kept = flags[after], other = flags[before];
    triangles_[t] = {v[side], m, v[before]};
    std::copy_n(std::array<std::uint8_t, 3>{cut, 0, other}.begin(), 3, flags);
    triangles_.push_back({m, v[after], v[before]});
    features_.is_feature.insert(features_.is_feature.end(), {cut, kept, 0});
    features_.triangle_patch.push_back(index_t{features_.triangle_patch[t]});
    return true;
  }

  void divide_curves() {
    Csr<index_t> curves;
    for (std::size_t c = 0; c < features_.curves.size(); ++c) {
      const auto row = features_.curves[c];
      for (std::size_t i = 0; i < row.size(); ++i) {
        if (const index_t m = i > 0 ? middle(row[i - 1], row[i]) : no_index; m != no_index) curves.values.push_back(m);
        curves.values.push_back(row[i]);
      }
      curves.end_row();
    }
    features_.curves = std::move(curves);
  }

  Surface& surface_;
  FeatureGraph& features_;
  std::vector<std::array<index_t, 3>> triangles_;
  std::unordered_map<std::uint64_t, index_t> middles_;  // by edge
};

/// Halves the longest edge of a feature curve.
inline void halve_longest_edge(Surface& surface, index_t curve) {
  const auto row = surface.features.curves[curve];
  const auto length = [&](std::size_t i) {
    return (surface.points[row[i + 1]] - surface.points[row[i]]).squaredNorm();
  };
  std::size_t longest = 0;
  for (std::size_t i = 1; i + 1 < row.size(); ++i)
    if (length(i) > length(longest)) longest = i;
  const std::array<EdgeHalver::Edge, 1> edge{{{row[longest], row[longest + 1]}}};
  EdgeHalver(surface).run(edge);
}

}  // namespace framehex::detail
