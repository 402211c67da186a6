// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/geometry/predicates.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/observer.hpp"
#include "framehex/surface/detail/box_tree.hpp"

#include <algorithm>
#include <limits>
#include <sstream>

namespace framehex {

namespace detail {

/// Least axis along which a, b and c do not fall on one line, exactly; 3 when they are on one line in space.
inline int projection_axis(const Vector3& a, const Vector3& b, const Vector3& c) {
  int axis = 0;
  while (axis < 3 && projected_orientation(axis, a, b, c) == 0) ++axis;
  return axis;
}

/// Do two closed segments of one plane meet, seen along an axis that is not in it?
inline bool segments_meet(int axis, const Vector3& p, const Vector3& q, const Vector3& a, const Vector3& b) {
  const int pq_a = projected_orientation(axis, p, q, a), pq_b = projected_orientation(axis, p, q, b);
  const int ab_p = projected_orientation(axis, a, b, p), ab_q = projected_orientation(axis, a, b, q);
  if (pq_a != 0 || pq_b != 0 || ab_p != 0 || ab_q != 0) return pq_a * pq_b <= 0 && ab_p * ab_q <= 0;
  // On one line: compare boxes.
  return (p.cwiseMax(q).array() >= a.cwiseMin(b).array()).all() &&
         (a.cwiseMax(b).array() >= p.cwiseMin(q).array()).all();
}

/// The same in space.
inline bool segments_meet(const Vector3& p, const Vector3& q, const Vector3& a, const Vector3& b) {
  if (orientation(p, q, a, b) != 0) return false;
  const std::array<int, 4> axes{projection_axis(p, q, a), projection_axis(p, q, b), projection_axis(a, b, p),
                                projection_axis(a, b, q)};
  // All on one line: the axis does not matter.
  return segments_meet(*std::min_element(axes.begin(), axes.end()) % 3, p, q, a, b);
}

/// Three points, and tests of points, segments and other triangles against them, all by exact predicates.
class ExactTriangle {
public:
  ExactTriangle(const Vector3& a, const Vector3& b, const Vector3& c)
      : corners_{a, b, c}, axis_(projection_axis(a, b, c)) {}

  const Vector3& corner(std::size_t i) const { return corners_[i]; }

  /// Are the corners on one line?
  bool is_degenerate() const { return axis_ == 3; }

  /// Along which the triangle has an area; 3 when it is degenerate.
  int axis() const { return axis_; }

  /// Does the closed segment pq meet the closed triangle?
  bool meets(const Vector3& p, const Vector3& q) const {
    if (is_degenerate()) return meets_an_edge([&](const auto& a, const auto& b) { return segments_meet(p, q, a, b); });
    const auto& [a, b, c] = corners_;
    const int side_p = orientation(a, b, c, p), side_q = orientation(a, b, c, q);
    if (side_p * side_q > 0) return false;
    if (side_p == 0 && side_q == 0) return meets_in_plane(p, q);
    return have_one_sign(orientation(p, q, a, b), orientation(p, q, b, c), orientation(p, q, c, a));
  }

  /// Does the edge that begins at corner i meet another triangle?
  bool edge_meets(std::size_t i, const ExactTriangle& other) const {
    return other.meets(corners_[i], corners_[(i + 1) % 3]);
  }

  /// Does a ray from corner 0 leave this triangle at a point of another? A degenerate one it leaves at an end.
  bool far_side_meets(const ExactTriangle& other) const {
    return is_degenerate() ? other.meets(corners_[1], corners_[1]) || other.meets(corners_[2], corners_[2])
                           : edge_meets(1, other);
  }

private:
  static bool have_one_sign(int a, int b, int c) {
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
  }

  template <class Meets>
  bool meets_an_edge(Meets&& meets) const {
    return meets(corners_[0], corners_[1]) || meets(corners_[1], corners_[2]) || meets(corners_[2], corners_[0]);
  }

  bool meets_in_plane(const Vector3& p, const Vector3& q) const {
    const auto& [a, b, c] = corners_;
    return have_one_sign(projected_orientation(axis_, a, b, p), projected_orientation(axis_, b, c, p),
                         projected_orientation(axis_, c, a, p)) ||
           meets_an_edge([&](const auto& u, const auto& v) { return segments_meet(axis_, p, q, u, v); });
  }

