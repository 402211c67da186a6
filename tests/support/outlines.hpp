// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/planar_outline.hpp"

#include <cmath>
#include <numbers>

namespace framehex::test {

/// Adds a closed polyline of points of its own.
inline void add_loop(PlanarOutline& outline, const std::vector<Vector2>& points) {
  const auto first = static_cast<index_t>(outline.points.size());
  for (const Vector2& p : points) {
    outline.loops.values.push_back(static_cast<index_t>(outline.points.size()));
    outline.points.push_back(p);
  }
  outline.loops.values.push_back(first);
  outline.loops.end_row();
}

inline std::vector<Vector2> circle(const Vector2& centre, double radius, int n, double phase = 0) {
  std::vector<Vector2> points;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n + phase;
    points.emplace_back(centre + radius * Vector2(std::cos(angle), std::sin(angle)));
  }
  return points;
}

/// Of a polygon that runs anticlockwise; negative, clockwise.
inline double polygon_area(const std::vector<Vector2>& points) {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector2 &p = points[i], &q = points[(i + 1) % points.size()];
    sum += (p.x() * q.y() - p.y() * q.x()) / 2;
  }
  return sum;
}

inline PlanarOutline one_loop(const std::vector<Vector2>& points) {
  PlanarOutline outline;
  add_loop(outline, points);
  return outline;
}

inline std::vector<Vector2> rectangle(double width, double height, double degrees = 0) {
  const double a = degrees * std::numbers::pi / 180;
  const Vector2 x(std::cos(a), std::sin(a)), y(-std::sin(a), std::cos(a));
  return {Vector2(0, 0), width * x, width * x + height * y, height * y};
}

inline PlanarOutline disc() {
  return one_loop(circle({0, 0}, 1, 256));
}

inline PlanarOutline annulus() {
  PlanarOutline outline = disc();
  add_loop(outline, circle({0, 0}, 0.4, 128));
  return outline;
}

inline PlanarOutline ell() {
  return one_loop({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
}

inline PlanarOutline plate_with_holes() {
  PlanarOutline outline = one_loop(rectangle(4, 2));
  add_loop(outline, circle({0.8, 1}, 0.35, 96));
  add_loop(outline, circle({2.1, 1.25}, 0.25, 96));
  add_loop(outline, circle({3.2, 0.8}, 0.45, 96));
  return outline;
}

/// Teeth with straight flanks, and a bore.
inline PlanarOutline gear(int n_teeth = 12) {
  std::vector<Vector2> points;
  const double step = 2 * std::numbers::pi / n_teeth;
  for (int i = 0; i < n_teeth; ++i)
    for (const auto& [at, radius] : {std::pair{0.0, 0.8}, {0.28, 0.8}, {0.38, 1.0}, {0.66, 1.0}, {0.76, 0.8}}) {
      const double angle = step * (i + at);
      points.emplace_back(radius * Vector2(std::cos(angle), std::sin(angle)));
    }
  PlanarOutline outline = one_loop(points);
  add_loop(outline, circle({0, 0}, 0.3, 96));
  return outline;
}

/// A NACA 0012 section of chord 1 in a box.
inline PlanarOutline section_in_box() {
  PlanarOutline outline = one_loop({{-1, -1}, {2.5, -1}, {2.5, 1}, {-1, 1}});
  std::vector<Vector2> points;
  const int n = 80;
  for (int i = 0; i < 2 * n; ++i) {
    const double angle = std::numbers::pi * i / n, x = (1 + std::cos(angle)) / 2;
    const double y =
        0.6 * (0.2969 * std::sqrt(x) - 0.126 * x - 0.3516 * x * x + 0.2843 * x * x * x - 0.1036 * x * x * x * x);
    points.emplace_back(x, i <= n ? y : -y);
  }
  add_loop(outline, points);
  return outline;
}

}  // namespace framehex::test
