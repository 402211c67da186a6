// SPDX-License-Identifier: BSL-1.0
#pragma once

// The only header that includes Boost.Geometry, which costs seconds of compile time.
#include "framehex/config.hpp"

// It includes headers that Boost deprecates, which would be told to all who include this one.
#pragma push_macro("BOOST_ALLOW_DEPRECATED_HEADERS")
#undef BOOST_ALLOW_DEPRECATED_HEADERS
#define BOOST_ALLOW_DEPRECATED_HEADERS
#include <boost/geometry.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#pragma pop_macro("BOOST_ALLOW_DEPRECATED_HEADERS")

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace framehex {

namespace detail {

using GeometryPoint = boost::geometry::model::point<double, 3, boost::geometry::cs::cartesian>;
using GeometryBox = boost::geometry::model::box<GeometryPoint>;

inline GeometryPoint geometry_point(const Vector3& p) {
  return {p.x(), p.y(), p.z()};
}

}  // namespace detail

/// Points with ids in an R-tree; grows point by point.
///
/// Reference implementation of a proximity search. Concurrent queries are safe while nobody inserts.
/// @par Complexity   O(log n) per insertion and per query, plus the output.
class PointIndex {
public:
  PointIndex() = default;

  /// Packs all points at once, which makes a better tree than inserting them; their ids are 0, 1, ...
  explicit PointIndex(const std::vector<Vector3>& points) {
    std::vector<Value> values;
    values.reserve(points.size());
    for (const Vector3& p : points) values.emplace_back(detail::geometry_point(p), static_cast<index_t>(values.size()));
    tree_ = Tree(values);
  }

  std::size_t size() const { return tree_.size(); }

  void insert(const Vector3& point, index_t id) { tree_.insert(Value(detail::geometry_point(point), id)); }

  /// Takes a point out that was inserted with that id.
  void remove(const Vector3& point, index_t id) { tree_.remove(Value(detail::geometry_point(point), id)); }

  /// Calls `visit(id, point)` for each point in the closed box [low, high], in an order that depends on nothing but the
  /// insertions; stops early when `visit` returns false.
  template <class Visit>
  void in_box(const Vector3& low, const Vector3& high, Visit&& visit) const {
    const detail::GeometryBox box(detail::geometry_point(low), detail::geometry_point(high));
    for (auto it = tree_.qbegin(boost::geometry::index::intersects(box)); it != tree_.qend(); ++it) {
      const auto& p = it->first;
      if (!visit(it->second, Vector3(p.get<0>(), p.get<1>(), p.get<2>()))) return;
    }
  }

  /// Id of the nearest point, the smallest among equally near ones; `no_index` when empty.
  index_t nearest(const Vector3& query) const {
    index_t best = no_index;
    if (tree_.empty()) return best;
    const auto q = detail::geometry_point(query);
    const auto first = tree_.qbegin(boost::geometry::index::nearest(q, 1u));
    // The tree's choice among equally near points depends on how it was built: look at all of them.
    const double squared = boost::geometry::comparable_distance(q, first->first);
    const Vector3 reach = Vector3::Constant(std::sqrt(squared) * (1 + 1e-12) + 1e-300);
    const detail::GeometryBox box(detail::geometry_point(query - reach), detail::geometry_point(query + reach));
    for (auto it = tree_.qbegin(boost::geometry::index::intersects(box)); it != tree_.qend(); ++it)
      if (boost::geometry::comparable_distance(q, it->first) <= squared) best = std::min(best, it->second);
    return best;
  }

private:
  using Value = std::pair<detail::GeometryPoint, index_t>;
  using Tree = boost::geometry::index::rtree<Value, boost::geometry::index::quadratic<16>>;
  Tree tree_;
};

/// An axis-aligned box.
struct Box {
  Vector3 low, high;
};

/// Boxes with ids 0, 1, ... in a packed R-tree, fixed after construction.
///
/// @par Complexity   O(n log n) to build, O(log n) and the output per query.
class BoxIndex {
public:
  BoxIndex() = default;

  explicit BoxIndex(const std::vector<Box>& boxes) {
    std::vector<Value> values;
    values.reserve(boxes.size());
    for (const Box& box : boxes)
      values.emplace_back(detail::GeometryBox(detail::geometry_point(box.low), detail::geometry_point(box.high)),
                          static_cast<index_t>(values.size()));
    tree_ = Tree(values);
  }

  std::size_t size() const { return tree_.size(); }

  /// Calls `visit(id)` for each box that meets the closed box [low, high]; stops early when it returns false.
  template <class Visit>
  void in_box(const Vector3& low, const Vector3& high, Visit&& visit) const {
    const detail::GeometryBox box(detail::geometry_point(low), detail::geometry_point(high));
    for (auto it = tree_.qbegin(boost::geometry::index::intersects(box)); it != tree_.qend(); ++it)
      if (!visit(it->second)) return;
  }

  /// Calls `visit(id, squared distance from query to the box)` by rising distance and id; stops when it returns false.
  /// This is the best-first search for anything that the boxes bound.
  template <class Visit>
  void by_distance(const Vector3& query, Visit&& visit) const {
    const auto q = detail::geometry_point(query);
    // Boost's search keeps, sorted, as many boxes as it is asked for: ask for few, and for more when they were not
    // enough.
    using Entry = std::pair<double, index_t>;
    std::vector<Entry> batch;
    Entry last(-1, 0);
    for (std::size_t wanted = 16;; wanted *= 4) {
      const bool all = wanted >= tree_.size();
      batch.clear();
      const auto nearest = boost::geometry::index::nearest(q, static_cast<unsigned>(std::min(wanted, tree_.size())));
      for (auto it = tree_.qbegin(nearest); it != tree_.qend(); ++it)
        batch.emplace_back(boost::geometry::comparable_distance(q, it->first), it->second);
      std::sort(batch.begin(), batch.end());
      if (!all) {  // which of the farthest are in the batch is up to the tree: leave them to the next
        const double farthest = batch.back().first;
        while (!batch.empty() && batch.back().first == farthest) batch.pop_back();
      }
      for (const Entry& entry : batch) {
        if (!(last < entry)) continue;
        if (!visit(entry.second, entry.first)) return;
        last = entry;
      }
      if (all) return;
    }
  }

private:
  using Value = std::pair<detail::GeometryBox, index_t>;
  using Tree = boost::geometry::index::rtree<Value, boost::geometry::index::quadratic<16>>;
  Tree tree_;
};

}  // namespace framehex
