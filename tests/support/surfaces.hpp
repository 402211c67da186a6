// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/indexed_mesh.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace framehex::test {

/// Box [0, size] whose faces are grids of nx, ny, nz intervals; one each gives the 12 triangles of CAD.
inline IndexedTriangleMesh box_surface(const Vector3& size, int nx = 1, int ny = 1, int nz = 1) {
  IndexedTriangleMesh mesh;
  const std::array<int, 3> n{nx, ny, nz};
  std::map<std::array<int, 3>, index_t> known;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [it, is_new] = known.try_emplace(at, static_cast<index_t>(mesh.points.size()));
    if (is_new) mesh.points.emplace_back(size.x() * at[0] / nx, size.y() * at[1] / ny, size.z() * at[2] / nz);
    return it->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (int i = 0; i < n[u]; ++i)
        for (int j = 0; j < n[v]; ++j) {
          const auto at = [&](int di, int dj) {
            std::array<int, 3> p{};
            p[axis] = side * n[axis];
            p[u] = i + di;
            p[v] = j + dj;
            return vertex(p);
          };
          const index_t a = at(0, 0), b = at(1, 0), c = at(1, 1), d = at(0, 1);
          if (side == 1) {
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
          } else {
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({a, d, c});
          }
        }
    }
  return mesh;
}

/// Moebius strip of n quadrilaterals cut in two, the ends joined upside down; radius 1, width 0.6.
inline IndexedTriangleMesh moebius_strip(index_t n) {
  IndexedTriangleMesh strip;
  for (index_t i = 0; i < n; ++i)
    for (const double side : {-0.3, 0.3}) {
      const double angle = 2 * std::numbers::pi * i / n, half = angle / 2, r = 1 + side * std::cos(half);
      strip.points.emplace_back(r * std::cos(angle), r * std::sin(angle), side * std::sin(half));
    }
  for (index_t i = 0; i < n; ++i) {
    const bool is_last = i + 1 == n;
    const index_t a = 2 * i, b = a + 1, c = is_last ? 1 : a + 2, d = is_last ? 0 : a + 3;
    strip.triangles.push_back({a, c, b});
    strip.triangles.push_back({b, c, d});
  }
  return strip;
}

/// Torus about z, radii `major` and `minor`; nu by nv quadrilaterals cut in two.
inline IndexedTriangleMesh torus_surface(double major, double minor, int nu, int nv) {
  IndexedTriangleMesh mesh;
  for (int i = 0; i < nu; ++i)
    for (int j = 0; j < nv; ++j) {
      const double u = 2 * std::numbers::pi * i / nu, v = 2 * std::numbers::pi * j / nv;
      const double r = major + minor * std::cos(v);
      mesh.points.emplace_back(r * std::cos(u), r * std::sin(u), minor * std::sin(v));
    }
  const auto at = [&](int i, int j) { return static_cast<index_t>((i % nu) * nv + j % nv); };
  for (int i = 0; i < nu; ++i)
    for (int j = 0; j < nv; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

/// Sphere about the origin: an icosahedron whose triangles are cut in four `levels` times.
inline IndexedTriangleMesh sphere_surface(double radius, int levels) {
  const double g = std::numbers::phi;
  IndexedTriangleMesh mesh;
  mesh.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                 {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<index_t, index_t>, index_t> middles;
    const auto middle = [&](index_t a, index_t b) {
      const auto [it, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<index_t>(mesh.points.size()));
      if (is_new) mesh.points.push_back((mesh.points[a] + mesh.points[b]) / 2);
      return it->second;
    };
    std::vector<std::array<index_t, 3>> finer;
    for (const auto& t : mesh.triangles) {
      const index_t ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
    for (Vector3& p : mesh.points) p = p.normalized();
  }
  for (Vector3& p : mesh.points) p = radius * p.normalized();
  return mesh;
}

/// Prism along z over a polygon (anticlockwise, star-shaped about its first vertex), as an exporter of CAD models makes
/// it: lids are fans of needles, sides two triangles each.
inline IndexedTriangleMesh extruded_polygon(const std::vector<Eigen::Vector2d>& polygon, double height) {
  IndexedTriangleMesh mesh;
  const auto n = static_cast<index_t>(polygon.size());
  for (const double z : {0.0, height})
    for (const auto& p : polygon) mesh.points.emplace_back(p.x(), p.y(), z);
  for (index_t i = 1; i + 1 < n; ++i) {
    mesh.triangles.push_back({0, i + 1, i});
    mesh.triangles.push_back({n, n + i, n + i + 1});
  }
  for (index_t i = 0; i < n; ++i) {
    const index_t j = (i + 1) % n;
    mesh.triangles.push_back({i, j, n + j});
    mesh.triangles.push_back({i, n + j, n + i});
  }
  return mesh;
}

/// Cylinder about z with n flat facets.
inline IndexedTriangleMesh cylinder_surface(double radius, double height, int n) {
  std::vector<Eigen::Vector2d> polygon;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    polygon.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return extruded_polygon(polygon, height);
}

/// Tube about z with n flat facets on either side.
inline IndexedTriangleMesh tube_surface(double inner, double outer, double height, int n) {
  IndexedTriangleMesh mesh;
  for (const double z : {0.0, height})
    for (const double r : {outer, inner})
      for (int i = 0; i < n; ++i) {
        const double angle = 2 * std::numbers::pi * i / n;
        mesh.points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
      }
  const auto at = [&](int lid, int wall, int i) { return static_cast<index_t>((2 * lid + wall) * n + i % n); };
  const auto add = [&](index_t a, index_t b, index_t c, index_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (int i = 0; i < n; ++i) {
    add(at(0, 0, i), at(0, 0, i + 1), at(1, 0, i + 1), at(1, 0, i));
    add(at(0, 1, i + 1), at(0, 1, i), at(1, 1, i), at(1, 1, i + 1));
    add(at(1, 0, i), at(1, 0, i + 1), at(1, 1, i + 1), at(1, 1, i));
    add(at(0, 0, i + 1), at(0, 0, i), at(0, 1, i), at(0, 1, i + 1));
  }
  return mesh;
}

/// Regular tetrahedron about the origin, its edges as long as `side`.
inline IndexedTriangleMesh tetrahedron_surface(double side) {
  const double s = side / std::sqrt(8.0);
  return {{{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
}

/// L of arms 2 and width 1, extruded by 1; its lids are fans about the inner corner.
inline IndexedTriangleMesh l_shape_surface() {
  return extruded_polygon({{1, 1}, {1, 2}, {0, 2}, {0, 0}, {2, 0}, {2, 1}}, 1.0);
}

}  // namespace framehex::test
