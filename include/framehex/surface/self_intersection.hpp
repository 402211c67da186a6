// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/predicates.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/surface/detail/box_tree.hpp"

#include <cmath>
#include <limits>

namespace framehex {

namespace detail {

/// Three points, and tests of segments and other triangles against them, all by exact predicates.
class ExactTriangle {
public:
  ExactTriangle(const Vector3& a, const Vector3& b, const Vector3& c) : corners_{a, b, c} {}

  /// Does the closed segment pq meet the closed triangle?
  bool meets(const Vector3& p, const Vector3& q) const {
    const auto& [a, b, c] = corners_;
    const int side_p = orientation(a, b, c, p), side_q = orientation(a, b, c, q);
    if (side_p * side_q > 0) return false;
    if (side_p == 0 && side_q == 0) return meets_in_plane(p, q);
    const int ab = orientation(p, q, a, b), bc = orientation(p, q, b, c), ca = orientation(p, q, c, a);
    return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
  }

  /// A point off the plane, from which all points of the plane are seen in one sense: turns the exact predicate of
  /// space into one of the plane.
  Vector3 eye() const {
    const auto& [a, b, c] = corners_;
    const Vector3 n = (b - a).cross(c - a);
    int axis = 0;
    n.cwiseAbs().maxCoeff(&axis);
    Vector3 e = a;
    e[axis] += (b - a).cwiseAbs().maxCoeff() + (c - a).cwiseAbs().maxCoeff();
    return e;
  }

private:
  bool meets_in_plane(const Vector3& p, const Vector3& q) const {
    const auto& [a, b, c] = corners_;
    const Vector3 e = eye();
    const int ab_p = orientation(a, b, p, e), bc_p = orientation(b, c, p, e), ca_p = orientation(c, a, p, e);
    if ((ab_p >= 0 && bc_p >= 0 && ca_p >= 0) || (ab_p <= 0 && bc_p <= 0 && ca_p <= 0)) return true;
    for (std::size_t i = 0; i < 3; ++i)
      if (segments_meet(p, q, corners_[i], corners_[(i + 1) % 3], e)) return true;
    return false;
  }

  static bool segments_meet(const Vector3& p, const Vector3& q, const Vector3& a, const Vector3& b, const Vector3& e) {
    const int pq_a = orientation(p, q, a, e), pq_b = orientation(p, q, b, e);
    const int ab_p = orientation(a, b, p, e), ab_q = orientation(a, b, q, e);
    if (pq_a == 0 && pq_b == 0 && ab_p == 0 && ab_q == 0) {  // on one line: compare boxes
      for (int i = 0; i < 3; ++i)
        if (std::max(p[i], q[i]) < std::min(a[i], b[i]) || std::max(a[i], b[i]) < std::min(p[i], q[i])) return false;
      return true;
    }
    return pq_a * pq_b <= 0 && ab_p * ab_q <= 0;
  }

