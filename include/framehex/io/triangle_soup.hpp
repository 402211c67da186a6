// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/mesh/indexed_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

namespace framehex {

/// What a file of triangles comes to: a surface whose triangles share vertices and look outward.
struct SoupSurface {
  IndexedTriangleMesh surface;
  std::vector<index_t> soup_triangles;  ///< of each triangle of the surface, its number in the soup
  std::vector<index_t> polygons;        ///< of each triangle of the surface, its polygon's number in the file, or empty
  std::vector<index_t> patches;         ///< of each triangle of the surface, its label in the file, or empty
  std::vector<std::string> patch_names;  ///< by label
  std::size_t n_soup_vertices = 0;       ///< before welding
  std::size_t n_dropped_triangles = 0;   ///< two corners welded into one
  std::size_t n_turned_triangles = 0;    ///< orientation was changed
  std::size_t n_cavities = 0;            ///< closed parts that lie in an odd number of others
  bool welded_by_tolerance = false;      ///< equal coordinates were not enough to close the surface
  double rounding = 0;                   ///< most that a coordinate lost when the file was written in single precision
};

namespace detail {

/// Vertices with the same coordinates (or within `tolerance` along each axis, chains included) become one, the first;
/// those that no triangle uses go. `kept` becomes the soup's number of each triangle that stays.
inline IndexedTriangleMesh weld(const IndexedTriangleMesh& soup, double tolerance, std::vector<index_t>& kept) {
  const std::size_t n = soup.points.size();
  std::vector<index_t> order, parent(n);
  std::iota(parent.begin(), parent.end(), index_t{0});
  std::vector<std::uint8_t> used(n, 0);
  for (const auto& t : soup.triangles)
    for (const index_t v : t)
      if (!std::exchange(used[v], 1)) order.push_back(v);  // others may be anywhere, even NaN
  const auto& p = soup.points;
  std::sort(order.begin(), order.end(), [&](index_t a, index_t b) {
    return std::tuple(p[a].x(), p[a].y(), p[a].z(), a) < std::tuple(p[b].x(), p[b].y(), p[b].z(), b);
  });
  const auto root = [&](index_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && p[order[j]].x() - p[order[i]].x() <= tolerance; ++j) {
      const bool close = (p[order[j]] - p[order[i]]).cwiseAbs().maxCoeff() <= tolerance;
      // Without a tolerance equal points follow one another, and a run of equal abscissae need not be searched.
      if (!close && tolerance == 0) break;
      if (!close) continue;
      const index_t a = root(order[i]), b = root(order[j]);
      parent[std::max(a, b)] = std::min(a, b);
      if (tolerance == 0) break;
    }

  IndexedTriangleMesh welded;
  std::fill(used.begin(), used.end(), std::uint8_t{0});
  kept.clear();
  for (index_t number = 0; number < soup.triangles.size(); ++number) {
    const auto& t = soup.triangles[number];
    const std::array<index_t, 3> corners{root(t[0]), root(t[1]), root(t[2])};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    welded.triangles.push_back(corners);
    kept.push_back(number);
    for (const index_t v : corners) used[v] = 1;
  }
  std::vector<index_t> number(n, no_index);
  for (index_t v = 0; v < n; ++v) {
    if (!used[v]) continue;
    number[v] = static_cast<index_t>(welded.points.size());
    welded.points.push_back(p[v]);
  }
  for (auto& t : welded.triangles)
    for (index_t& v : t) v = number[v];
  return welded;
}

/// Edges by their two vertices, each with the half edges along it.
struct EdgeUses {
  struct Use {
    index_t low, high, half_edge;
  };
  std::vector<Use> uses;  // sorted

  explicit EdgeUses(const IndexedTriangleMesh& mesh) {
    for (index_t t = 0; t < mesh.triangles.size(); ++t)
      for (index_t i = 0; i < 3; ++i) {
        const index_t a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
        uses.push_back({std::min(a, b), std::max(a, b), 3 * t + i});
      }
    std::sort(uses.begin(), uses.end(), [](const Use& x, const Use& y) {
      return std::tie(x.low, x.high, x.half_edge) < std::tie(y.low, y.high, y.half_edge);
    });
  }

  /// Calls body(first, last) for the uses of each edge.
  template <class Body>
  void for_each_edge(Body&& body) const {
    for (std::size_t i = 0, j = 0; i < uses.size(); i = j) {
      while (j < uses.size() && uses[j].low == uses[i].low && uses[j].high == uses[i].high) ++j;
      body(i, j);
    }
  }

