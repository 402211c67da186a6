// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace framehex {

/// Points to which more are added one at a time, searched by box.
///
/// `insert(point, size)` numbers the points 0, 1, ...; `size` is about the distance to the neighbours to be expected.
/// `move(index, point, size)` puts a point elsewhere. `for_each_in_box(low, high, visit)` calls `visit(index, point)`
/// once for every point of the closed box, in an order that depends on nothing but the insertions and moves.
/// `for_each_reaching(p, factor, visit)` does for every point q that is not farther from p than `factor` times the size
/// of q in any coordinate; others may be among them. `F(size)` makes an empty one for spacings of about `size` and less.
template <class F>
concept ProximityFilter = std::constructible_from<F, double> &&
    requires(F filter, const F& constant, index_t i, const Vector3& p, double size,
             void (*visit)(index_t, const Vector3&)) {
  filter.insert(p, size);
  filter.move(i, p, size);
  constant.for_each_in_box(p, p, visit);
  constant.for_each_reaching(p, size, visit);
};

/// Hash grid in levels, the cells of each half as wide as those of the level above: a point lies on the level whose
/// cells are about as wide as its size, so that graded point sets cost no more than uniform ones.
///
/// Cells are stored in blocks of 4 x 4 x 4, which makes a search over 27 cells touch two blocks or so instead of 27
/// places in memory. A coarse cell knows whether finer cells below it are in use, so a wide search does not walk empty
/// ones.
///
/// @par Complexity   Expected O(1) an insertion, O(points found + cells of the box) a search; about 60 bytes a point in
///                   a volume with one point a cell.
/// @par Determinism  Does not depend on addresses; the order of a visit depends on the order of insertions and moves
/// only.
class HashGrid {
public:
  /// @param cell  width of the coarsest cells, > 0: about the largest spacing to be expected.
  explicit HashGrid(double cell) : cell_(cell), inverse_(1.0 / cell), table_(64, none) {}

  void insert(const Vector3& point, double size) {
    entries_.push_back({point, none, level_of(size)});
    link(static_cast<index_t>(entries_.size() - 1));
  }

  void move(index_t i, const Vector3& to, double size) {
    Entry& entry = entries_[i];
    const int level = level_of(size);
    const Cell before = cell_of(entry.point, entry.level);
    if (level == entry.level && cell_of(to, level) == before) {
      entry.point = to;
      return;
    }
    index_t* at = &make_block(block_of(before, entry.level)).head[slot(before)];
    while (*at != i) at = &entries_[*at].next;
    *at = entry.next;
    entry.point = to;
    entry.level = level;
    link(i);
  }

  template <class Visit>
  void for_each_in_box(const Vector3& low, const Vector3& high, Visit&& visit) const {
    const Box box{low, high};
    search([&box](int) -> const Box& { return box; }, visit);
  }

  template <class Visit>
  void for_each_reaching(const Vector3& p, double factor, Visit&& visit) const {
    // The points of a level are no larger than its cells are wide.
    search(
        [&](int level) {
          const double width = level == 0 ? std::max(cell_, largest_) : cell_ / static_cast<double>(1 << level);
          const Vector3 half = Vector3::Constant(factor * width);
          return Box{p - half, p + half};
        },
        visit);
  }

  std::size_t size() const { return entries_.size(); }

private:
  using Cell = std::array<std::int64_t, 3>;
  static constexpr index_t none = no_index;
  static constexpr int max_level = 15;

  struct Box {
    Vector3 low, high;

    bool contains(const Vector3& p) const {
      return p.x() >= low.x() && p.x() <= high.x() && p.y() >= low.y() && p.y() <= high.y() && p.z() >= low.z() &&
             p.z() <= high.z();
    }
  };

  struct Block {
    std::uint64_t key;
    std::uint64_t finer = 0;  // one bit a cell: points on finer levels lie in it
    std::array<index_t, 64> head;
  };

  int level_of(double size) {
    largest_ = std::max(largest_, size);
    int level = 0;
    for (double width = 0.5 * cell_; size <= width && level < max_level; width *= 0.5) ++level;
    return level;
  }

