// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/surface_soup.hpp"

namespace framehex {

/// What was done to the triangles of a file.
struct SoupRepair {
  double weld_tolerance = 0;   ///< vertices this near along each axis became one; 0: only equal ones
  std::size_t n_repeated = 0;  ///< triangles dropped because they stand more than once
  std::size_t n_split = 0;     ///< vertices in the middle of another triangle's edge, which was split there
  bool closed = false;         ///< in the end
};

/// What becomes of faces in which two bodies stand face to face, cut into the same triangles.
enum class TouchingFaces {
  opened,   ///< both go: the bodies become one
  divided,  ///< one stays, between the two
};

namespace detail {

class SoupRepairer {
public:
  SoupRepairer(SurfaceSoup& soup, TouchingFaces touching) : soup_(soup), touching_(touching) {}

  SoupRepair run(double largest_tolerance) {
    Eigen::AlignedBox3d box;
    for (const Vector3& p : soup_.mesh.points)
      if (p.allFinite()) box.extend(p);
    const double size = box.diagonal().norm();
    const SurfaceSoup original = soup_;
    // The least tolerance that closes the surface moves the least.
    for (double tolerance = 0; tolerance <= largest_tolerance; tolerance = tolerance == 0 ? 1e-7 : 10 * tolerance) {
      soup_ = original;
      report_ = {};
      report_.weld_tolerance = tolerance * size;
      weld_vertices(tolerance * size);
      drop_repeated();
      split_edges(std::max(tolerance, 1e-9) * size);
      report_.closed = is_closed();
      if (report_.closed) break;
    }
    return report_;
  }

private:
  bool is_closed() const {
    const EdgeUses edges(soup_.mesh);
    if (touching_ == TouchingFaces::opened) return edges.closed();
    bool closed = true;
    edges.for_each_edge([&](std::size_t i, std::size_t j) { closed &= j - i > 1; });
    return closed;
  }

  void keep(const std::vector<index_t>& triangles) {
    std::vector<index_t> polygons, patches;
    for (const index_t t : triangles) {
      polygons.push_back(soup_.polygons[t]);
      if (!soup_.patches.empty()) patches.push_back(soup_.patches[t]);
    }
    soup_.polygons = std::move(polygons);
    soup_.patches = std::move(patches);
  }

  void weld_vertices(double tolerance) {
    std::vector<index_t> kept;
    soup_.mesh = weld(soup_.mesh, tolerance, kept);
    keep(kept);
  }

  /// Of triangles with the same three vertices one stays, but none, where touching faces are opened, that two or more
  /// different others meet at most edges, in pairs: those are walls between bodies.
  void drop_repeated() {
    auto& triangles = soup_.mesh.triangles;
    std::vector<std::array<index_t, 4>> keys;
    for (index_t t = 0; t < triangles.size(); ++t) {
      std::array<index_t, 3> v = triangles[t];
      std::sort(v.begin(), v.end());
      keys.push_back({v[0], v[1], v[2], t});
    }
    std::sort(keys.begin(), keys.end());
    const auto same = [&](std::size_t i, std::size_t j) {
      return std::equal(keys[i].begin(), keys[i].begin() + 3, keys[j].begin());
    };
    IndexedTriangleMesh different;
    for (std::size_t i = 0; i < keys.size(); ++i)
      if (i == 0 || !same(i - 1, i)) different.triangles.push_back({keys[i][0], keys[i][1], keys[i][2]});
    const EdgeUses edges(different);
    std::vector<std::uint8_t> stays(triangles.size(), 1);
    for (std::size_t i = 0, j = 0; i < keys.size(); i = j) {
      while (j < keys.size() && same(i, j)) ++j;
      if (j - i == 1) continue;
      int n_walls = 0;
      for (const auto& [a, b] : {std::pair(0u, 1u), std::pair(1u, 2u), std::pair(0u, 2u)}) {
        const std::size_t n_others = n_uses(edges, keys[i][a], keys[i][b]) - 1;
        n_walls += n_others > 0 && n_others % 2 == 0;
      }
      const bool opened = touching_ == TouchingFaces::opened && n_walls >= 2;
      for (std::size_t k = i + (opened ? 0 : 1); k < j; ++k) stays[keys[k][3]] = 0;
    }
    std::vector<index_t> kept;
    std::vector<std::array<index_t, 3>> left;
    for (index_t t = 0; t < triangles.size(); ++t)
      if (stays[t]) kept.push_back(t), left.push_back(triangles[t]);
    report_.n_repeated = triangles.size() - left.size();
    triangles = std::move(left);
    keep(kept);
  }

