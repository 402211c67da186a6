// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/lemon_matcher.hpp"
#include "framehex/pipeline/mesh_planar.hpp"
#include "framehex/pipeline/mesh_shell.hpp"
#include "framehex/verify/quad_quality.hpp"

#include "support/outlines.hpp"
#include "support/quad_checks.hpp"

#include <catch2/catch.hpp>

using namespace framehex;
using namespace framehex::test;

namespace {

using Sides = std::vector<std::array<Vector3, 2>>;

Sides sides_of(const PlanarOutline& outline) {
  Sides sides;
  for (std::size_t i = 0; i < outline.n_polylines(); ++i) {
    const auto row = outline.polyline(i);
    for (std::size_t k = 1; k < row.size(); ++k) {
      const Vector2 &a = outline.points[row[k - 1]], &b = outline.points[row[k]];
      sides.push_back({Vector3(a.x(), a.y(), 0), Vector3(b.x(), b.y(), 0)});
    }
  }
  return sides;
}

Sides rim_of(const QuadMesh& mesh) {
  Sides sides;
  for (const auto& [a, b] : rim_sides(mesh)) sides.push_back({mesh.points[a], mesh.points[b]});
  return sides;
}

/// From points along some sides to the nearest of others, the greatest distance; by trying all.
double distance(const Sides& from, const Sides& to) {
  double greatest = 0;
  for (const auto& [a, b] : from)
    for (int k = 0; k < 8; ++k) {
      const Vector3 p = a + k / 8.0 * (b - a);
      double least = std::numeric_limits<double>::infinity();
      for (const auto& [c, d] : to) {
        const double x = std::clamp((p - c).dot(d - c) / (d - c).squaredNorm(), 0.0, 1.0);
        least = std::min(least, (c + x * (d - c) - p).norm());
      }
      greatest = std::max(greatest, least);
    }
  return greatest;
}

double diagonal_of(const PlanarOutline& outline) {
  Eigen::AlignedBox2d box;
  for (const Vector2& p : outline.points) box.extend(p);
  return box.diagonal().norm();
}

/// Checks a domain without inner polylines against its outline, both ways.
void check_near(const PlanarOutline& outline, double size) {
  CAPTURE(size);
  const QuadMeshing result = mesh_planar(outline, ConstantSize{size}, LemonMatcher{});
  const double diagonal = diagonal_of(outline);
  const Sides given = sides_of(outline), rim = rim_of(result.mesh);
  const double found = std::max(distance(given, rim), distance(rim, given));
  CHECK(found < 0.01 * diagonal);
  CHECK(result.statistics.deviation < 0.01);
  // What the result tells bounds what is, and not by far.
  CHECK(found <= result.statistics.deviation * diagonal + 1e-12);
  CHECK(found >= 0.5 * result.statistics.deviation * diagonal - 1e-12);
  const verify::QuadQuality quality = verify::quad_quality(result.mesh);
  CHECK(quality.n_triangles == 0);
  CHECK(quality.folded.empty());
  CHECK(quality.index_sum == 4 * euler_characteristic(result.mesh));
}

std::vector<Vector2> ellipse(double a, double b, int n) {
  std::vector<Vector2> points = circle({0, 0}, 1, n);
  for (Vector2& p : points) p = {a * p.x(), b * p.y()};
  return points;
}

PlanarOutline plate_with_hole(double radius) {
  PlanarOutline outline = one_loop(rectangle(4, 2));
  add_loop(outline, circle({0.6, 0.5}, radius, 64));
  return outline;
}

/// Area that the cells leave of the plate.
double hole_left(const QuadMesh& mesh) {
  return 8 - verify::quad_quality(mesh).area;
}

}  // namespace

TEST_CASE("planar domains are near their curved outlines, whatever the size", "[regression]") {
  for (const double size : {0.25, 0.7, 1.0, 3.0, 100.0}) {
    check_near(disc(), size);
    check_near(annulus(), size);
    check_near(one_loop(ellipse(1, 0.1, 200)), size);
    check_near(one_loop(ellipse(1, 0.5, 60)), size);
    check_near(plate_with_hole(0.4), size);
    for (const int n : {13, 16, 24, 36, 48}) check_near(one_loop(circle({0, 0}, 1, n)), size);
  }
}

TEST_CASE("bends below those of corners are not cut by more than is allowed, at sizes near the sides'",
          "[regression]") {
  for (const double degrees : {3.0, 8.0, 15.0, 25.0, 39.0})
    for (const double size : {0.1, 0.3, 0.6, 1.0, 2.0}) {
      CAPTURE(degrees);
      const double a = degrees * std::numbers::pi / 180;
      const Vector2 bend(1, 0), after = bend + Vector2(std::cos(a), std::sin(a));
      check_near(one_loop({{0, 0}, bend, after, after + 1.5 * Vector2(-std::sin(a), std::cos(a)), {0, 1.5}}), size);
    }
}

