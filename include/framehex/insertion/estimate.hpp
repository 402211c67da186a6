// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/size_field.hpp"
#include "framehex/insertion/detail/insertion_checks.hpp"
#include "framehex/mesh/indexed_mesh.hpp"

#include <algorithm>

namespace framehex {

/// What sizes ask for.
struct PointEstimate {
  double n_points = 0;
  double largest_size = 0;  ///< of those looked at
};

/// About how many points a surface gets: the integral of 1 / size^2 by three points a triangle.
///
/// @throws invalid_field  when a size is not positive and finite.
/// @par Complexity   O(triangles) evaluations of `size`.
template <TriangleMesh M, SizeField Size>
PointEstimate estimate_surface_points(const M& mesh, const Size& size) {
  const auto& surface = detail::flat(mesh);
  PointEstimate result;
  index_t hint = no_index;
  for (const auto& t : surface.triangles) {
    const Vector3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
    double density = 0;
    for (const Vector3& p :
         {Vector3((4 * a + b + c) / 6), Vector3((a + 4 * b + c) / 6), Vector3((a + b + 4 * c) / 6)}) {
      const double h = detail::checked_size(size, p, hint);
      density += 1 / (3 * h * h);
      result.largest_size = std::max(result.largest_size, h);
    }
    result.n_points += 0.5 * (b - a).cross(c - a).norm() * density;
  }
  return result;
}

/// About how many points a domain in the box from `low` to `high` gets: the integral of 1 / size^3 by a grid of 16^3.
///
/// @param domain  as the concept `Domain`. A domain so thin that the grid misses it is estimated at nothing.
/// @throws invalid_field  when a size is not positive and finite.
template <class Domain, SizeField Size>
PointEstimate estimate_volume_points(const Vector3& low, const Vector3& high, const Domain& domain, const Size& size) {
  constexpr int n = 16;
  PointEstimate result;
  index_t hint = no_index;
  const Vector3 cell = (high - low) / n;
  for (int i = 0; i < n * n * n; ++i) {
    const Vector3 p = low + cell.cwiseProduct(Vector3(i % n + 0.5, i / n % n + 0.5, i / (n * n) + 0.5));
    if (domain.clearance(p, cell.norm()) <= 0) continue;
    const double h = detail::checked_size(size, p, hint);
    result.n_points += cell.prod() / (h * h * h);
    result.largest_size = std::max(result.largest_size, h);
  }
  return result;
}

namespace detail {

/// @throws invalid_option  when a stage is about to make more points than wanted, with the estimate in the message.
inline void check_estimate(const char* stage, double estimate, std::size_t max_points) {
  if (estimate <= static_cast<double>(max_points)) return;
  std::ostringstream message;
  message << "the sizes ask for about " << estimate << " points in the " << stage
          << ", more than max_points = " << max_points << "; use a larger size, or raise max_points if this is meant";
  throw invalid_option(message.str());
}

}  // namespace detail

}  // namespace framehex