  bool closed() const {
    bool all_even = true;
    for_each_edge([&](std::size_t i, std::size_t j) { all_even &= (j - i) % 2 == 0; });
    return all_even;
  }
};

/// Parts of a surface joined across edges of two triangles, and which triangles of a part look the other way.
struct SurfaceParts {
  std::vector<index_t> part;            // by triangle
  std::vector<std::uint8_t> turn;       // by triangle: against the part's first
  std::vector<std::uint8_t> one_sided;  // by part: no turning makes all neighbours agree
  index_t n_parts = 0;

  explicit SurfaceParts(const IndexedTriangleMesh& mesh) : part(mesh.triangles.size(), no_index), turn(part.size(), 0) {
    const EdgeUses edges(mesh);
    std::vector<index_t> across(3 * part.size(), no_index);
    edges.for_each_edge([&](std::size_t i, std::size_t j) {
      if (j - i != 2) return;
      across[edges.uses[i].half_edge] = edges.uses[i + 1].half_edge;
      across[edges.uses[i + 1].half_edge] = edges.uses[i].half_edge;
    });
    const auto from = [&](index_t h) { return mesh.triangles[h / 3][h % 3]; };
    std::vector<index_t> front;
    for (index_t seed = 0; seed < part.size(); ++seed) {
      if (part[seed] != no_index) continue;
      part[seed] = n_parts;
      one_sided.push_back(0);
      front.assign(1, seed);
      while (!front.empty()) {
        const index_t t = front.back();
        front.pop_back();
        for (index_t h = 3 * t; h < 3 * t + 3; ++h) {
          const index_t other = across[h];
          if (other == no_index) continue;
          const auto wanted = static_cast<std::uint8_t>(turn[t] ^ (from(h) == from(other)));
          if (part[other / 3] != no_index) {
            if (turn[other / 3] != wanted) one_sided[n_parts] = 1;
            continue;
          }
          part[other / 3] = n_parts;
          turn[other / 3] = wanted;
          front.push_back(other / 3);
        }
      }
      ++n_parts;
    }
  }
};

/// Whether a line from `p` along a direction in general position crosses the triangle.
inline bool crosses(const Vector3& p, const Vector3& direction, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 e = b - a, f = c - a, q = direction.cross(f);
  const double det = e.dot(q);
  if (det == 0) return false;
  const Vector3 s = p - a, r = s.cross(e);
  const double u = s.dot(q) / det, v = direction.dot(r) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && f.dot(r) / det > 0;
}

/// Turns triangles so that each part is of one orientation (its majority's), outer parts look outward and cavities
/// inward. Notes how many were turned, and how many cavities there are.
inline void orient(SoupSurface& soup) {
  IndexedTriangleMesh& mesh = soup.surface;
  SurfaceParts parts(mesh);
  std::vector<std::size_t> n(parts.n_parts, 0), n_turned(parts.n_parts, 0);
  std::vector<double> volume(parts.n_parts, 0.0);
  std::vector<Vector3> vertex(parts.n_parts);
  const auto corner = [&](std::size_t t, std::size_t i) -> const Vector3& { return mesh.points[mesh.triangles[t][i]]; };
  const Vector3 origin = mesh.points.empty() ? Vector3(0, 0, 0) : mesh.points[0];
  for (std::size_t t = mesh.triangles.size(); t-- > 0;) {
    const index_t k = parts.part[t];
    ++n[k];
    n_turned[k] += parts.turn[t];
    const double det = (corner(t, 0) - origin).dot((corner(t, 1) - origin).cross(corner(t, 2) - origin));
    volume[k] += parts.turn[t] ? -det : det;
    vertex[k] = corner(t, 0);  // of the part's first triangle in the end
  }
  // A part inside an odd number of others bounds a cavity. An arbitrary direction meets no edge but by bad luck.
  const Vector3 direction(0.4871, 0.3373, 0.8055);
  std::vector<std::uint8_t> is_cavity(parts.n_parts, 0);
  if (parts.n_parts > 1)
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (index_t k = 0; k < parts.n_parts; ++k)
        if (parts.part[t] != k && crosses(vertex[k], direction, corner(t, 0), corner(t, 1), corner(t, 2)))
          is_cavity[k] ^= 1;

  soup.n_cavities = static_cast<std::size_t>(std::count(is_cavity.begin(), is_cavity.end(), 1));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const index_t k = parts.part[t];
    if (parts.one_sided[k]) continue;  // errors are about the triangles as they came
    // Flat parts have no outside; they keep their majority's side.
    const bool turn_part = volume[k] == 0 ? 2 * n_turned[k] > n[k] : (volume[k] < 0) != (is_cavity[k] == 1);
    if ((parts.turn[t] != 0) == turn_part) continue;
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    ++soup.n_turned_triangles;
  }
}

}  // namespace detail