TEST_CASE("an infinite deviation leaves sizes as they are, and the deviation is told") {
  QuadMeshingOptions options;
  options.retriangulation.max_deviation = std::numeric_limits<double>::infinity();
  const QuadMeshing result = mesh_planar(disc(), ConstantSize{3}, LemonMatcher{}, options);
  CHECK(result.statistics.n_shrunk_places == 0);
  CHECK(rim_sides(result.mesh).size() == 4);
  // Of a square in a circle.
  CHECK(result.statistics.deviation * std::sqrt(8.0) == Approx(1 - std::sqrt(0.5)).epsilon(0.01));
}

TEST_CASE("vertices that slide on a curve do not take it farther from its sides", "[regression]") {
  for (const double radius : {0.1, 0.2, 0.3, 0.45})
    for (const double size : {0.2, 0.3, 0.4, 0.6}) {
      CAPTURE(radius, size);
      QuadMeshingOptions options;
      options.retriangulation.max_deviation = std::numeric_limits<double>::infinity();
      const QuadMeshing moved = mesh_planar(plate_with_hole(radius), ConstantSize{size}, LemonMatcher{}, options);
      options.improvement.scope = QuadImprovementScope::folded;
      const QuadMeshing fixed = mesh_planar(plate_with_hole(radius), ConstantSize{size}, LemonMatcher{}, options);
      const double longest = 2 * radius;
      CHECK(moved.statistics.deviation <=
            std::max(fixed.statistics.deviation, longest / 20 / std::sqrt(20.0)) * (1 + 1e-6));
      CHECK(hole_left(moved.mesh) > 0.9 * hole_left(fixed.mesh));
      if (size > 5 * radius) continue;
      // By itself no side is farther from a curve than a sixth of its length: a hole of six sides keeps 83 %.
      const QuadMeshing usual = mesh_planar(plate_with_hole(radius), ConstantSize{size}, LemonMatcher{});
      CHECK(hole_left(usual.mesh) > 0.8 * std::numbers::pi * radius * radius);
    }
}

TEST_CASE("shells keep their holes as planar domains do", "[regression]") {
  const Eigen::AngleAxisd turn(0.7, Vector3(1, 2, 3).normalized());
  for (const double radius : {0.1, 0.2, 0.3, 0.45}) {
    IndexedTriangleMesh surface = triangulate_outline(plate_with_hole(radius)).mesh;
    for (Vector3& p : surface.points) p = turn * p;
    for (const double size : {0.2, 0.3, 0.4, 0.6}) {
      if (size > 5 * radius) continue;
      CAPTURE(radius, size);
      const QuadMeshing result = mesh_shell(surface, ConstantSize{size}, LemonMatcher{});
      CHECK(hole_left(result.mesh) > 0.8 * std::numbers::pi * radius * radius);
      CHECK(result.statistics.deviation < 0.01);
    }
  }
}

TEST_CASE("a rounding of next to no radius does not make thousands of cells") {
  std::vector<Vector2> points{{0, 0}, {1, 0}};
  for (int i = 0; i <= 10; ++i) {  // in place of the corner (1, 1)
    const double a = i * std::numbers::pi / 20;
    points.emplace_back(Vector2(1, 1) + 1e-5 * Vector2(std::cos(a) - 1, std::sin(a) - 1));
  }
  points.emplace_back(0, 1);
  const QuadMeshing result = mesh_planar(one_loop(points), ConstantSize{0.1}, LemonMatcher{});
  CHECK(result.mesh.cells.size() < 400);
  CHECK(result.statistics.deviation < 0.01);
}

TEST_CASE("the distance of a curve from a chord is that of the farthest of its points, tried one by one") {
  const std::vector<Vector2> points = circle({0, 0}, 1, 40);
  const Surface surface = triangulate_outline(one_loop(points)).surface();
  const FeatureCarriers carriers(surface);
  REQUIRE(carriers.n_curves() == 1);
  const auto at = [](double angle) {  // on the polygon
    const double step = 2 * std::numbers::pi / 40, k = std::floor(angle / step), x = angle / step - k;
    const auto corner = [&](double i) { return Vector3(std::cos(i * step), std::sin(i * step), 0); };
    return Vector3((1 - x) * corner(k) + x * corner(k + 1));
  };
  for (const double from : {0.0, 0.4, 3.0, 5.9, 6.2})
    for (const double length : {0.01, 0.1, 0.5, 1.5, 3.0}) {
      CAPTURE(from, length);
      const Vector3 a = at(from), b = at(from + length);
      double greatest = 0;
      for (int i = 0; i <= 4000; ++i) {
        const Vector3 p = at(from + length * i / 4000);
        const double x = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
        greatest = std::max(greatest, (a + x * (b - a) - p).norm());
      }
      for (const auto& [p, q] : {std::pair{a, b}, {b, a}}) {
        const double found = carriers.farthest_from_chord(0, p, q).distance;
        CHECK(found >= greatest - 1e-12);
        CHECK(found <= greatest + 2e-3);
      }
    }
}
