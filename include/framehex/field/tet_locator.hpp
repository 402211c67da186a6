// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/triangle_distance.hpp"
#include "framehex/mesh/adjacency.hpp"
#include "framehex/surface/detail/box_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace framehex {

/// Where a point lies in a tetrahedral mesh.
struct TetLocation {
  index_t tet = no_index;               ///< `no_index` only when the mesh has no cells
  std::array<double, 4> barycentric{};  ///< of the point, or of the boundary point standing for it; >= 0, sum 1
  bool inside = false;
};

/// Finds tetrahedra by walking, and keeps the geometry that walking needs.
///
/// A walk from a good hint visits a handful of tetrahedra. Where it fails (a hole between hint and point, a cycle, no
/// hint) a uniform grid over the cells decides whether a tetrahedron holds the point, and a tree of boxes over the
/// boundary which place is nearest when none does: the answer does not depend on the hint but where tetrahedra touch.
///
/// All members are const and may be called from several threads at once.
class TetLocator {
public:
  TetLocator() = default;

  /// @param adjacency  of the mesh. @param points  one per vertex, in the host's unit.
  /// @par Complexity   O(n) for cells of similar size; about 20 bytes a tetrahedron and 60 a boundary facet beside what
  ///                   is passed in.
  TetLocator(TetAdjacency adjacency, std::vector<Vector3> points)
      : adjacency_(std::move(adjacency)), points_(std::move(points)) {
    build_grid();
    build_boundary();
  }

  const TetAdjacency& adjacency() const { return adjacency_; }
  const std::vector<Vector3>& points() const { return points_; }

  /// The tetrahedron holding `p`; outside the mesh, that of the boundary point nearest to `p`.
  ///
  /// @param hint  a tetrahedron near `p`, or `no_index`; any value is safe.
  /// @pre `p` is finite.
  /// @par Complexity   O(steps of the walk); with no hint or a failed walk, the cells of one grid box, and O(log n)
  ///                   outside.
  TetLocation locate(const Vector3& p, index_t hint = no_index) const {
    TetLocation best;
    if (adjacency_.tets.empty()) return best;
    if (hint < adjacency_.tets.size() && walk(p, hint, best)) return best;
    double distance = std::numeric_limits<double>::infinity();
    for (const index_t tet : boxes_[box_of(p)]) {
      const std::array<double, 4> b = barycentric(tet, p);
      if (*std::min_element(b.begin(), b.end()) >= -tolerance) return {tet, clamped(b), true};
      const TetLocation clipped{tet, clamped(b), false};
      const double d = (position(clipped) - p).squaredNorm();
      if (d >= distance) continue;
      best = clipped;
      distance = d;
    }
    // A point that no tetrahedron holds by its rounded coordinates, but that is nearer to one than they tell, is within
    // a sliver.
    if (distance <= negligible_) {
      best.inside = true;
      return best;
    }
    return nearest_on_boundary(p);
  }

  /// The point of a location.
  Vector3 position(const TetLocation& location) const {
    Vector3 p = Vector3::Zero();
    for (std::size_t i = 0; i < 4; ++i) p += location.barycentric[i] * points_[adjacency_.tets[location.tet][i]];
    return p;
  }

  /// Barycentric coordinates of `p` in a tetrahedron, negative beyond a facet.
  std::array<double, 4> barycentric(index_t tet, const Vector3& p) const {
    const auto& t = adjacency_.tets[tet];
    const Vector3& origin = points_[t[0]];
    const Vector3 u = points_[t[1]] - origin, v = points_[t[2]] - origin, w = points_[t[3]] - origin, x = p - origin;
    const Vector3 vw = v.cross(w);
    const double scale = 1 / u.dot(vw);
    const double b1 = x.dot(vw) * scale, b2 = x.dot(w.cross(u)) * scale, b3 = x.dot(u.cross(v)) * scale;
    return {1 - b1 - b2 - b3, b1, b2, b3};
  }

private:
  static constexpr double tolerance = 1e-9;

  static std::array<double, 4> clamped(std::array<double, 4> b) {
    double sum = 0;
    for (double& x : b) sum += x = std::isfinite(x) ? std::max(x, 0.0) : 0.0;
    for (double& x : b) x = sum > 0 ? x / sum : 0.25;
    return b;
  }

  /// Goes on through the facet beyond which `p` lies farthest. @return whether it arrives, in `found` then.
  bool walk(const Vector3& p, index_t tet, TetLocation& found) const {
    index_t from = no_index;
    for (std::size_t step = 0; step < max_steps_; ++step) {
      const std::array<double, 4> b = barycentric(tet, p);
      std::size_t exit = 4;
      bool beyond = false;
      for (std::size_t i = 0; i < 4; ++i) {
        if (b[i] >= -tolerance) continue;
        beyond = true;
        const index_t next = adjacency_.neighbours[tet][i];
        if (next != no_index && next != from && (exit == 4 || b[i] < b[exit])) exit = i;
      }
      if (!beyond) found = {tet, clamped(b), true};
      if (exit == 4) return !beyond;
      from = tet;
      tet = adjacency_.neighbours[tet][exit];
    }
    return false;
  }