  std::array<Vector3, 3> corners_;
  int axis_;
};

/// Are two triangles with a common edge, from their first corner to their second, folded on one another?
inline bool are_folded(const ExactTriangle& s, const ExactTriangle& t) {
  const Vector3 &a = s.corner(0), &b = s.corner(1), &p = s.corner(2), &q = t.corner(2);
  // Null triangles stay on the line of the edge, which another meets in the edge only.
  if (s.is_degenerate() && t.is_degenerate()) {
    const auto beyond = [](const Vector3& from, const Vector3& end, const Vector3& x) {
      return ((end - from).array() * (x - end).array() > 0).any();
    };
    return (beyond(a, b, p) && beyond(a, b, q)) || (beyond(b, a, p) && beyond(b, a, q));
  }
  if (s.is_degenerate() || t.is_degenerate() || orientation(a, b, p, q) != 0) return false;
  return projected_orientation(s.axis(), a, b, p) == projected_orientation(s.axis(), a, b, q);
}

/// Is there a plane between two triangles without common points, beyond any rounding? Spares the exact predicates
/// nearly all pairs.
inline bool are_plainly_apart(const std::array<Vector3, 3>& s, const std::array<Vector3, 3>& t) {
  // Any axis will do, however it was rounded: what counts is that the triangles do not overlap along it.
  const auto beyond = [](const std::array<Vector3, 3>& a, const std::array<Vector3, 3>& b, const Vector3& axis) {
    double high = -std::numeric_limits<double>::infinity(), low = -high, size = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3 u = a[i] - a[0], v = b[i] - a[0];
      high = std::max(high, axis.dot(u));
      low = std::min(low, axis.dot(v));
      size = std::max({size, u.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff()});
    }
    const double unit = size * axis.cwiseAbs().maxCoeff();
    return unit > 1e-250 && low - high > 1e-10 * unit;
  };
  const auto apart = [&](const std::array<Vector3, 3>& a, const std::array<Vector3, 3>& b) {
    const Vector3 n = (a[1] - a[0]).cross(a[2] - a[0]);
    for (std::size_t i = 0; i < 3; ++i)
      if (beyond(a, b, (a[(i + 1) % 3] - a[i]).cross(n))) return true;
    return beyond(a, b, n) || beyond(a, b, -n);
  };
  return apart(s, t) || apart(t, s);
}

/// Do two triangles of a mesh have a point in common that is not on a shared edge or at a shared vertex?
inline bool triangles_cross(std::span<const Vector3> points, const std::array<index_t, 3>& s,
                            const std::array<index_t, 3>& t) {
  // Turn each so that what they share comes first.
  std::array<index_t, 3> u = s, v = t;
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = shared; j < 3; ++j)
      if (s[i] == v[j]) {
        std::swap(v[shared], v[j]);
        std::swap(*std::find(u.begin() + static_cast<std::ptrdiff_t>(shared), u.end(), s[i]), u[shared]);
        ++shared;
        break;
      }
  if (shared == 3) return true;
  if (shared == 0 &&
      are_plainly_apart({points[u[0]], points[u[1]], points[u[2]]}, {points[v[0]], points[v[1]], points[v[2]]}))
    return false;
  const ExactTriangle first(points[u[0]], points[u[1]], points[u[2]]), second(points[v[0]], points[v[1]], points[v[2]]);
  if (shared == 2) return are_folded(first, second);
  // With a common corner: a ray from it to another common point leaves one of the two within the other.
  if (shared == 1) return first.far_side_meets(second) || second.far_side_meets(first);
  for (std::size_t i = 0; i < 3; ++i)
    if (first.edge_meets(i, second) || second.edge_meets(i, first)) return true;
  return false;
}

/// See `find_self_intersections`. Stopped by the pulse: what has been found by then.
inline std::vector<std::array<index_t, 2>> find_crossings(std::span<const Vector3> points,
                                                          std::span<const std::array<index_t, 3>> triangles,
                                                          std::size_t max_pairs, Pulse& pulse) {
  std::vector<BoxTree::Bounds> boxes;
  boxes.reserve(triangles.size());
  for (const auto& t : triangles) boxes.push_back(triangle_bounds(points[t[0]], points[t[1]], points[t[2]]));
  const BoxTree tree(boxes);
  std::vector<std::array<index_t, 2>> pairs;
  for (index_t t = 0; t < boxes.size() && pairs.size() < max_pairs && pulse.beat(); ++t) {
    const auto begin = static_cast<std::ptrdiff_t>(pairs.size());
    tree.traverse(
        [&](const auto& bounds) { return bounds.meets(boxes[t]); },
        [&](index_t first, index_t count) {
          for (index_t i = first; i < first + count; ++i) {
            const index_t other = tree.order()[i];
            if (other > t && boxes[other].meets(boxes[t]) && triangles_cross(points, triangles[t], triangles[other]))
              pairs.push_back({t, other});
          }
        });
    std::sort(pairs.begin() + begin, pairs.end());
  }
  if (pairs.size() > max_pairs) pairs.resize(max_pairs);
  return pairs;
}

}  // namespace detail

/// Pairs of triangles of a surface that cross or touch where they should not.
///
/// Triangles may share vertices and edges by index; any other common point counts, exactly decided, so two parts that
/// touch in one coordinate are reported and two that pass at the last bit are not. A tetrahedraliser of the inside
/// refuses such surfaces.
///
/// @param mesh       indices in range.
/// @param max_pairs  the search stops when it has found so many.
/// @return pairs (smaller triangle first), sorted.
/// @par Complexity   O(n log n) for triangles that are not all in one place.
template <TriangleMesh M>
std::vector<std::array<index_t, 2>> find_self_intersections(const M& mesh,
                                                            std::size_t max_pairs = static_cast<std::size_t>(-1)) {
  const auto& surface = detail::flat(mesh);
  const Observer nobody;
  detail::Pulse pulse(nobody, "");
  return detail::find_crossings(surface.points, surface.triangles, max_pairs, pulse);
}

/// Refuses a surface that crosses or touches itself, before anything is made of it.
///
/// @param mesh  as for `find_self_intersections`.
/// @return false when cancelled.
/// @throws invalid_surface  naming two triangles, and a corner of one of them.
/// @par Complexity   O(n log n) for triangles that are not all in one place.
template <TriangleMesh M>
bool refuse_self_intersection(const M& mesh, const Observer& observer = {}) {
  const auto& surface = detail::flat(mesh);
  detail::Pulse pulse(observer, "self-intersections");
  const auto pairs = detail::find_crossings(surface.points, surface.triangles, 1, pulse);
  if (pulse.stopped()) return false;
  if (pairs.empty()) return true;
  const auto [s, t] = pairs.front();
  std::ostringstream message;
  message << "the surface crosses or touches itself: triangles " << s << " and " << t << " meet near ("
          << surface.points[surface.triangles[t][0]].transpose().format(
                 Eigen::IOFormat(Eigen::StreamPrecision, 0, ", ", ", "))
          << ')';
  throw invalid_surface(message.str(), Entity::triangle, {s, t});
}

}  // namespace framehex
