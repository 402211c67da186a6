// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/tetrahedralization/tetrahedralizer.hpp"

namespace framehex {

/// A tetrahedral mesh inside a surface, and what it cost.
struct RepeatedTetrahedralization {
  Tetrahedralization result;         ///< its points: those of the surface, the interior ones but for `dropped`, extra
  std::vector<std::size_t> dropped;  ///< interior points that the mesh does not have, ascending
};

namespace detail {

/// The interior points that stand in the way of a tetrahedralisation that failed: those that were lost themselves; or
/// those nearer to a corner of a lost triangle than `reach` of the longest edge at it. All, where the error names no
/// vertex.
template <class FlatSurface>
std::vector<std::size_t> points_in_the_way(const tetrahedralization_error& failure, const FlatSurface& surface,
                                           std::span<const Vector3> interior, double reach) {
  const std::size_t n_surface = surface.points.size();
  std::vector<std::uint8_t> at_fault(n_surface, 0);
  std::vector<std::size_t> found;
  if (failure.entity() == Entity::vertex)
    for (const std::size_t v : failure.indices()) {
      if (v >= n_surface)
        found.push_back(v - n_surface);
      else
        at_fault[v] = 1;
    }
  if (std::ranges::count(at_fault, 1) > 0) {
    std::vector<double> longest(n_surface, 0);
    for (const auto& t : surface.triangles)
      for (std::size_t i = 0; i < 3; ++i)
        for (const index_t end : {t[i], t[(i + 1) % 3]})
          longest[end] = std::max(longest[end], (surface.points[t[i]] - surface.points[t[(i + 1) % 3]]).norm());
    for (std::size_t i = 0; i < interior.size(); ++i)
      for (std::size_t v = 0; v < n_surface; ++v)
        if (at_fault[v] && (interior[i] - surface.points[v]).norm() < reach * longest[v]) {
          found.push_back(i);
          break;
        }
  }
  if (failure.entity() != Entity::vertex)
    for (std::size_t i = 0; i < interior.size(); ++i) found.push_back(i);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace detail

/// Fills a closed surface with tetrahedra; where that fails for interior points in the way, does without those.
///
/// A backend that drops a point, or loses a triangle of the surface, is asked again without the points concerned: those
/// dropped, or those round the triangle, in a ball that doubles from round to round.
///
/// @param interior  as for `tetrahedralize`; here they may be lost, so only those that nothing depends on.
/// @return the mesh, whose boundary is the surface exactly, and the points that it lacks. Empty when cancelled.
/// @throws what `tetrahedralize` throws, when it still fails after `max_rounds` rounds or when no point is left to drop.
/// @par Complexity   that of `tetrahedralize` for each round; rounds end since each has fewer points than the last.
template <Tetrahedralizer T, TriangleMesh M>
RepeatedTetrahedralization tetrahedralize_repeatedly(const T& tetrahedralizer, const M& surface,
                                                     std::span<const Vector3> interior, const Observer& observer = {},
                                                     int max_rounds = 6) {
  RepeatedTetrahedralization repeated;
  std::vector<Vector3> points(interior.begin(), interior.end());
  std::vector<std::size_t> number(points.size());
  for (std::size_t i = 0; i < number.size(); ++i) number[i] = i;
  double reach = 1;
  for (int round = 0;; ++round, reach *= 2) {
    try {
      repeated.result = tetrahedralize(tetrahedralizer, surface, points, observer);
      std::sort(repeated.dropped.begin(), repeated.dropped.end());
      return repeated;
    } catch (const tetrahedralization_error& failure) {
      const auto in_the_way = detail::points_in_the_way(failure, detail::flat(surface), points, reach);
      if (in_the_way.empty() || round >= max_rounds) throw;
      std::size_t n = 0;
      for (std::size_t i = 0, next = 0; i < points.size(); ++i) {
        if (next < in_the_way.size() && in_the_way[next] == i) {
          repeated.dropped.push_back(number[i]);
          ++next;
          continue;
        }
        points[n] = points[i];
        number[n++] = number[i];
      }
      points.resize(n);
      number.resize(n);
    }
  }
}

}  // namespace framehex