  TetLocation nearest_on_boundary(const Vector3& p) const {
    std::size_t best = 0;
    TrianglePoint place{Vector3::Zero(), Vector3::Zero(), 0};
    double distance = std::numeric_limits<double>::infinity();
    boundary_.nearest(p, distance, [&](index_t first, index_t count) {
      for (index_t i = first; i < first + count; ++i) {
        const auto [tet, opposite] = facets_[boundary_.order()[i]];
        const auto v = facet(adjacency_.tets[tet], opposite);
        const TrianglePoint q = nearest_on_triangle(p, points_[v[0]], points_[v[1]], points_[v[2]]);
        if (q.squared_distance > distance || (q.squared_distance == distance && boundary_.order()[i] > best)) continue;
        best = boundary_.order()[i];
        place = q;
        distance = q.squared_distance;
      }
      return distance;
    });
    const auto [tet, opposite] = facets_[best];
    const auto v = facet(adjacency_.tets[tet], opposite);
    std::array<double, 4> weights{};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t corner = 0; corner < 3; ++corner)
        if (adjacency_.tets[tet][i] == v[corner]) weights[i] = place.barycentric[static_cast<int>(corner)];
    return {tet, clamped(weights), false};
  }

  std::array<std::size_t, 3> cell_of(const Vector3& p) const {
    std::array<std::size_t, 3> cell{};
    for (int i = 0; i < 3; ++i) {
      const auto n = static_cast<double>(n_boxes_[static_cast<std::size_t>(i)]);
      const double x = (p[i] - low_[i]) * inverse_side_;
      cell[static_cast<std::size_t>(i)] = x > 0 ? static_cast<std::size_t>(std::min(x, n - 1)) : 0;  // NaN: 0
    }
    return cell;
  }
  std::size_t number(const std::array<std::size_t, 3>& c) const {
    return c[0] + n_boxes_[0] * (c[1] + n_boxes_[1] * c[2]);
  }
  std::size_t box_of(const Vector3& p) const { return number(cell_of(p)); }

  void build_grid() {
    if (adjacency_.tets.empty()) return;
    low_ = points_[adjacency_.tets[0][0]];
    Vector3 high = low_;
    for (const auto& tet : adjacency_.tets)
      for (const index_t v : tet) {
        low_ = low_.cwiseMin(points_[v]);
        high = high.cwiseMax(points_[v]);
      }
    // About one box for six tetrahedra, and not more boxes than that in a thin domain.
    const auto n = static_cast<double>(adjacency_.tets.size());
    const Vector3 extent = (high - low_).cwiseMax(1e-6 * (high - low_).maxCoeff());
    const double side = std::cbrt(6 * extent.prod() / n);
    inverse_side_ = side > 0 ? 1 / side : 0;
    for (int i = 0; i < 3; ++i)
      n_boxes_[static_cast<std::size_t>(i)] =
          static_cast<std::size_t>(std::clamp(extent[i] * inverse_side_, 0.0, n)) + 1;
    boxes_ = make_csr(n_boxes_[0] * n_boxes_[1] * n_boxes_[2], [&](auto&& put) {
      for (std::size_t tet = 0; tet < adjacency_.tets.size(); ++tet) {
        const auto& t = adjacency_.tets[tet];
        Vector3 a = points_[t[0]], b = a;
        for (std::size_t i = 1; i < 4; ++i) {
          a = a.cwiseMin(points_[t[i]]);
          b = b.cwiseMax(points_[t[i]]);
        }
        const double slack = 1e-9 * extent.maxCoeff();
        const auto first = cell_of(a.array() - slack), last = cell_of(b.array() + slack);
        for (std::size_t z = first[2]; z <= last[2]; ++z)
          for (std::size_t y = first[1]; y <= last[1]; ++y)
            for (std::size_t x = first[0]; x <= last[0]; ++x) put(number({x, y, z}), static_cast<index_t>(tet));
      }
    });
    negligible_ = 1e-24 * extent.squaredNorm();
    max_steps_ = 100 + 4 * static_cast<std::size_t>(std::cbrt(n));
  }

  void build_boundary() {
    std::vector<detail::BoxTree::Bounds> bounds;
    for (index_t tet = 0; tet < adjacency_.tets.size(); ++tet)
      for (std::size_t i = 0; i < 4; ++i) {
        if (adjacency_.neighbours[tet][i] != no_index) continue;
        const auto v = facet(adjacency_.tets[tet], static_cast<int>(i));
        bounds.push_back(detail::triangle_bounds(points_[v[0]], points_[v[1]], points_[v[2]]));
        facets_.push_back({tet, static_cast<int>(i)});
      }
    boundary_ = detail::BoxTree(bounds);
  }

  struct Facet {
    index_t tet;
    int opposite;  // corner
  };

  TetAdjacency adjacency_;
  std::vector<Vector3> points_;
  Vector3 low_ = Vector3::Zero();
  double inverse_side_ = 0;
  std::array<std::size_t, 3> n_boxes_{};
  Csr<index_t> boxes_;
  double negligible_ = 0;  // a squared distance
  std::size_t max_steps_ = 0;
  std::vector<Facet> facets_;  // of the boundary
  detail::BoxTree boundary_;
};

}  // namespace framehex