/// Cuts a polygon into triangles by clipping ears, convex or not, and appends them.
///
/// @param polygon  vertices of the soup, anticlockwise or clockwise; the triangles follow it. Fewer than three:
/// nothing.
/// @par Complexity   O(k^3) for k corners at worst, O(k^2) for convex ones.
inline void append_polygon(IndexedTriangleMesh& soup, std::vector<index_t> polygon) {
  const auto point = [&](std::size_t i) -> const Vector3& { return soup.points[polygon[i % polygon.size()]]; };
  Vector3 normal = Vector3::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) normal += (point(i) - point(0)).cross(point(i + 1) - point(0));
  while (polygon.size() > 3) {
    const std::size_t n = polygon.size();
    const auto side = [&](const Vector3& a, const Vector3& b, const Vector3& p) {
      return (b - a).cross(p - a).dot(normal);
    };
    const auto is_ear = [&](std::size_t i) {
      const Vector3 &a = point(i + n - 1), &b = point(i), &c = point(i + 1);
      if (!(side(a, b, c) > 0)) return false;
      for (std::size_t j = i + 2; j < i + n - 1; ++j)
        if (side(a, b, point(j)) >= 0 && side(b, c, point(j)) >= 0 && side(c, a, point(j)) >= 0) return false;
      return true;
    };
    std::size_t ear = 0;
    while (ear < n && !is_ear(ear)) ++ear;
    ear %= n;  // a degenerate polygon has none: any corner will do
    soup.triangles.push_back({polygon[(ear + n - 1) % n], polygon[ear], polygon[(ear + 1) % n]});
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  if (polygon.size() == 3) soup.triangles.push_back({polygon[0], polygon[1], polygon[2]});
}

namespace detail {

/// @throws invalid_coordinate, invalid_connectivity  with the vertex or triangle.
inline void check_soup(const IndexedTriangleMesh& soup) {
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    for (const index_t v : soup.triangles[t]) {
      if (v >= soup.points.size())
        throw invalid_connectivity("triangle " + std::to_string(t) + " refers to vertex " + std::to_string(v) + " of " +
                                       std::to_string(soup.points.size()),
                                   Entity::triangle, {t});
      if (!soup.points[v].allFinite())
        throw invalid_coordinate("vertex " + std::to_string(v) + " (of triangle " + std::to_string(t) +
                                     ") has a coordinate that is not finite",
                                 Entity::vertex, {v});
    }
}

}  // namespace detail

/// Makes a surface of triangles that need not know each other.
///
/// Vertices of equal coordinates are welded; where that leaves edges open and a tolerance of 1e-6 of the box's diagonal
/// closes them all, that is taken instead. Triangles are turned so that neighbours agree, outer shells look outward and
/// cavities inward; those of one-sided parts stay.
///
/// @param soup  triangles over vertices in any number, e.g. three of its own for each.
/// @return the surface and what was changed. It may still be open or non-manifold: `validate_closed` tells.
/// @throws invalid_coordinate, invalid_connectivity  with the vertex or triangle of the soup.
/// @par Complexity   O(n log n), and O(n) for each part of more than one.
/// @par Determinism  Vertices and triangles keep their order; of welded vertices the first stays.
inline SoupSurface surface_of_soup(const IndexedTriangleMesh& soup) {
  detail::check_soup(soup);
  SoupSurface result;
  result.n_soup_vertices = soup.points.size();
  result.surface = detail::weld(soup, 0.0, result.soup_triangles);
  if (!detail::EdgeUses(result.surface).closed()) {
    Eigen::AlignedBox3d box;
    for (const Vector3& p : result.surface.points) box.extend(p);
    std::vector<index_t> kept;
    IndexedTriangleMesh tolerant = detail::weld(soup, 1e-6 * box.diagonal().norm(), kept);
    if (detail::EdgeUses(tolerant).closed()) {
      result.surface = std::move(tolerant);
      result.soup_triangles = std::move(kept);
      result.welded_by_tolerance = true;
    }
  }
  result.n_dropped_triangles = soup.triangles.size() - result.surface.triangles.size();
  detail::orient(result);
  return result;
}

}  // namespace framehex
