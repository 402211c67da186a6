// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/quality.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/surface/surface.hpp"
#include "framehex/tetrahedralization/tetrahedralizer.hpp"

#include <optional>
#include <unordered_map>
#include <unordered_set>

namespace framehex {

namespace detail {

/// Removes tetrahedra that lie flat under two triangles of a surface.
class FlatTetPeeler {
public:
  FlatTetPeeler(const IndexedTetMesh& mesh, TetAdjacency& adjacency, Surface& surface, double least_quality)
      : mesh_(mesh), adjacency_(adjacency), surface_(surface), least_quality_(least_quality) {}

  /// Ends because each step removes a tetrahedron.
  /// @return by tetrahedron: whether it is gone.
  std::vector<std::uint8_t> run() {
    std::vector<std::uint8_t> gone(mesh_.tets.size(), 0);
    std::vector<index_t> next;
    for (index_t tet = 0; tet < gone.size(); ++tet)
      if (is_flat(tet)) next.push_back(tet);
    if (!next.empty()) index_surface();
    while (!next.empty()) {
      const index_t tet = next.back();
      next.pop_back();
      if (gone[tet] || !is_flat(tet) || !peel(tet)) continue;
      gone[tet] = 1;
      for (const index_t beyond : adjacency_.neighbours[tet])
        if (beyond != no_index) next.push_back(beyond);
    }
    return gone;
  }

private:
  using Triangle = std::array<index_t, 3>;

  /// The corners opposite its two boundary facets first, then the others; nothing unless it has two such facets.
  std::optional<std::array<int, 4>> split(index_t tet) const {
    std::array<int, 4> order{};
    std::size_t n_boundary = 0, n_inner = 0;
    for (int i = 0; i < 4; ++i) {
      const bool boundary = adjacency_.neighbours[tet][static_cast<std::size_t>(i)] == no_index;
      if (boundary && n_boundary < 2)
        order[n_boundary++] = i;
      else if (!boundary && n_inner < 2)
        order[2 + n_inner++] = i;
    }
    if (n_boundary != 2 || n_inner != 2) return std::nullopt;
    return order;
  }

  Vector3 normal(const Triangle& t) const {
    return (mesh_.points[t[1]] - mesh_.points[t[0]]).cross(mesh_.points[t[2]] - mesh_.points[t[0]]).normalized();
  }

  bool is_flat(index_t tet) const {
    constexpr double cos_most_bend = 0.85;
    const auto order = split(tet);
    if (!order) return false;
    const auto& t = mesh_.tets[tet];
    const std::array<Vector3, 4> p{mesh_.points[t[0]], mesh_.points[t[1]], mesh_.points[t[2]], mesh_.points[t[3]]};
    return scaled_jacobian(CellKind::tetrahedron, p) < least_quality_ &&
           normal(facet(t, (*order)[0])).dot(normal(facet(t, (*order)[1]))) > cos_most_bend;
  }

  void index_surface() {
    for (index_t t = 0; t < surface_.triangles().size(); ++t) {
      triangle_at_.emplace(key(surface_.triangles()[t]), t);
      for (index_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint64_t edge = edge_key(surface_.adjacency.from(h), surface_.adjacency.to(h));
        edges_.insert(edge);
        if (surface_.features.is_feature[h]) features_.insert(edge);
      }
    }
  }

  static Triangle key(const Triangle& t) { return sorted(t); }

  bool peel(index_t tet) {
    const auto order = *split(tet);
    const auto& corners = mesh_.tets[tet];
    const auto corner = [&](std::size_t i) { return corners[static_cast<std::size_t>(order[i])]; };
    const std::uint64_t old_edge = edge_key(corner(2), corner(3)), new_edge = edge_key(corner(0), corner(1));
    if (features_.contains(old_edge) || edges_.contains(new_edge)) return false;
    const auto first = triangle_at_.find(key(facet(corners, order[0])));
    const auto second = triangle_at_.find(key(facet(corners, order[1])));
    if (first == triangle_at_.end() || second == triangle_at_.end()) return false;
    const index_t a = first->second, b = second->second;
    if (surface_.features.triangle_patch[a] != surface_.features.triangle_patch[b]) return false;
    // The triangles of the surface may look into the body, as those of a patch with nothing behind do.
    const bool outward = canonical(surface_.triangles()[a]) == canonical(facet(corners, order[0]));
    triangle_at_.erase(first);
    triangle_at_.erase(second);
    edges_.erase(old_edge);
    edges_.insert(new_edge);
    for (const auto& [triangle, inner] : {std::pair(a, order[2]), std::pair(b, order[3])}) {
      Triangle t = facet(corners, inner);
      if (outward) std::swap(t[1], t[2]);
      replace(triangle, t);
    }
    for (std::size_t i = 2; i < 4; ++i) {
      const index_t beyond = adjacency_.neighbours[tet][static_cast<std::size_t>(order[i])];
      std::ranges::replace(adjacency_.neighbours[beyond], tet, no_index);
    }
    return true;
  }

  void replace(index_t triangle, const Triangle& t) {
    surface_.adjacency.triangles[triangle] = t;
    triangle_at_.emplace(key(t), triangle);
    for (std::size_t i = 0; i < 3; ++i)
      surface_.features.is_feature[3 * triangle + i] = features_.contains(edge_key(t[i], t[(i + 1) % 3])) ? 1 : 0;
  }

  struct Hash {
    std::size_t operator()(const Triangle& t) const {
      return static_cast<std::size_t>((t[0] * 0x9e3779b97f4a7c15u) ^ (t[1] * 0xff51afd7ed558ccdu) ^
                                      (t[2] + (t[2] << 7)));
    }
  };

  const IndexedTetMesh& mesh_;
  TetAdjacency& adjacency_;
  Surface& surface_;
  double least_quality_;
  std::unordered_map<Triangle, index_t, Hash> triangle_at_;  // looked up only, as are the edges
  std::unordered_set<std::uint64_t> edges_, features_;
};

}  // namespace detail

/// Removes tetrahedra below a quality that lie flat under two triangles of the boundary: these come to be cut along the other
/// diagonal. Where four points of a surface lie nearly in one plane, nothing else mends such a tetrahedron.
///
/// Only where both triangles belong to one patch and nothing lies beyond them; features stay, and so do all points.
///
/// @param mesh      and its adjacency, of which some is gone after it.
/// @param regions   label of each tetrahedron; as `mesh`.
/// @param surface   its boundary, with patches and features; its triangles are changed.
/// @param quality   scaled Jacobian below which a tetrahedron is removed.
/// @return how many were removed.
/// @par Complexity  O(n).
inline std::size_t peel_flat_tets(IndexedTetMesh& mesh, TetAdjacency& adjacency, std::vector<index_t>& regions,
                                  Surface& surface, double quality) {
  const std::vector<std::uint8_t> gone = detail::FlatTetPeeler(mesh, adjacency, surface, quality).run();
  std::size_t n = 0;
  for (std::size_t tet = 0; tet < gone.size(); ++tet) {
    if (gone[tet]) continue;
    mesh.tets[n] = mesh.tets[tet];
    regions[n++] = regions[tet];
  }
  const std::size_t n_removed = gone.size() - n;
  if (n_removed == 0) return 0;
  mesh.tets.resize(n);
  regions.resize(n);
  adjacency = make_adjacency(mesh);
  surface.adjacency = make_adjacency(TriangleView{surface.points, surface.triangles()}, Junctions::open);
  return n_removed;
}

}  // namespace framehex
