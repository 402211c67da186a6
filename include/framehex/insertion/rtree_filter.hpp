// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/proximity.hpp"
#include "framehex/geometry/spatial_index.hpp"

#include <vector>

namespace framehex {

/// Boost.Geometry's R-tree as a proximity filter: the reference against which the hash grid is measured.
///
/// @par Complexity   O(log n) an insertion and a search; about 120 bytes a point.
class RTreeFilter {
public:
  explicit RTreeFilter(double /*cell*/) {}

  void insert(const Vector3& point, double size) {
    largest_ = std::max(largest_, size);
    tree_.insert(point, static_cast<index_t>(points_.size()));
    points_.push_back(point);
  }

  void move(index_t i, const Vector3& to, double size) {
    largest_ = std::max(largest_, size);
    tree_.remove(points_[i], i);
    tree_.insert(to, i);
    points_[i] = to;
  }

  template <class Visit>
  void for_each_in_box(const Vector3& low, const Vector3& high, Visit&& visit) const {
    tree_.in_box(low, high, [&](index_t id, const Vector3& point) {
      visit(id, point);
      return true;
    });
  }

  template <class Visit>
  void for_each_reaching(const Vector3& p, double factor, Visit&& visit) const {
    const Vector3 half = Vector3::Constant(factor * largest_);
    for_each_in_box(p - half, p + half, visit);
  }

private:
  double largest_ = 0;  // size
  PointIndex tree_;
  std::vector<Vector3> points_;
};

static_assert(ProximityFilter<RTreeFilter>);

}  // namespace framehex
