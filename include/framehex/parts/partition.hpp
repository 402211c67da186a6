// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/geometry/detail/morton.hpp"
#include "framehex/parts/detail/exchange.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace framehex {

/// Places along the Morton curve through a cube.
class MortonCube {
public:
  using Code = std::uint64_t;
  static constexpr int n_levels = 21;                     ///< of halving, along each axis
  static constexpr Code end = Code{1} << (3 * n_levels);  ///< above all codes

  MortonCube() = default;
  /// The cube has twice the width of the box, which lies `shift` (0 to 1) of its width into it: where a shift of one
  /// fifth more or less cuts, another one does not, at any level.
  /// @par Source  Chan, Approximate nearest neighbor queries revisited, Discrete Comput. Geom. 20 (1998).
  MortonCube(const Vector3& low, const Vector3& high, double shift) {
    width_ = std::max((high - low).maxCoeff(), std::numeric_limits<double>::min());
    low_ = low;
    shift_ = shift;
  }

  Code code(const Vector3& p) const {
    constexpr double n = double(1 << (n_levels - 1));
    Code code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double place = std::floor(((p[axis] - low_[axis]) / width_ + shift_) * n);
      code |= detail::spread_to_thirds(static_cast<Code>(std::clamp(place, 0.0, 2 * n - 1))) << axis;
    }
    return code;
  }

private:
  Vector3 low_ = Vector3::Zero();
  double width_ = 1, shift_ = 0;
};

/// The leaves of an octree over a whole mesh (split one axis at a time), which every rank knows, and the ranks that hold them:
/// contiguous in Morton order, of about as many cells each.
class Partition {
public:
  /// Halves leaves until none has more than `part_size` cells. Collective.
  ///
  /// @param codes  of this rank's cells, in any order.
  /// @par Complexity   one sum over the ranks for each level; on every rank 24 bytes a leaf.
  /// @par Determinism  Depends on the codes of all ranks together and on `part_size`; the holders also on the number of
  ///                   ranks.
  template <Transport Tr>
  Partition(const Tr& transport, const MortonCube& cube, std::vector<MortonCube::Code> codes, std::size_t part_size)
      : cube_(cube) {
    std::sort(codes.begin(), codes.end());
    std::vector<Node> open{{0, 0}};
    for (int level = 0; !open.empty(); ++level) {
      std::vector<std::int64_t> counts;
      for (const Node& node : open) counts.push_back(count(codes, node));
      transport.sum(std::span<std::int64_t>(counts));
      std::vector<Node> next;
      for (std::size_t i = 0; i < open.size(); ++i) {
        if (counts[i] == 0) continue;
        if (static_cast<std::size_t>(counts[i]) <= part_size || level == n_splits)
          leaves_.push_back({open[i].first, counts[i]});
        else
          for (const auto half : {MortonCube::Code{0}, MortonCube::Code{1}})
            next.push_back({open[i].first + half * width(level + 1), level + 1});
      }
      open = std::move(next);
    }
    std::sort(leaves_.begin(), leaves_.end(), [](const Leaf& a, const Leaf& b) { return a.first < b.first; });
    std::int64_t total = 0, before = 0;
    for (const Leaf& leaf : leaves_) total += leaf.n_cells;
    for (Leaf& leaf : leaves_) {
      const auto middle = static_cast<double>(before) + 0.5 * static_cast<double>(leaf.n_cells);
      leaf.rank = std::min(static_cast<int>(middle / static_cast<double>(total) * transport.n_ranks()),
                           transport.n_ranks() - 1);
      before += leaf.n_cells;
    }
  }

  std::size_t size() const { return leaves_.size(); }
  const MortonCube& cube() const { return cube_; }
  /// Cells of all ranks that a leaf had when it was made.
  std::int64_t n_cells(index_t leaf) const { return leaves_[leaf].n_cells; }
  int rank(index_t leaf) const { return leaves_[leaf].rank; }

  /// The leaf in which a place lies; the one before along the curve where there is none.
  index_t leaf_at(MortonCube::Code code) const {
    const auto after = std::upper_bound(leaves_.begin(), leaves_.end(), code,
                                        [](MortonCube::Code c, const Leaf& leaf) { return c < leaf.first; });
    return after == leaves_.begin() ? 0 : static_cast<index_t>(after - leaves_.begin() - 1);
  }
  index_t leaf_at(const Vector3& p) const { return leaf_at(cube_.code(p)); }

  /// The leaves that a rank holds: [first, last).
  std::array<index_t, 2> leaves_of(int rank) const {
    const auto at_least = [&](int r) {
      return static_cast<index_t>(
          std::partition_point(leaves_.begin(), leaves_.end(), [r](const Leaf& leaf) { return leaf.rank < r; }) -
          leaves_.begin());
    };
    return {at_least(rank), at_least(rank + 1)};
  }

private:
  struct Leaf {
    MortonCube::Code first;
    std::int64_t n_cells;
    int rank = 0;
  };
  struct Node {
    MortonCube::Code first;
    int level;
  };

  static constexpr int n_splits = 3 * MortonCube::n_levels;
  static MortonCube::Code width(int level) { return MortonCube::Code{1} << (n_splits - level); }

  static std::int64_t count(const std::vector<MortonCube::Code>& codes, const Node& node) {
    const auto first = std::lower_bound(codes.begin(), codes.end(), node.first);
    return std::lower_bound(first, codes.end(), node.first + width(node.level)) - first;
  }

  MortonCube cube_;
  std::vector<Leaf> leaves_;
};

}  // namespace framehex