  /// Puts point i at the head of its cell.
  void link(index_t i) {
    const Vector3& point = entries_[i].point;
    // Cells above must know before a search passes them by.
    for (int above = 0; above < entries_[i].level; ++above) {
      Block& block = make_block(block_of(cell_of(point, above), above));
      block.finer |= bit(cell_of(point, above));
    }
    const Cell cell = cell_of(point, entries_[i].level);
    index_t& head = make_block(block_of(cell, entries_[i].level)).head[slot(cell)];
    entries_[i].next = head;
    head = i;
  }

  struct Entry {
    Vector3 point;
    index_t next;  // the point below in the same cell
    int level;
  };

  Cell cell_of(const Vector3& p, int level) const {
    const double scale = inverse_ * static_cast<double>(1 << level);
    return {index(p.x() * scale), index(p.y() * scale), index(p.z() * scale)};
  }
  // Far outside of what a key can hold the cells coincide, which costs time and no result.
  static std::int64_t index(double x) {
    constexpr double limit = 1e15;
    const double within = x > limit ? limit : x < -limit ? -limit : x;
    const auto whole = static_cast<std::int64_t>(within);  // std::floor would be a call
    return whole - (static_cast<double>(whole) > within ? 1 : 0);
  }
  static std::uint64_t slot(const Cell& c) {
    return static_cast<std::uint64_t>((c[0] & 3) | (c[1] & 3) << 2 | (c[2] & 3) << 4);
  }
  static std::uint64_t bit(const Cell& c) { return std::uint64_t{1} << slot(c); }
  static std::uint64_t block_of(const Cell& c, int level) { return key({c[0] >> 2, c[1] >> 2, c[2] >> 2}, level); }
  static std::uint64_t key(const Cell& block, int level) {
    constexpr std::int64_t mask = (std::int64_t{1} << 20) - 1;
    return static_cast<std::uint64_t>(level) << 60 | static_cast<std::uint64_t>(block[0] & mask) << 40 |
           static_cast<std::uint64_t>(block[1] & mask) << 20 | static_cast<std::uint64_t>(block[2] & mask);
  }
  static std::uint64_t hash(std::uint64_t x) {
    x = (x ^ (x >> 31)) * 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 29)) * 0xbf58476d1ce4e5b9ULL;
    return x ^ (x >> 32);
  }

  const Block* find_block(std::uint64_t wanted) const {
    const std::uint64_t mask = table_.size() - 1;
    for (std::uint64_t i = hash(wanted) & mask; table_[i] != none; i = (i + 1) & mask)
      if (blocks_[table_[i]].key == wanted) return &blocks_[table_[i]];
    return nullptr;
  }

  Block& make_block(std::uint64_t wanted) {
    if (const Block* found = find_block(wanted)) return const_cast<Block&>(*found);
    if (2 * (blocks_.size() + 1) > table_.size()) {
      table_.assign(2 * table_.size(), none);
      for (std::size_t b = 0; b < blocks_.size(); ++b) place(static_cast<index_t>(b));
    }
    Block& block = blocks_.emplace_back();
    block.key = wanted;
    block.head.fill(none);
    place(static_cast<index_t>(blocks_.size() - 1));
    return block;
  }

  void place(index_t block) {
    const std::uint64_t mask = table_.size() - 1;
    std::uint64_t i = hash(blocks_[block].key) & mask;
    while (table_[i] != none) i = (i + 1) & mask;
    table_[i] = block;
  }

  /// Calls `visit` for the points of each level that are in `box_at(level)`, which lies in that of the level above.
  template <class BoxAt, class Visit>
  void search(const BoxAt& box_at, Visit& visit) const {
    const Box& box = box_at(0);
    const Cell first = cell_of(box.low, 0), last = cell_of(box.high, 0);
    double n_cells = 1;
    for (std::size_t a = 0; a < 3; ++a) n_cells *= static_cast<double>(last[a] - first[a] + 1);
    if (n_cells > static_cast<double>(entries_.size() + 64)) {
      for (std::size_t i = 0; i < entries_.size(); ++i)
        if (box_at(entries_[i].level).contains(entries_[i].point)) visit(static_cast<index_t>(i), entries_[i].point);
      return;
    }
    for (std::int64_t bz = first[2] >> 2; bz <= last[2] >> 2; ++bz)
      for (std::int64_t by = first[1] >> 2; by <= last[1] >> 2; ++by)
        for (std::int64_t bx = first[0] >> 2; bx <= last[0] >> 2; ++bx)
          if (const Block* block = find_block(key({bx, by, bz}, 0)))
            visit_block(*block, {bx, by, bz}, first, last, box_at, visit);
  }

  /// The coarsest cells of a block between `first` and `last`.
  template <class BoxAt, class Visit>
  void visit_block(const Block& block, const Cell& at, const Cell& first, const Cell& last, const BoxAt& box_at,
                   Visit& visit) const {
    Cell from, to;
    for (std::size_t a = 0; a < 3; ++a) {
      from[a] = std::max(first[a], 4 * at[a]);
      to[a] = std::min(last[a], 4 * at[a] + 3);
    }
    for (std::int64_t z = from[2]; z <= to[2]; ++z)
      for (std::int64_t y = from[1]; y <= to[1]; ++y)
        for (std::int64_t x = from[0]; x <= to[0]; ++x) visit_cell(block, {x, y, z}, 0, box_at, visit);
  }

  template <class BoxAt, class Visit>
  void visit_cell(const Block& block, const Cell& cell, int level, const BoxAt& box_at, Visit& visit) const {
    const Box& box = box_at(level);
    for (index_t i = block.head[slot(cell)]; i != none; i = entries_[i].next)
      if (box.contains(entries_[i].point)) visit(i, entries_[i].point);
    if (!(block.finer & bit(cell))) return;
    const Box& below_box = box_at(level + 1);
    const Cell first = cell_of(below_box.low, level + 1), last = cell_of(below_box.high, level + 1);
    for (std::int64_t child = 0; child < 8; ++child) {
      const Cell c{2 * cell[0] + (child & 1), 2 * cell[1] + (child >> 1 & 1), 2 * cell[2] + (child >> 2)};
      bool overlaps = true;
      for (std::size_t a = 0; a < 3; ++a) overlaps = overlaps && c[a] >= first[a] && c[a] <= last[a];
      if (!overlaps) continue;
      if (const Block* below = find_block(block_of(c, level + 1))) visit_cell(*below, c, level + 1, box_at, visit);
    }
  }

  double cell_, inverse_;
  double largest_ = 0;  // size
  std::vector<Entry> entries_;
  std::vector<Block> blocks_;
  std::vector<index_t> table_;  // open addressing, a power of two
};

