// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/surface.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace framehex {

/// A place on a triangulated surface with a direction along it.
struct SurfaceRay {
  index_t triangle;   ///< that holds the point
  Vector3 point;      ///< in the triangle's plane
  Vector3 direction;  ///< unit, in the triangle's plane
};

/// Where a straight walk ended.
struct SurfaceWalk {
  SurfaceRay end;
  double length;            ///< walked, along the surface
  index_t wall = no_index;  ///< half edge that stopped the walk; `no_index` when it went all the way
};

/// Straightest paths on a triangulated surface: straight in each triangle, unfolded across each edge, so that distances
/// are those along the surface. Walls (feature edges, rims) stop them.
///
/// Concurrent walks are safe. A reference to the surface is kept.
class SurfaceWalker {
public:
  /// @param surface  its features are walls.
  explicit SurfaceWalker(const Surface& surface)
      : points_(surface.points), adjacency_(surface.adjacency), walls_(surface.features.is_feature) {
    normals_.reserve(surface.triangles().size());
    for (const auto& t : surface.triangles()) {
      const Vector3 normal = (points_[t[1]] - points_[t[0]]).cross(points_[t[2]] - points_[t[0]]);
      const double length = normal.norm();
      normals_.push_back(length > 0 ? Vector3(normal / length) : Vector3::Zero());
    }
  }

  explicit SurfaceWalker(const Surface&&) = delete;

  /// Outward unit normal; zero for a triangle without area.
  const Vector3& normal(index_t triangle) const { return normals_[triangle]; }

  bool is_wall(index_t half_edge) const {
    return adjacency_.opposite[half_edge] == no_index || (!walls_.empty() && walls_[half_edge] != 0);
  }

  Vector3 edge_direction(index_t half_edge) const {
    return (points_[adjacency_.to(half_edge)] - points_[adjacency_.from(half_edge)]).normalized();
  }

  /// The same place with the direction turned by `angle` (rad) about the outward normal.
  SurfaceRay turned(SurfaceRay ray, double angle) const {
    const Vector3 side = normals_[ray.triangle].cross(ray.direction);
    ray.direction = (std::cos(angle) * ray.direction + std::sin(angle) * side).normalized();
    return ray;
  }

  /// Goes straight ahead for `length`.
  ///
  /// @return the end; a walk that meets a wall ends there with `.wall` set, as does one that meets a triangle without
  /// area.
  /// @par Complexity   O(triangles crossed).
  SurfaceWalk walk(SurfaceRay ray, double length) const {
    // A path round a vertex of high valence crosses many triangles in no length; nothing legitimate comes near this.
    constexpr int max_crossings = 100'000;
    double walked = 0;
    for (int crossings = 0; crossings < max_crossings; ++crossings) {
      const auto [exit, distance] = exit_of(ray);
      if (exit == no_index) return {ray, walked, 3 * ray.triangle};
      if (walked + distance >= length) {
        ray.point += (length - walked) * ray.direction;
        return {ray, length};
      }
      walked += distance;
      ray.point += distance * ray.direction;
      if (is_wall(exit)) return {ray, walked, exit};
      cross(ray, exit);
    }
    return {ray, walked, 3 * ray.triangle};
  }

private:
  struct Exit {
    index_t half_edge;
    double distance;
  };

  Exit exit_of(const SurfaceRay& ray) const {
    constexpr double parallel = 1e-12;
    Exit exit{no_index, 0};
    for (index_t h = 3 * ray.triangle; h < 3 * ray.triangle + 3; ++h) {
      const Vector3 out = edge_direction(h).cross(normals_[ray.triangle]);
      const double rate = ray.direction.dot(out);
      if (!(rate > parallel)) continue;
      const double distance = std::max((points_[adjacency_.from(h)] - ray.point).dot(out) / rate, 0.0);
      if (exit.half_edge == no_index || distance < exit.distance) exit = {h, distance};
    }
    return exit;
  }

  /// Moves a ray on edge `exit` into the triangle beyond, its angle to the edge kept.
  void cross(SurfaceRay& ray, index_t exit) const {
    const Vector3 edge = edge_direction(exit);
    const index_t next = adjacency_.opposite[exit] / 3;
    const Vector3 out = edge.cross(normals_[ray.triangle]), in = edge.cross(normals_[next]);
    const double along = ray.direction.dot(edge), across = ray.direction.dot(out);
    ray.direction = (along * edge + across * in).normalized();
    const Vector3& origin = points_[adjacency_.from(exit)];
    ray.point = origin + (ray.point - origin).dot(edge) * edge;
    ray.triangle = next;
  }

  std::span<const Vector3> points_;
  const TriangleAdjacency& adjacency_;
  std::span<const std::uint8_t> walls_;
  std::vector<Vector3> normals_;
};

}  // namespace framehex
