// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "support/surfaces.hpp"

namespace framehex::test {

/// Box [0, 2] x [0, 1] x [0, 1] of two materials; the wall between them stands at x = `below` at its foot and at
/// x = `above` at its top.
inline IndexedTriangleMesh two_material_box(double below = 0.8, double above = 1.2) {
  IndexedTriangleMesh mesh;
  for (const double z : {0.0, 1.0})
    for (const double y : {0.0, 1.0})
      for (const double x : {0.0, below + (above - below) * z, 2.0}) mesh.points.emplace_back(x, y, z);
  const auto at = [](index_t x, index_t y, index_t z) { return 6 * z + 3 * y + x; };
  const auto quad = [&](index_t a, index_t b, index_t c, index_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (index_t x = 0; x < 2; ++x) {
    quad(at(x, 0, 0), at(x, 1, 0), at(x + 1, 1, 0), at(x + 1, 0, 0));
    quad(at(x, 0, 1), at(x + 1, 0, 1), at(x + 1, 1, 1), at(x, 1, 1));
    quad(at(x, 0, 0), at(x + 1, 0, 0), at(x + 1, 0, 1), at(x, 0, 1));
    quad(at(x, 1, 0), at(x, 1, 1), at(x + 1, 1, 1), at(x + 1, 1, 0));
  }
  quad(at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0));
  quad(at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1));  // the wall: its normal points to the right
  quad(at(2, 0, 0), at(2, 1, 0), at(2, 1, 1), at(2, 0, 1));
  return mesh;
}

inline void append(IndexedTriangleMesh& mesh, const IndexedTriangleMesh& part) {
  const auto n = static_cast<index_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), part.points.begin(), part.points.end());
  for (const auto& t : part.triangles) mesh.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
}

/// Spheres of radius 1, 0.7 and 0.4 about the origin: three materials.
inline IndexedTriangleMesh nested_shells(int levels = 3) {
  IndexedTriangleMesh mesh = sphere_surface(1, levels);
  append(mesh, sphere_surface(0.7, levels));
  append(mesh, sphere_surface(0.4, levels - 1));
  return mesh;
}

/// Box [-1, 1] x [-1, 1] x [-1, 0] in whose top a ball of radius 0.5 is sunk to its equator.
///
/// @param n  points on the equator, a multiple of 8.
inline IndexedTriangleMesh ball_half_in_box(index_t n = 32) {
  constexpr double radius = 0.5;
  IndexedTriangleMesh mesh;
  for (const double z : {-1.0, 0.0})
    for (const auto& [x, y] : {std::pair{1.0, 1.0}, {-1.0, 1.0}, {-1.0, -1.0}, {1.0, -1.0}})
      mesh.points.emplace_back(x, y, z);
  const auto quad = [&](index_t a, index_t b, index_t c, index_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  quad(3, 2, 1, 0);
  for (index_t i = 0; i < 4; ++i) quad(4 + i, i, (i + 1) % 4, 4 + (i + 1) % 4);
  const auto ring = [&](double z_angle) {
    const auto first = static_cast<index_t>(mesh.points.size());
    for (index_t i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      mesh.points.emplace_back(radius * std::cos(z_angle) * std::cos(angle),
                               radius * std::cos(z_angle) * std::sin(angle), radius * std::sin(z_angle));
    }
    return first;
  };
  const index_t equator = ring(0);
  for (index_t i = 0; i < n; ++i) {
    const index_t corner = 4 + i * 4 / n, a = equator + i, b = equator + (i + 1) % n;
    mesh.triangles.push_back({corner, b, a});
    if ((i + 1) * 4 % n == 0) mesh.triangles.push_back({corner, 4 + (corner - 3) % 4, b});
  }
  // Both halves of the ball, outward as seen from its middle.
  for (const double sign : {1.0, -1.0}) {
    index_t below = equator;
    const auto turned = [&](index_t a, index_t b, index_t c) {
      if (sign > 0)
        mesh.triangles.push_back({a, b, c});
      else
        mesh.triangles.push_back({a, c, b});
    };
    const index_t n_rings = n / 4;
    for (index_t k = 1; k < n_rings; ++k) {
      const index_t above = ring(sign * 0.5 * std::numbers::pi * k / n_rings);
      for (index_t i = 0; i < n; ++i) {
        const index_t j = (i + 1) % n;
        turned(below + i, below + j, above + j);
        turned(below + i, above + j, above + i);
      }
      below = above;
    }
    const auto pole = static_cast<index_t>(mesh.points.size());
    mesh.points.emplace_back(0, 0, sign * radius);
    for (index_t i = 0; i < n; ++i) turned(below + i, below + (i + 1) % n, pole);
  }
  return mesh;
}

}  // namespace framehex::test
