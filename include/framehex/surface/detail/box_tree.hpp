// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

namespace framehex::detail {

/// Boxes in a flat binary tree, halved at the median of the longest axis; fixed after construction. The left child of
/// node i is node i+1.
///
/// Boost's R-tree does the same in four times the time per nearest-triangle query (benchmarks/bench_surface.cpp) and
/// costs seconds of compile time.
class BoxTree {
public:
  struct Bounds {
    std::array<double, 3> low, high;

    static Bounds none() {
      constexpr double big = std::numeric_limits<double>::max();
      return {{big, big, big}, {-big, -big, -big}};
    }
    void add(const Vector3& p) {
      for (std::size_t i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], p[static_cast<int>(i)]);
        high[i] = std::max(high[i], p[static_cast<int>(i)]);
      }
    }
    void add(const Bounds& b) {
      for (std::size_t i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], b.low[i]);
        high[i] = std::max(high[i], b.high[i]);
      }
    }
    bool meets(const Bounds& b) const {
      return low[0] <= b.high[0] && b.low[0] <= high[0] && low[1] <= b.high[1] && b.low[1] <= high[1] &&
             low[2] <= b.high[2] && b.low[2] <= high[2];
    }
    /// Does a ray enter the box before it has gone so far?
    bool meets_ray(const Vector3& from, const Vector3& direction, double reach) const {
      double enters = 0, leaves = reach;
      for (std::size_t i = 0; i < 3; ++i) {
        const double x = from[static_cast<int>(i)], d = direction[static_cast<int>(i)];
        if (d == 0) {
          if (x < low[i] || x > high[i]) return false;
          continue;
        }
        const double a = (low[i] - x) / d, b = (high[i] - x) / d;
        enters = std::max(enters, std::min(a, b));
        leaves = std::min(leaves, std::max(a, b));
      }
      constexpr double rounding = 1 + 1e-12;
      return enters <= leaves * rounding;
    }
    double squared_distance(const Vector3& p) const {
      double sum = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const double x = p[static_cast<int>(i)];
        const double d = std::max({low[i] - x, 0.0, x - high[i]});
        sum += d * d;
      }
      return sum;
    }
  };

  struct Node {
    Bounds bounds;
    index_t first;  ///< leaf: position in `order`; inner: index of the right child
    index_t count;  ///< leaf: number of items; inner: 0
  };

  BoxTree() = default;

  explicit BoxTree(const std::vector<Bounds>& boxes) {
    order_.resize(boxes.size());
    std::iota(order_.begin(), order_.end(), index_t{0});
    nodes_.reserve(boxes.size());
    if (!boxes.empty()) build(boxes, 0, boxes.size());
  }

  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<index_t>& order() const { return order_; }  ///< items in the order of the leaves

  /// Calls `leaf(first, count)` (positions in `order`) for every leaf whose node passes `enter(bounds)`.
  template <class Enter, class Leaf>
  void traverse(Enter&& enter, Leaf&& leaf) const {
    std::array<index_t, 64> stack;
    std::size_t depth = 0;
    if (!nodes_.empty()) stack[depth++] = 0;
    while (depth > 0) {
      const index_t i = stack[--depth];
      const Node& node = nodes_[i];
      if (!enter(node.bounds)) continue;
      if (node.count > 0) {
        leaf(node.first, node.count);
      } else {
        stack[depth++] = node.first;
        stack[depth++] = i + 1;
      }
    }
  }

  /// Calls `leaf(first, count)` for leaves in nearly rising distance from p; `leaf` returns the squared distance beyond
  /// which nothing is wanted any more.
  template <class Leaf>
  void nearest(const Vector3& p, double limit, Leaf&& leaf) const {
    struct Entry {
      index_t node;
      double distance;
    };
    std::array<Entry, 64> stack;
    std::size_t depth = 0;
    if (!nodes_.empty()) stack[depth++] = {0, nodes_[0].bounds.squared_distance(p)};
    while (depth > 0) {
      const Entry entry = stack[--depth];
      if (entry.distance > limit) continue;
      const Node& node = nodes_[entry.node];
      if (node.count > 0) {
        limit = std::min(limit, leaf(node.first, node.count));
        continue;
      }
      Entry near{entry.node + 1, nodes_[entry.node + 1].bounds.squared_distance(p)};
      Entry far{node.first, nodes_[node.first].bounds.squared_distance(p)};
      if (far.distance < near.distance) std::swap(near, far);
      if (far.distance <= limit) stack[depth++] = far;
      if (near.distance <= limit) stack[depth++] = near;
    }
  }

private:
  static constexpr std::size_t leaf_size = 4;

  void build(const std::vector<Bounds>& boxes, std::size_t begin, std::size_t end) {
    const std::size_t at = nodes_.size();
    Bounds bounds = Bounds::none(), centres = Bounds::none();
    for (std::size_t i = begin; i < end; ++i) {
      bounds.add(boxes[order_[i]]);
      centres.add(centre(boxes[order_[i]]));
    }
    nodes_.push_back({bounds, static_cast<index_t>(begin), static_cast<index_t>(end - begin)});
    if (end - begin <= leaf_size) return;
    std::size_t axis = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (centres.high[i] - centres.low[i] > centres.high[axis] - centres.low[axis]) axis = i;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto key = [&](index_t item) { return boxes[item].low[axis] + boxes[item].high[axis]; };
    const auto first = order_.begin();
    std::nth_element(first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(middle),
                     first + static_cast<std::ptrdiff_t>(end), [&](index_t a, index_t b) {
                       const double x = key(a), y = key(b);
                       return x < y || (x == y && a < b);
                     });
    build(boxes, begin, middle);
    nodes_[at].first = static_cast<index_t>(nodes_.size());
    nodes_[at].count = 0;
    build(boxes, middle, end);
  }

  static Vector3 centre(const Bounds& b) {
    return {(b.low[0] + b.high[0]) / 2, (b.low[1] + b.high[1]) / 2, (b.low[2] + b.high[2]) / 2};
  }

  std::vector<Node> nodes_;
  std::vector<index_t> order_;
};

inline BoxTree::Bounds triangle_bounds(const Vector3& a, const Vector3& b, const Vector3& c) {
  BoxTree::Bounds bounds = BoxTree::Bounds::none();
  bounds.add(a);
  bounds.add(b);
  bounds.add(c);
  return bounds;
}

}  // namespace framehex::detail
