// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/surface/feature_graph.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

namespace framehex::detail {

/// A curve as a side of a patch: the patch lies on its left when it is run from `from` to `to`.
struct PatchSide {
  index_t curve, from, to;
};

/// The sides of each patch, in the order of the curves.
inline std::vector<std::vector<PatchSide>> patch_sides(const IndexedTriangleMesh& surface,
                                                       const FeatureGraph& features) {
  using Edge = std::array<index_t, 2>;
  std::vector<std::pair<Edge, index_t>> left_patches;  // of the directed feature edges, sorted
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      if (features.is_feature[3 * t + i])
        left_patches.push_back(
            {{surface.triangles[t][i], surface.triangles[t][(i + 1) % 3]}, features.triangle_patch[t]});
  std::sort(left_patches.begin(), left_patches.end());
  std::vector<std::vector<PatchSide>> sides(features.n_patches);
  const auto add = [&](const Edge& edge, const PatchSide& side) {
    const auto found = std::lower_bound(left_patches.begin(), left_patches.end(), std::pair{edge, index_t{0}});
    if (found != left_patches.end() && found->first == edge) sides[found->second].push_back(side);
  };
  for (index_t c = 0; c < features.curves.size(); ++c) {
    const auto row = features.curves[c];
    add({row[0], row[1]}, {c, row.front(), row.back()});
    add({row[1], row[0]}, {c, row.back(), row.front()});
  }
  return sides;
}

/// Pairs of curves that are opposite sides of a patch with four sides from corner to corner.
inline std::vector<std::array<index_t, 2>> opposite_curves(const IndexedTriangleMesh& surface,
                                                           const FeatureGraph& features) {
  std::vector<std::array<index_t, 2>> pairs;
  for (const auto& sides : patch_sides(surface, features)) {
    std::set<index_t> corners;
    for (const PatchSide& side : sides) corners.insert(side.from);
    if (sides.size() != 4 || corners.size() != 4) continue;
    std::array<index_t, 4> loop{};  // the curves in the order in which they are run through
    index_t at = sides[0].from;
    for (index_t& curve : loop) {
      const auto side = std::find_if(sides.begin(), sides.end(), [&](const PatchSide& s) { return s.from == at; });
      if (side == sides.end()) break;
      curve = side->curve;
      at = side->to;
    }
    if (at == sides[0].from && std::set<index_t>(loop.begin(), loop.end()).size() == 4) {
      pairs.push_back({loop[0], loop[2]});
      pairs.push_back({loop[1], loop[3]});
    }
  }
  return pairs;
}

/// Classes of curves that are to have the same number of intervals: the lengths in a class differ by a factor of
/// `most_stretch` at most.
class CurveClasses {
public:
  explicit CurveClasses(std::vector<double> lengths) : low_(lengths), high_(std::move(lengths)), parent_(low_.size()) {
    std::iota(parent_.begin(), parent_.end(), index_t{0});
  }

  index_t find(index_t c) const {
    while (parent_[c] != c) c = parent_[c];
    return c;
  }

  void join(index_t a, index_t b) {
    a = find(a);
    b = find(b);
    const double low = std::min(low_[a], low_[b]), high = std::max(high_[a], high_[b]);
    if (a == b || high > most_stretch * low) return;
    parent_[std::max(a, b)] = std::min(a, b);
    low_[std::min(a, b)] = low;
    high_[std::min(a, b)] = high;
  }

private:
  static constexpr double most_stretch = 1.25;
  std::vector<double> low_, high_;
  std::vector<index_t> parent_;
};

/// Gives the curves of a class the mean of their lengths and the greatest of their floors.
inline void match_curves(const std::vector<std::array<index_t, 2>>& pairs, std::vector<double>& lengths,
                         std::vector<double>& floors) {
  CurveClasses classes(lengths);
  for (const auto& [a, b] : pairs) classes.join(a, b);
  std::vector<double> sum(lengths.size(), 0), count(lengths.size(), 0), floor(lengths.size(), 0);
  for (index_t c = 0; c < lengths.size(); ++c) {
    const index_t root = classes.find(c);
    sum[root] += lengths[c];
    ++count[root];
    floor[root] = std::max(floor[root], floors[c]);
  }
  for (index_t c = 0; c < lengths.size(); ++c) {
    const index_t root = classes.find(c);
    lengths[c] = sum[root] / count[root];
    floors[c] = floor[root];
  }
}

}  // namespace framehex::detail