  static std::size_t n_uses(const EdgeUses& edges, index_t low, index_t high) {
    const auto less = [](const EdgeUses::Use& u, const std::pair<index_t, index_t>& e) {
      return std::pair(u.low, u.high) < e;
    };
    const auto first = std::lower_bound(edges.uses.begin(), edges.uses.end(), std::pair(low, high), less);
    const auto last = std::lower_bound(edges.uses.begin(), edges.uses.end(), std::pair(low, high + 1), less);
    return static_cast<std::size_t>(last - first);
  }

  /// Splits open edges at vertices of other open edges that lie in their middle, until there are none. Each round
  /// splits each triangle once at most, and no triangle twice at one vertex, so it ends.
  void split_edges(double tolerance) {
    for (std::size_t n_split = 1; n_split > 0;) {
      n_split = split_once(tolerance);
      report_.n_split += n_split;
    }
  }

  std::size_t split_once(double tolerance) {
    IndexedTriangleMesh& mesh = soup_.mesh;
    std::vector<index_t> open, vertices;  // half edges, and their ends by abscissa
    const EdgeUses edges(mesh);
    edges.for_each_edge([&](std::size_t i, std::size_t j) {
      if (j - i != 1) return;
      open.push_back(edges.uses[i].half_edge);
      vertices.push_back(edges.uses[i].low);
      vertices.push_back(edges.uses[i].high);
    });
    const auto& p = mesh.points;
    const auto by_x = [&](index_t a, index_t b) { return std::pair(p[a].x(), a) < std::pair(p[b].x(), b); };
    std::sort(vertices.begin(), vertices.end(), by_x);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    std::sort(open.begin(), open.end());
    std::size_t n_split = 0;
    index_t last_triangle = no_index;
    for (const index_t h : open) {
      const index_t t = h / 3;
      if (t == last_triangle) continue;
      const index_t a = mesh.triangles[t][h % 3], b = mesh.triangles[t][(h + 1) % 3],
                    c = mesh.triangles[t][(h + 2) % 3];
      const index_t v = nearest_on_edge(vertices, a, b, c, tolerance);
      if (v == no_index) continue;
      last_triangle = t;
      mesh.triangles[t] = {a, v, c};
      mesh.triangles.push_back({v, b, c});
      soup_.polygons.push_back(soup_.polygons[t]);
      if (!soup_.patches.empty()) soup_.patches.push_back(soup_.patches[t]);
      ++n_split;
    }
    return n_split;
  }

  /// The vertex strictly between a and b, and off them and c, that is nearest to a.
  index_t nearest_on_edge(const std::vector<index_t>& vertices, index_t a, index_t b, index_t c,
                          double tolerance) const {
    const auto& p = soup_.mesh.points;
    const Vector3 edge = p[b] - p[a];
    const double length = edge.norm();
    const double low = std::min(p[a].x(), p[b].x()) - tolerance, high = std::max(p[a].x(), p[b].x()) + tolerance;
    index_t best = no_index;
    double best_along = 0;
    for (auto at =
             std::lower_bound(vertices.begin(), vertices.end(), low, [&](index_t v, double x) { return p[v].x() < x; });
         at != vertices.end() && p[*at].x() <= high; ++at) {
      const index_t v = *at;
      if (v == a || v == b || v == c) continue;
      const double along = (p[v] - p[a]).dot(edge) / length;
      if (!(along > tolerance && along < length - tolerance)) continue;
      if (!((p[v] - p[a]).cross(edge).norm() <= tolerance * length)) continue;
      if (best == no_index || along < best_along) best = v, best_along = along;
    }
    return best;
  }

  SurfaceSoup& soup_;
  TouchingFaces touching_;
  SoupRepair report_;
};

}  // namespace detail

/// Mends what writers of surfaces often get wrong: vertices that differ by noise are welded, triangles that stand twice
/// dropped, and edges with a vertex of another triangle in their middle split there.
///
/// @param soup               the triangles of a file; changed. Numbers of polygons and patches are kept.
/// @param largest_tolerance  the most that vertices are moved to close the surface, by the diagonal of its box; the
///                           powers of ten from 1e-7 are tried, and the least that closes it is taken.
/// @param touching           what becomes of faces in which two bodies touch.
/// @return what was done. Where the surface does not close, that with the largest tolerance: `closed` is false.
/// @throws invalid_coordinate, invalid_connectivity  with the vertex or triangle.
/// @par Complexity   O(n log n) but for many open edges of one abscissa.
/// @par Determinism  Vertices and triangles keep their order.
inline SoupRepair repair_soup(SurfaceSoup& soup, double largest_tolerance = 1e-4,
                              TouchingFaces touching = TouchingFaces::opened) {
  detail::check_soup(soup.mesh);
  return detail::SoupRepairer(soup, touching).run(largest_tolerance);
}

}  // namespace framehex