  std::array<Vector3, 3> corners_;
};

/// Is there a plane between two triangles, beyond any rounding, that touches them in what they share at most? Their
/// first `shared` points are common. Spares the exact predicates nearly all pairs, above all those of flat faces.
inline bool plainly_apart(const std::array<Vector3, 3>& s, const std::array<Vector3, 3>& t, std::size_t shared) {
  const auto beyond = [&](const std::array<Vector3, 3>& a, const std::array<Vector3, 3>& b, const Vector3& axis) {
    double high = -std::numeric_limits<double>::infinity(), low = -high, size = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3 u = a[i] - a[0], v = b[i] - a[0];
      high = std::max(high, axis.dot(u));
      if (i >= shared) low = std::min(low, axis.dot(v));
      size = std::max({size, u.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff()});
    }
    const double unit = size * axis.cwiseAbs().maxCoeff();
    if (shared == 2 && std::abs(axis.dot(a[1] - a[0])) > 1e-14 * unit) return false;
    return (shared == 0 || high < 1e-14 * unit) && low - high > 1e-10 * unit;
  };
  const auto apart = [&](const std::array<Vector3, 3>& a, const std::array<Vector3, 3>& b) {
    const Vector3 n = (a[1] - a[0]).cross(a[2] - a[0]);
    for (std::size_t i = 0; i < 3; ++i) {
      Vector3 outward = (a[(i + 1) % 3] - a[i]).cross(n);
      if (shared > 0 && outward.dot(a[(i + 2) % 3] - a[i]) > 0) outward = -outward;
      if (beyond(a, b, outward)) return true;
    }
    return beyond(a, b, n) || beyond(a, b, -n);
  };
  // The lines of edges often run on into the neighbour's edges, on lattices always: then this one lies between.
  const auto direction = [&](const std::array<Vector3, 3>& a) {
    return Vector3((a[1] - a[0]).stableNormalized() + (a[2] - a[0]).stableNormalized());
  };
  if (shared == 1 && beyond(s, t, direction(t) - direction(s))) return true;
  return apart(s, t) || apart(t, s);
}

/// Do two triangles of a mesh have a point in common that is not on a shared edge or at a shared vertex?
inline bool triangles_cross(const std::vector<Vector3>& points, const std::array<index_t, 3>& s,
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
  const auto p = [&](std::size_t i) -> const Vector3& { return points[u[i]]; };
  const auto q = [&](std::size_t i) -> const Vector3& { return points[v[i]]; };
  if (shared == 3) return true;
  if (plainly_apart({p(0), p(1), p(2)}, {q(0), q(1), q(2)}, shared)) return false;
  if (shared == 2) {  // only when one is folded back on the other
    if (orientation(p(0), p(1), p(2), q(2)) != 0) return false;
    const Vector3 e = ExactTriangle(p(0), p(1), p(2)).eye();
    return orientation(p(0), p(1), p(2), e) == orientation(p(0), p(1), q(2), e);
  }
  const ExactTriangle first(p(0), p(1), p(2)), second(q(0), q(1), q(2));
  if (first.meets(q(1), q(2)) || second.meets(p(1), p(2))) return true;
  if (shared == 1) return false;
  return first.meets(q(0), q(1)) || first.meets(q(2), q(0)) || second.meets(p(0), p(1)) || second.meets(p(2), p(0));
}

}  // namespace detail

/// Pairs of triangles of a surface that cross or touch where they should not.
///
/// Triangles may share vertices and edges by index; any other common point counts, exactly decided, so two parts that
/// touch in one coordinate are reported and two that pass at the last bit are not. A tetrahedraliser of the inside
/// refuses such surfaces.
///
/// @param surface    indices in range.
/// @param max_pairs  the search stops when it has found so many.
/// @return pairs (smaller triangle first), sorted.
/// @par Complexity   O(n log n) for triangles that are not all in one place.
inline std::vector<std::array<index_t, 2>> find_self_intersections(
    const IndexedTriangleMesh& surface, std::size_t max_pairs = static_cast<std::size_t>(-1)) {
  std::vector<detail::BoxTree::Bounds> boxes;
  boxes.reserve(surface.triangles.size());
  for (const auto& t : surface.triangles)
    boxes.push_back(detail::triangle_bounds(surface.points[t[0]], surface.points[t[1]], surface.points[t[2]]));
  const detail::BoxTree tree(boxes);
  std::vector<std::array<index_t, 2>> pairs;
  for (index_t t = 0; t < boxes.size() && pairs.size() < max_pairs; ++t) {
    const auto begin = static_cast<std::ptrdiff_t>(pairs.size());
    tree.traverse([&](const auto& bounds) { return bounds.meets(boxes[t]); },
                  [&](index_t first, index_t count) {
                    for (index_t i = first; i < first + count; ++i) {
                      const index_t other = tree.order()[i];
                      if (other > t && boxes[other].meets(boxes[t]) &&
                          detail::triangles_cross(surface.points, surface.triangles[t], surface.triangles[other]))
                        pairs.push_back({t, other});
                    }
                  });
    std::sort(pairs.begin() + begin, pairs.end());
  }
  if (pairs.size() > max_pairs) pairs.resize(max_pairs);
  return pairs;
}

}  // namespace framehex
