// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/surface.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace framehex {

namespace detail {

/// Sets of patches under symmetric difference, as sorted lists.
using PatchSet = std::vector<index_t>;

inline PatchSet symmetric_difference(const PatchSet& x, const PatchSet& y) {
  PatchSet result;
  std::set_symmetric_difference(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(result));
  return result;
}

/// For each curve: the patches that have it on one side only, or an odd number of times.
inline std::vector<PatchSet> odd_sides(const Surface& surface) {
  const TriangleAdjacency& adjacency = surface.adjacency;
  std::vector<PatchSet> sides;
  for (std::size_t c = 0; c < surface.features.curves.size(); ++c) {
    const auto row = surface.features.curves[c];
    PatchSet& odd = sides.emplace_back();
    for (const index_t t : adjacency.triangles_of_vertex[row[0]])
      if (const auto& v = adjacency.triangles[t]; std::find(v.begin(), v.end(), row[1]) != v.end())
        odd = symmetric_difference(odd, {surface.features.triangle_patch[t]});
  }
  return sides;
}

/// Marks the curves of patches with three that an interval more would make as long as the two others together: such a
/// triangle does not fall into the three blocks about a vertex of three cells, and its cells are poor.
inline std::vector<char> too_long_for_triangles(const std::vector<PatchSet>& sides, std::size_t n_patches,
                                                std::span<const index_t> n_intervals) {
  const Csr<index_t> curves_of_patch = make_csr(n_patches, [&](auto&& put) {
    for (index_t c = 0; c < sides.size(); ++c)
      for (const index_t patch : sides[c]) put(patch, c);
  });
  std::vector<char> marks(sides.size(), 0);
  for (std::size_t patch = 0; patch < n_patches; ++patch) {
    const auto curves = curves_of_patch[patch];
    if (curves.size() != 3) continue;
    index_t sum = 0;
    for (const index_t c : curves) sum += n_intervals[c];
    for (const index_t c : curves)
      if (2 * n_intervals[c] + 1 >= sum) marks[c] = 1;
  }
  return marks;
}

}  // namespace detail

/// Curves to which one interval has to be added so that each patch has an even number on its boundary: without that it
/// does not fall into quadrilaterals.
///
/// Curves that one patch has for itself are taken before shared ones, and long ones before short ones; last those sides
/// of triangles that would become as long as the two others.
///
/// @param n_intervals  one a curve.
/// @return curves, ascending. Patches stay odd only where no choice of curves makes them even.
/// @par Complexity   O(curves x patches) at worst, near linear where patches have few neighbours.
/// @par Source       Linear equations modulo two, by elimination.
inline std::vector<index_t> curves_to_lengthen(const Surface& surface, std::span<const index_t> n_intervals) {
  const FeatureGraph& features = surface.features;
  const std::vector<detail::PatchSet> sides = detail::odd_sides(surface);
  detail::PatchSet odd;
  std::vector<double> length(sides.size(), 0);
  for (std::size_t c = 0; c < sides.size(); ++c) {
    if (n_intervals[c] % 2 == 1) odd = detail::symmetric_difference(odd, sides[c]);
    const auto row = features.curves[c];
    for (std::size_t i = 1; i < row.size(); ++i)
      length[c] += (surface.points[row[i]] - surface.points[row[i - 1]]).norm();
  }
  if (odd.empty()) return {};

  const std::vector<char> too_long = detail::too_long_for_triangles(sides, features.n_patches, n_intervals);
  std::vector<index_t> order(sides.size());
  std::iota(order.begin(), order.end(), index_t{0});
  std::stable_sort(order.begin(), order.end(), [&](index_t a, index_t b) {
    const bool shared_a = sides[a].size() > 1, shared_b = sides[b].size() > 1;
    if (shared_a != shared_b) return shared_b;
    return too_long[a] != too_long[b] ? too_long[b] != 0 : length[a] > length[b];
  });
  // Combinations of curves, each with the patches that it changes, found under the greatest of them.
  struct Combination {
    detail::PatchSet patches;
    std::vector<index_t> curves;
  };
  std::map<index_t, Combination> by_patch;
  const auto reduce = [&](Combination& x) {
    for (std::size_t i = x.patches.size(); i-- > 0;) {
      const auto found = by_patch.find(x.patches[i]);
      if (found == by_patch.end()) continue;
      x.patches = detail::symmetric_difference(x.patches, found->second.patches);
      x.curves = detail::symmetric_difference(x.curves, found->second.curves);
      i = x.patches.size();
    }
  };
  for (const index_t c : order) {
    Combination x{sides[c], {c}};
    reduce(x);
    if (!x.patches.empty()) by_patch.emplace(x.patches.back(), std::move(x));
  }
  Combination wanted{odd, {}};
  reduce(wanted);
  return wanted.curves;
}

}  // namespace framehex
