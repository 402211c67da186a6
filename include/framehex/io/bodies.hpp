// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/triangle_soup.hpp"
#include "framehex/surface/regions.hpp"

namespace framehex {

namespace detail {

/// Parts of a surface that are flat and joined across edges of two triangles, each with the edges round it.
class FlatParts {
public:
  using Edge = std::array<index_t, 2>;

  explicit FlatParts(const IndexedTriangleMesh& mesh) : mesh_(mesh), sets_(mesh.triangles.size()) {
    const EdgeUses edges(mesh);
    edges.for_each_edge([&](std::size_t i, std::size_t j) {
      const index_t h = edges.uses[i].half_edge;
      if (j - i == 2 && is_flat(h, edges.uses[i + 1].half_edge)) sets_.join(h / 3, edges.uses[i + 1].half_edge / 3);
    });
    rims_ = make_csr<Edge>(mesh.triangles.size(), [&](auto&& put) {
      edges.for_each_edge([&](std::size_t i, std::size_t j) {
        const bool is_inner =
            j - i == 2 && part_of(edges.uses[i].half_edge / 3) == part_of(edges.uses[i + 1].half_edge / 3);
        for (std::size_t k = i; k < j && !is_inner; ++k)
          put(part_of(edges.uses[k].half_edge / 3), Edge{edges.uses[k].low, edges.uses[k].high});
      });
    });
  }

  index_t part_of(index_t triangle) { return sets_.find(triangle); }

  /// Edges round the part whose first triangle this is, ascending.
  std::span<const Edge> rim(index_t part) const { return rims_[part]; }

private:
  /// Do two triangles lie in one plane, but for a millionth of their size?
  bool is_flat(index_t h, index_t g) const {
    const auto corner = [&](index_t k, index_t i) -> const Vector3& {
      return mesh_.points[mesh_.triangles[k / 3][(k + i) % 3]];
    };
    const Vector3 &a = corner(h, 0), &b = corner(h, 1), &c = corner(h, 2), &d = corner(g, 2);
    const Vector3 normal = (b - a).cross(c - a);
    const double size = std::max({(b - a).norm(), (c - a).norm(), (d - a).norm()});
    return normal.norm() > 0 && std::abs(normal.normalized().dot(d - a)) <= 1e-6 * size;
  }

  const IndexedTriangleMesh& mesh_;
  DisjointSets sets_;
  Csr<Edge> rims_;  // by first triangle
};

}  // namespace detail

/// Makes one wall of the faces in which two bodies touch: of flat parts within the same edges the first stays, however they
/// are cut into triangles. `turn_to_regions` makes the rest a complex for `mesh_surface`.
///
/// @param soup  the surfaces of bodies, welded; faces that touch have the same edges round them. Changed.
/// @return how many triangles were dropped.
/// @par Complexity   O(n log n).
inline std::size_t merge_walls(SoupSurface& soup) {
  auto& triangles = soup.surface.triangles;
  detail::FlatParts parts(soup.surface);
  std::vector<index_t> by_rim;
  for (index_t t = 0; t < triangles.size(); ++t)
    if (parts.part_of(t) == t) by_rim.push_back(t);
  std::stable_sort(by_rim.begin(), by_rim.end(), [&](index_t s, index_t t) {
    return std::ranges::lexicographical_compare(parts.rim(s), parts.rim(t));
  });
  std::vector<std::uint8_t> again(triangles.size(), 0);
  for (std::size_t i = 1; i < by_rim.size(); ++i)
    again[by_rim[i]] = std::ranges::equal(parts.rim(by_rim[i]), parts.rim(by_rim[i - 1]));
  for (index_t t = 0; t < triangles.size(); ++t) again[t] = again[parts.part_of(t)];
  const auto drop = [&](auto& rows) {
    if (rows.empty()) return;
    std::size_t n = 0;
    for (std::size_t t = 0; t < rows.size(); ++t)
      if (!again[t]) rows[n++] = rows[t];
    rows.resize(n);
  };
  const std::size_t n_before = triangles.size();
  drop(soup.soup_triangles);
  drop(soup.polygons);
  drop(soup.patches);
  drop(triangles);
  return n_before - triangles.size();
}

}  // namespace framehex
