// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/predicates.hpp"
#include "framehex/geometry/triangle_distance.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/surface/detail/box_tree.hpp"
#include "framehex/surface/surface_point.hpp"

#include <cmath>
#include <limits>
#include <optional>

namespace framehex {

namespace detail {

/// How often, and which way, segment pq passes through triangle abc: -1, 0 or 1; `nullopt` when it only touches, that
/// is when an exact determinant vanishes.
inline std::optional<int> crossing(const Vector3& p, const Vector3& q, const Vector3& a, const Vector3& b,
                                   const Vector3& c) {
  const int side_p = orientation(a, b, c, p), side_q = orientation(a, b, c, q);
  if (side_p * side_q > 0) return 0;
  const int ab = orientation(p, q, a, b), bc = orientation(p, q, b, c), ca = orientation(p, q, c, a);
  if ((ab > 0 || bc > 0 || ca > 0) && (ab < 0 || bc < 0 || ca < 0)) return 0;
  if (side_p == 0 || side_q == 0 || ab == 0 || bc == 0 || ca == 0) return std::nullopt;
  return side_p < 0 ? 1 : -1;
}

}  // namespace detail

/// Where a ray meets a surface.
struct RayHit {
  index_t triangle;
  double distance;  ///< from the ray's begin, > 0
};

/// Nearest points on a triangulated surface, what a ray meets first, and which side of it a point is on.
///
/// Keeps a copy of the triangles' coordinates in the order of a box tree. All queries are const and safe from several
/// threads at once; results depend on the surface only.
/// @par Complexity   O(n log n) to build, about 150 bytes a triangle; O(log n) a query for points near the surface.
class SurfaceLocator {
public:
  SurfaceLocator() = default;

  /// @param mesh  triangle indices in range; need not be closed but for `inside`.
  template <TriangleMesh M>
  explicit SurfaceLocator(const M& mesh) {
    const auto& surface = detail::flat(mesh);
    std::vector<detail::BoxTree::Bounds> boxes;
    boxes.reserve(surface.triangles.size());
    for (const auto& t : surface.triangles)
      boxes.push_back(detail::triangle_bounds(surface.points[t[0]], surface.points[t[1]], surface.points[t[2]]));
    tree_ = detail::BoxTree(boxes);
    corners_.reserve(boxes.size());
    for (const index_t item : tree_.order()) {
      const auto& t = surface.triangles[item];
      corners_.push_back({surface.points[t[0]], surface.points[t[1]], surface.points[t[2]]});
    }
  }

  bool empty() const { return corners_.empty(); }

  /// Nearest point of the surface; on the triangle of least index when several are equally near.
  /// @pre the surface has a triangle.
  SurfacePoint nearest(const Vector3& query) const {
    return *nearest_within(query, std::numeric_limits<double>::infinity());
  }

  /// The same, but nothing when the surface is farther than `radius`: much the faster for points deep inside.
  std::optional<SurfacePoint> nearest_within(const Vector3& query, double radius) const {
    double best = radius * radius;
    std::optional<SurfacePoint> result;
    tree_.nearest(query, best, [&](index_t first, index_t count) {
      for (index_t i = first; i < first + count; ++i) {
        const TrianglePoint p = nearest_on_triangle(query, corners_[i][0], corners_[i][1], corners_[i][2]);
        const index_t id = tree_.order()[i];
        if (p.squared_distance > best || (p.squared_distance == best && result && id > result->triangle)) continue;
        best = p.squared_distance;
        result = SurfacePoint{id, p.barycentric, p.point, std::sqrt(best)};
      }
      return best;
    });
    return result;
  }

  /// Calls `visit(triangle)` for each triangle whose box meets the closed box [low, high].
  template <class Visit>
  void in_box(const Vector3& low, const Vector3& high, Visit&& visit) const {
    auto box = detail::BoxTree::Bounds::none();
    box.add(low);
    box.add(high);
    tree_.traverse([&](const auto& bounds) { return bounds.meets(box); },
                   [&](index_t first, index_t count) {
                     for (index_t i = first; i < first + count; ++i) {
                       if (detail::triangle_bounds(corners_[i][0], corners_[i][1], corners_[i][2]).meets(box))
                         visit(tree_.order()[i]);
                     }
                   });
  }

