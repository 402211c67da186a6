// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/size_field.hpp"
#include "framehex/surface/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

namespace framehex {

/// Which bends of curves stand out between straight parts, and so show where they are cut off.
struct BendOptions {
  /// rad, > 0 to pi; a cell's side that cuts such a bend off is away from it by its quarter of the size.
  double angle = 10 * std::numbers::pi / 180;
  double straight = 2;  ///< > 0, in sizes: how far the curve is straight about a bend; infinite: no bend stands out

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("BendOptions::angle", o.angle, least_positive, std::numbers::pi);
    visit("BendOptions::straight", o.straight, least_positive, unbounded);
  }
};

namespace detail {

/// A curve between corners, or one that closes without any, whose bends are told by their place in the row.
class CurveBends {
public:
  CurveBends(std::span<const Vector3> points, std::span<const index_t> row, bool closed)
      : points_(points), row_(row), closed_(closed), n_(row.size() - 1) {}

  std::size_t first() const { return closed_ ? 0 : 1; }
  std::size_t end() const { return n_; }

  /// Angle between the segments at a place, rad.
  double turn(std::size_t i) const {
    const Vector3 before = segment(i + n_ - 1), after = segment(i);
    return std::atan2(before.cross(after).norm(), before.dot(after));
  }

  /// Length from a place, forwards or backwards, to where the curve has turned by `allowed`; no more than `reach`.
  double straight_length(std::size_t i, bool forwards, double allowed, double reach) const {
    double length = 0;
    for (std::size_t k = 0; k < n_ && length < reach; ++k) {
      length += segment(forwards ? i + k : i + 2 * n_ - 1 - k).norm();
      const std::size_t next = forwards ? i + k + 1 : i + 2 * n_ - 1 - k;
      if (!closed_ && next % n_ == 0) break;  // the curve ends
      allowed -= turn(next % n_);
      if (allowed < 0) break;
    }
    return std::min(length, reach);
  }

private:
  Vector3 segment(std::size_t i) const { return points_[row_[i % n_ + 1]] - points_[row_[i % n_]]; }

  std::span<const Vector3> points_;
  std::span<const index_t> row_;
  bool closed_;
  std::size_t n_;  // segments
};

/// Is an edge on a rim, or is the surface flat across it?
inline bool on_rim_or_flat(const Surface& surface, index_t a, index_t b) {
  constexpr double flat = 1e-6;  // 1 - cosine
  std::vector<Vector3> normals;
  for (const index_t t : surface.adjacency.triangles_of_vertex[a]) {
    const auto& v = surface.triangles()[t];
    if (std::find(v.begin(), v.end(), b) == v.end()) continue;
    const Vector3 &p = surface.points[v[0]], &q = surface.points[v[1]], &r = surface.points[v[2]];
    normals.push_back((q - p).cross(r - p).normalized());
  }
  return normals.size() == 1 || (normals.size() == 2 && normals[0].dot(normals[1]) > 1 - flat);
}

}  // namespace detail

/// Finds the bends of feature curves that are no corners yet, and that points at the wished distance would cut off
/// visibly: those of polygons. Curves of points that are nearer to each other than the size have none, nor have edges
/// between faces: they bend, as the faces do, because a smooth surface was triangulated.
///
/// A bend stands out where it is `options.angle` or greater, and the curve is about straight for `options.straight`
/// sizes round it, at least a quarter of that on either side: it turns there by less than a quarter of the bend.
///
/// @param size  wished edge length at a point, host's unit.
/// @return vertices, ascending: what `add_corners` takes.
/// @throws invalid_option; invalid_field  when the size at a bend is not positive and finite.
/// @par Complexity   O(n) for curves whose large bends are not denser than the size allows to be seen.
template <SizeField Size>
std::vector<index_t> distinct_bends(const Surface& surface, const Size& size, const BendOptions& options = {}) {
  check_options(options);
  constexpr double rounding = 1e-6;  // the bends of a regular polygon count all or none
  std::vector<index_t> bends;
  if (!std::isfinite(options.straight)) return bends;
  const std::vector<index_t>& corners = surface.features.corners;
  index_t hint = no_index;
  for (std::size_t c = 0; c < surface.features.curves.size(); ++c) {
    const std::span<const index_t> row = surface.features.curves[c];
    const bool closed = row.front() == row.back() && !std::binary_search(corners.begin(), corners.end(), row.front());
    const detail::CurveBends curve(surface.points, row, closed);
    for (std::size_t i = curve.first(); i < curve.end(); ++i) {
      const double turn = curve.turn(i);
      if (!(turn > options.angle - rounding)) continue;
      const index_t before_it = row[(i + row.size() - 2) % (row.size() - 1)];
      if (!detail::on_rim_or_flat(surface, row[i], before_it) || !detail::on_rim_or_flat(surface, row[i], row[i + 1]))
        continue;
      const double wanted = options.straight * detail::checked_size(size, surface.points[row[i]], hint);
      const double before = curve.straight_length(i, false, turn / 4, 0.75 * wanted),
                   after = curve.straight_length(i, true, turn / 4, 0.75 * wanted);
      if (std::min(before, after) >= 0.25 * wanted && before + after >= wanted) bends.push_back(row[i]);
    }
  }
  std::sort(bends.begin(), bends.end());
  return bends;
}

/// Makes vertices inside curves corners: the curves end there.
///
/// @param vertices  of curves, none a corner yet, ascending; what is not on a curve is passed over.
/// @par Complexity   O(n log n) for n vertices of curves.
inline void add_corners(FeatureGraph& features, std::span<const index_t> vertices) {
  if (vertices.empty()) return;
  const auto is_new = [&](index_t v) { return std::binary_search(vertices.begin(), vertices.end(), v); };
  const auto n_old = static_cast<std::ptrdiff_t>(features.corners.size());
  Csr<index_t> curves;
  for (std::size_t c = 0; c < features.curves.size(); ++c) {
    const std::span<const index_t> row = features.curves[c];
    const std::size_t n = row.size() - 1;
    const bool closed =
        row[0] == row[n] && !std::binary_search(features.corners.begin(), features.corners.begin() + n_old, row[0]);
    // A closed curve begins at its first new corner, if it has any.
    std::size_t start = 0;
    if (closed)
      while (start < n && !is_new(row[start])) ++start;
    start %= n;
    for (std::size_t i = 0; i < n; ++i) {
      const index_t v = row[(start + i) % n];
      curves.values.push_back(v);
      if (!is_new(v) || (i == 0 && !closed)) continue;
      features.corners.push_back(v);
      if (i == 0) continue;
      curves.end_row();
      curves.values.push_back(v);
    }
    curves.values.push_back(closed ? row[start] : row[n]);
    curves.end_row();
  }
  std::sort(features.corners.begin(), features.corners.end());
  features.curves = std::move(curves);
}

}  // namespace framehex