static_assert(ProximityFilter<HashGrid>);

/// Half edges of the axis-aligned box round a cube of half edge `r` whose axes are the columns of `axes`.
inline Vector3 box_half_edges(const Eigen::Matrix3d& axes, double r) {
  return r * axes.cwiseAbs().rowwise().sum();
}

/// Largest of the absolute coordinates of `offset` along the columns of `axes`: the infinity norm in that frame.
inline double frame_infinity_norm(const Eigen::Matrix3d& axes, const Vector3& offset) {
  return (axes.transpose() * offset).cwiseAbs().maxCoeff();
}

/// Calls `visit(index, point, local)` for every point whose distance from `centre`, in the infinity norm of the frame
/// `axes`, is under `radius`; `local` is its offset along the axes.
template <ProximityFilter F, class Visit>
void for_each_local(const F& filter, const Vector3& centre, const Eigen::Matrix3d& axes, double radius, Visit&& visit) {
  const Vector3 half = box_half_edges(axes, radius);
  const Eigen::Matrix3d to_local = axes.transpose();
  filter.for_each_in_box(centre - half, centre + half, [&](index_t i, const Vector3& p) {
    const Vector3 local = to_local * (p - centre);
    if (std::abs(local[0]) < radius && std::abs(local[1]) < radius && std::abs(local[2]) < radius) visit(i, p, local);
  });
}

/// The same with the distance in place of the offset.
template <ProximityFilter F, class Visit>
void for_each_near(const F& filter, const Vector3& centre, const Eigen::Matrix3d& axes, double radius, Visit&& visit) {
  for_each_local(filter, centre, axes, radius,
                 [&](index_t i, const Vector3& p, const Vector3& local) { visit(i, p, local.cwiseAbs().maxCoeff()); });
}

}  // namespace framehex