  /// What a ray meets first, within a distance; nothing when it only runs along triangles.
  ///
  /// In floating point: a ray through an edge meets one of its triangles or, at worst, passes between them.
  /// @param direction  a unit vector. @param but  a triangle that is passed through: the one from which the ray starts.
  std::optional<RayHit> first_hit(const Vector3& from, const Vector3& direction, double reach,
                                  index_t but = no_index) const {
    std::optional<RayHit> result;
    double best = reach;
    tree_.traverse([&](const auto& bounds) { return bounds.meets_ray(from, direction, best); },
                   [&](index_t first, index_t count) {
                     for (index_t i = first; i < first + count; ++i) {
                       const index_t id = tree_.order()[i];
                       const double at = id == but ? -1 : distance_along(from, direction, corners_[i]);
                       if (!(at > 0) || at > best || (result && at == best && id > result->triangle)) continue;
                       best = at;
                       result = RayHit{id, at};
                     }
                   });
    return result;
  }

  /// Is the point inside the closed surface? A point exactly on it counts as outside.
  ///
  /// Adds up signed crossings of a segment that leaves the box, decided by exact predicates, so the answer is right for
  /// the coordinates as stored, also next to needles and on planes of the surface.
  ///
  /// @pre the surface is closed and consistently oriented; its parts may be nested.
  /// @par Departs   A segment that touches an edge or a vertex is replaced by another, up to 16 times.
  bool inside(const Vector3& query) const {
    if (tree_.nodes().empty()) return false;
    const auto& bounds = tree_.nodes().front().bounds;
    for (std::size_t i = 0; i < 3; ++i) {
      const double x = query[static_cast<int>(i)];
      if (x < bounds.low[i] || x > bounds.high[i]) return false;
    }
    for (int attempt = 0; attempt < 16; ++attempt)
      if (const auto winding = winding_number(query, far_point(query, attempt))) return *winding != 0;
    return false;
  }

private:
  /// How far along a ray a triangle is; negative when it is missed.
  ///
  /// T. Moeller, B. Trumbore, J. Graph. Tools 2 (1997) 21-28.
  static double distance_along(const Vector3& from, const Vector3& direction, const std::array<Vector3, 3>& t) {
    const Vector3 ab = t[1] - t[0], ac = t[2] - t[0], across = direction.cross(ac), begin = from - t[0];
    const double determinant = ab.dot(across);
    if (std::abs(determinant) <= 1e-14 * ab.norm() * ac.norm()) return -1;
    const double u = begin.dot(across) / determinant;
    const Vector3 turned = begin.cross(ab);
    const double v = direction.dot(turned) / determinant;
    return u >= 0 && v >= 0 && u + v <= 1 ? ac.dot(turned) / determinant : -1;
  }

  /// End of a segment that leaves the box by the nearest side, tilted differently at each attempt.
  Vector3 far_point(const Vector3& query, int attempt) const {
    const auto& bounds = tree_.nodes().front().bounds;
    double way = std::numeric_limits<double>::infinity();
    int axis = 0;
    double sign = 1, diagonal = 0;
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      diagonal += bounds.high[k] - bounds.low[k];
      const double up = bounds.high[k] - query[i], down = query[i] - bounds.low[k];
      if (std::min(up, down) < way) {
        way = std::min(up, down);
        axis = i;
        sign = up < down ? 1 : -1;
      }
    }
    const double length = 1.01 * way + 1e-3 * diagonal, tilt = length * (0.013 + 0.05 * attempt);
    Vector3 target = query;
    target[axis] += sign * length;
    target[(axis + 1) % 3] += tilt * std::cos(1.0 + 2.4 * attempt);
    target[(axis + 2) % 3] += tilt * std::sin(1.0 + 2.4 * attempt);
    return target;
  }

  std::optional<int> winding_number(const Vector3& p, const Vector3& q) const {
    auto box = detail::BoxTree::Bounds::none();
    box.add(p);
    box.add(q);
    int winding = 0;
    bool touches = false;
    tree_.traverse([&](const auto& bounds) { return !touches && bounds.meets(box); },
                   [&](index_t first, index_t count) {
                     for (index_t i = first; i < first + count; ++i) {
                       const auto& t = corners_[i];
                       if (!detail::triangle_bounds(t[0], t[1], t[2]).meets(box)) continue;
                       const auto sign = detail::crossing(p, q, t[0], t[1], t[2]);
                       if (sign)
                         winding += *sign;
                       else
                         touches = true;
                     }
                   });
    return touches ? std::nullopt : std::optional<int>(winding);
  }

  detail::BoxTree tree_;
  std::vector<std::array<Vector3, 3>> corners_;  ///< in the order of the tree's leaves
};

}  // namespace framehex
