// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/surface/limited_size.hpp"
#include "framehex/surface/surface.hpp"

#include <exception>

namespace framehex::detail {

/// Why points of the size do not do, and where.
struct Obstacle {
  std::vector<Vector3> places;
  std::exception_ptr failure;  ///< what to throw when smaller sizes help no more; null: there is no obstacle
  explicit operator bool() const { return failure != nullptr; }
};

/// @param crossings  pairs of triangles of the surface.
inline Obstacle crossing_triangles(const Surface& surface, std::span<const std::array<index_t, 2>> crossings) {
  Obstacle obstacle;
  obstacle.failure = std::make_exception_ptr(
      invalid_surface("the surface crosses itself, or comes so near to itself that triangles of any size do (" +
                      std::to_string(crossings.size()) + " pairs)"));
  for (const auto& pair : crossings)
    for (const index_t t : pair)
      for (const index_t v : surface.triangles()[t]) obstacle.places.push_back(surface.points[v]);
  return obstacle;
}

/// The vertices, or the corners of the triangles, that a tetrahedraliser names; none when it does not say where.
/// @pre called where `failure` is being handled.
inline Obstacle failed_tetrahedralization(const error& failure, const IndexedTriangleMesh& surface,
                                          std::span<const Vector3> interior) {
  Obstacle obstacle{{}, std::current_exception()};
  const auto add = [&](std::size_t v) {
    obstacle.places.push_back(v < surface.points.size() ? surface.points[v] : interior[v - surface.points.size()]);
  };
  for (const std::size_t i : failure.indices()) {
    if (failure.entity() == Entity::vertex && i < surface.points.size() + interior.size()) add(i);
    if (failure.entity() == Entity::triangle && i < surface.triangles.size())
      std::ranges::for_each(surface.triangles[i], add);
  }
  return obstacle;
}

/// Half of the size at each place.
template <SizeField Size>
std::vector<SizeLimit> halved_sizes(const Obstacle& obstacle, const Size& size) {
  std::vector<SizeLimit> limits;
  index_t hint = no_index;
  for (const Vector3& p : obstacle.places) limits.push_back({p, checked_size(size, p, hint) / 2});
  return limits;
}

}  // namespace framehex::detail
