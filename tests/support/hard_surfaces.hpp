// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "support/surfaces.hpp"

/// Small closed surfaces, free of self-intersections, each with what makes a kind of body hard at sizes near or above it.
namespace framehex::test {

/// Sections of n points one after the other, joined by quadrilaterals cut in two; the first and the last are closed by
/// fans about their centres.
inline IndexedTriangleMesh lofted(const std::vector<std::vector<Vector3>>& sections) {
  IndexedTriangleMesh mesh;
  const auto n = static_cast<index_t>(sections.front().size()), last = static_cast<index_t>(sections.size() - 1);
  for (const auto& section : sections) mesh.points.insert(mesh.points.end(), section.begin(), section.end());
  for (const auto* section : {&sections.front(), &sections.back()}) {
    Vector3 centre = Vector3::Zero();
    for (const Vector3& p : *section) centre += p / n;
    mesh.points.push_back(centre);
  }
  const index_t bottom = (last + 1) * n, top = bottom + 1;
  for (index_t i = 0; i < n; ++i) {
    const index_t j = (i + 1) % n;
    mesh.triangles.push_back({bottom, j, i});
    mesh.triangles.push_back({top, last * n + i, last * n + j});
    for (index_t s = 0; s < last; ++s) {
      mesh.triangles.push_back({s * n + i, s * n + j, (s + 1) * n + j});
      mesh.triangles.push_back({s * n + i, (s + 1) * n + j, (s + 1) * n + i});
    }
  }
  return mesh;
}

/// A hub of radius 0.3 and height 0.6 with blades out to radius 1, which turn by `twist` from bottom to top.
inline IndexedTriangleMesh rotor_surface(int n_blades, double thickness, double twist, int n_layers) {
  std::vector<std::vector<Vector3>> sections;
  for (int layer = 0; layer <= n_layers; ++layer) {
    const double z = 0.6 * layer / n_layers;
    const Eigen::AngleAxisd turn(twist * layer / n_layers, Vector3::UnitZ());
    std::vector<Vector3>& section = sections.emplace_back();
    for (int blade = 0; blade < n_blades; ++blade) {
      const double step = 2 * std::numbers::pi / n_blades;
      const Eigen::AngleAxisd at(blade * step, Vector3::UnitZ());
      for (const auto& [x, y] : {std::pair{0.3, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {0.3, 1.0}})
        section.push_back(turn * (at * Vector3(x, y * thickness / 2, z)));
      section.push_back(turn * (at * Vector3(0.3 * std::cos(step / 2), 0.3 * std::sin(step / 2), z)));
    }
  }
  return lofted(sections);
}

/// A bar of radius 0.3 bent to a ring of radius 1 whose ends are `gap` apart.
inline IndexedTriangleMesh horseshoe_surface(double gap, int n_sections, int n_around) {
  std::vector<std::vector<Vector3>> sections;
  for (int s = 0; s <= n_sections; ++s) {
    const double u = gap / 2 + (2 * std::numbers::pi - gap) * s / n_sections;
    std::vector<Vector3>& section = sections.emplace_back();
    for (int i = 0; i < n_around; ++i) {
      const double v = -2 * std::numbers::pi * i / n_around, r = 1 + 0.3 * std::cos(v);
      section.emplace_back(r * std::cos(u), r * std::sin(u), 0.3 * std::sin(v));
    }
  }
  return lofted(sections);
}

/// A body of revolution of cylinders stacked on each other, each narrower than that below it by `ledge`.
inline IndexedTriangleMesh ledged_surface(double ledge, int n_ledges, int n_around) {
  std::vector<std::vector<Vector3>> sections;
  for (int s = 0; s <= n_ledges; ++s)
    for (const double z : {s, s + 1}) {
      std::vector<Vector3>& section = sections.emplace_back();
      for (int i = 0; i < n_around; ++i) {
        const double angle = 2 * std::numbers::pi * i / n_around, r = 1 - ledge * s;
        section.emplace_back(r * std::cos(angle), r * std::sin(angle), 0.5 * z);
      }
    }
  return lofted(sections);
}

/// A ball with four round holes inside; walls between them and the outside are `wall` thick at their thinnest.
inline IndexedTriangleMesh holed_ball(double wall) {
  IndexedTriangleMesh ball = sphere_surface(1, 4);
  // Four of radius r at distance d from the centre touch each other when d = sqrt(3/2) r, and the ball when d = 1 - r.
  const double r = (1 - wall - std::sqrt(1.5) * wall / 2) / (1 + std::sqrt(1.5)), d = 1 - wall - r;
  const IndexedTriangleMesh hole = sphere_surface(r, 3);
  for (const Vector3& towards : {Vector3(1, 1, 1), Vector3(1, -1, -1), Vector3(-1, 1, -1), Vector3(-1, -1, 1)}) {
    const auto first = static_cast<index_t>(ball.points.size());
    for (const Vector3& p : hole.points) ball.points.push_back(p + d * towards.normalized());
    for (const auto& t : hole.triangles) ball.triangles.push_back({first + t[0], first + t[2], first + t[1]});
  }
  return ball;
}

/// A torus whose vertices stand off it by up to `depth`, as those of a scan do.
inline IndexedTriangleMesh rough_torus(double depth, int nu, int nv) {
  IndexedTriangleMesh mesh = torus_surface(1, 0.35, nu, nv);
  unsigned state = 12345;
  for (Vector3& p : mesh.points) {
    state = state * 1664525u + 1013904223u;
    const Vector3 axis = Vector3(p.x(), p.y(), 0).normalized();
    p += depth * ((state >> 8) / double(1 << 23) - 1) * (p - axis).normalized();
  }
  return mesh;
}

/// A coarse torus of long triangles: every second ring of vertices is `apart` from the one before.
inline IndexedTriangleMesh needle_torus(double apart, int n_pairs, int n_around) {
  IndexedTriangleMesh mesh = torus_surface(1, 0.35, 2 * n_pairs, n_around);
  for (int ring = 1; ring < 2 * n_pairs; ring += 2)
    for (int i = 0; i < n_around; ++i) {
      const double back = apart - std::numbers::pi / n_pairs;
      Vector3& p = mesh.points[static_cast<std::size_t>(ring * n_around + i)];
      p = Eigen::AngleAxisd(back, Vector3::UnitZ()) * p;
    }
  return mesh;
}

/// A ball with bumps, its surface as fine as that of a scan.
inline IndexedTriangleMesh bumpy_ball(double height) {
  IndexedTriangleMesh mesh = sphere_surface(1, 4);
  for (Vector3& p : mesh.points)
    p *= 1 + height * std::sin(4 * p.x() + 1) * std::sin(5 * p.y()) * std::sin(4 * p.z() + 2);
  return mesh;
}

}  // namespace framehex::test
