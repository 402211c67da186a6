// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/field/detail/exact_sum.hpp"
#include "framehex/geometry/detail/morton.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace framehex::detail {

/// Place on a space-filling curve (Morton's) through a box, of 21 bits an axis.
struct CurveKey {
  Vector3 low;
  double scale;

  CurveKey(const Vector3& box_low, const Vector3& box_high) : low(box_low) {
    const double extent = (box_high - box_low).maxCoeff();
    scale = extent > 0 ? 2097151 / extent : 0;
  }

  std::uint64_t operator()(const Vector3& p) const {
    std::uint64_t key = 0;
    for (int i = 0; i < 3; ++i) key |= spread_to_thirds(static_cast<std::uint64_t>((p[i] - low[i]) * scale)) << i;
    return key;
  }
};

/// Vertices along a space-filling curve, so that neighbours in the mesh are near in memory.
inline std::vector<index_t> spatial_order(std::span<const Vector3> points) {
  if (points.empty()) return {};
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vector3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const CurveKey key_of(low, high);
  std::vector<std::pair<std::uint64_t, index_t>> keys(points.size());
  for (std::size_t v = 0; v < points.size(); ++v) keys[v] = {key_of(points[v]), static_cast<index_t>(v)};
  std::sort(keys.begin(), keys.end());
  std::vector<index_t> order(points.size());
  for (std::size_t i = 0; i < keys.size(); ++i) order[i] = keys[i].second;
  return order;
}

/// A power of two by which lengths are to be multiplied so that the extent of a mesh comes near 1: it changes no digit.
inline double own_unit(double extent) {
  return extent > 0 ? std::ldexp(1.0, -std::ilogb(extent)) : 1;
}

/// Who holds the vertices of a field: all of them are here. The stages of the field ask a holding for all that looks
/// beyond the vertices that are here; `distributed/` has one for the parts of a mesh.
///
/// Vertices that are held here but belong elsewhere ("halo") follow those of one's own in the rows. Rows are cut between
/// holders at multiples of `row_block` only, and sums are taken over blocks of so many rows, each sum of blocks without
/// rounding: so results depend neither on the executor nor on the holders.
struct WholeMesh {
  static constexpr bool is_whole = true;

  /// Row -> vertex; the halo's after one's own.
  std::vector<index_t> rows(std::span<const Vector3> points) const { return spatial_order(points); }
  std::size_t n_own(std::size_t n_here) const { return n_here; }   ///< of so many vertices here
  std::size_t n_rows(std::size_t n_here) const { return n_here; }  ///< of the whole mesh
  std::size_t first_row() const { return 0; }                      ///< of one's own, among all
  std::size_t row_of_all(std::size_t row) const { return row; }    ///< number of a row here among all
  bool is_own(index_t) const { return true; }

  /// See `own_unit`.
  double unit(std::span<const Vector3> points) const {
    double largest = 0;
    for (const Vector3& p : points) largest = std::max(largest, (p - points[0]).cwiseAbs().maxCoeff());
    return own_unit(largest);
  }

  template <class Value>
  void refresh_rows(std::vector<Value>&) const {}  ///< values of the halo, by row
  template <class Value>
  void refresh(std::span<Value>) const {}  ///< values of the halo, by vertex
  template <class Value>
  void gather(std::vector<Value>&) const {}  ///< everybody's values, in order
  double total(ExactSum& sum) const { return sum.value(); }
  std::int64_t total(std::int64_t count) const { return count; }
  double largest(double value) const { return value; }

  /// Tells others of vertices that were visited, and hears of theirs, with the values that go with them.
  /// @return those that were visited elsewhere.
  template <class... Values>
  std::span<const index_t> pass_on(const std::vector<index_t>&, Values...) const {
    return {};
  }
};

inline constexpr std::size_t row_block = 1024;

}  // namespace framehex::detail
