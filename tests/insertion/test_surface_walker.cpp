// SPDX-License-Identifier: BSL-1.0
#include "framehex/surface/cross_sampler.hpp"
#include "support/insertion_fixtures.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace framehex;
using namespace framehex::test;

namespace {

/// Any place on triangle t with any direction along it.
SurfaceRay ray_on(const Surface& surface, const SurfaceWalker& walker, index_t t, double angle) {
  const auto& v = surface.triangles()[t];
  const Vector3 p = 0.5 * surface.points[v[0]] + 0.3 * surface.points[v[1]] + 0.2 * surface.points[v[2]];
  return walker.turned({t, p, walker.edge_direction(3 * t)}, angle);
}

Surface without_features(const IndexedTriangleMesh& mesh) {
  return {mesh.points, make_adjacency(mesh), {}};
}

double plane_distance(const Surface& surface, const SurfaceWalker& walker, const SurfaceRay& at) {
  return std::abs((at.point - surface.points[surface.triangles()[at.triangle][0]]).dot(walker.normal(at.triangle)));
}

}  // namespace

TEST_CASE("a walk on a cylinder is straight on the unrolled cylinder") {
  // The mantle of a prism over a regular polygon unrolls without distortion: arc length along the polygon against
  // height.
  const int n = 24;
  const Surface surface = without_features(cylinder_surface(1, 3, n));
  const SurfaceWalker walker(surface);
  const double side = 2 * std::sin(std::numbers::pi / n);
  const auto unrolled = [&](const Vector3& p) {
    const double sector = 2 * std::numbers::pi / n;
    double angle = std::atan2(p.y(), p.x());
    if (angle < 0) angle += 2 * std::numbers::pi;
    const double i = std::floor(angle / sector + 1e-9);
    const double within = std::tan(angle - (i + 0.5) * sector) * std::cos(0.5 * sector);
    return Eigen::Vector2d(side * i + 0.5 * side + within, p.z());
  };
  const index_t mantle = static_cast<index_t>(surface.triangles().size()) - 2 * static_cast<index_t>(n) + 4;
  for (int k = 0; k < 40; ++k) {
    const SurfaceRay ray = ray_on(surface, walker, mantle, 0.15 * k);
    const double length = 0.55;  // the lid is 0.6 away
    const SurfaceWalk walk = walker.walk(ray, length);
    REQUIRE(walk.wall == no_index);
    CHECK(walk.length == length);
    Eigen::Vector2d moved = unrolled(walk.end.point) - unrolled(ray.point);
    moved.x() -= side * n * std::round(moved.x() / (side * n));
    CHECK(moved.norm() == Approx(length).epsilon(1e-9));
    CHECK(plane_distance(surface, walker, walk.end) < 1e-12);
    CHECK(std::abs(walk.end.direction.norm() - 1) < 1e-12);
  }
}

TEST_CASE("a walk can be walked back") {
  const Surface surface = without_features(torus_surface(3, 1, 40, 20));
  const SurfaceWalker walker(surface);
  for (index_t t = 0; t < surface.triangles().size(); t += 37) {
    const SurfaceRay start = ray_on(surface, walker, t, 0.7 * t);
    SurfaceWalk there = walker.walk(start, 2.5);
    REQUIRE(there.wall == no_index);
    CHECK(plane_distance(surface, walker, there.end) < 1e-10);
    there.end.direction = -there.end.direction;
    const SurfaceWalk back = walker.walk(there.end, 2.5);
    CHECK((back.end.point - start.point).norm() < 1e-8);
    CHECK((back.end.direction + start.direction).norm() < 1e-8);
  }
}

TEST_CASE("on a fine sphere a walk follows a great circle") {
  const Surface surface = without_features(sphere_surface(1, 5));
  const SurfaceWalker walker(surface);
  for (index_t t = 0; t < surface.triangles().size(); t += 509) {
    const SurfaceRay start = ray_on(surface, walker, t, t);
    const SurfaceWalk walk = walker.walk(start, 1.0);
    const Vector3 expected = std::cos(1.0) * start.point.normalized() + std::sin(1.0) * start.direction;
    CHECK((walk.end.point - expected).norm() < 0.02);
  }
}

TEST_CASE("walks stop at walls, and pass through vertices and along edges of a plane") {
  const Surface surface(box_surface({4, 4, 1}, 4, 4, 1));
  const SurfaceWalker walker(surface);
  index_t top = 0;
  while (walker.normal(top).z() < 0.5 || !surface.points[surface.triangles()[top][0]].head<2>().isZero()) ++top;
  const Vector3 corner(0, 0, 1);
  for (const auto& [x, y] : {std::pair{1.0, 1.0}, {2.0, 1.0}, {3.0, 1.0}, {1.0, 0.0}, {1.0, 0.5}, {0.0, 1.0}}) {
    const Vector3 d = Vector3(x, y, 0).normalized();
    // From the corner, and from a vertex that is none.
    for (const double from : {0.0, 1.0}) {
      SurfaceRay ray{top, corner, d};
      if (from > 0) ray = walker.walk({top, corner, Vector3(1, 1, 0).normalized()}, std::sqrt(2.0)).end;
      ray.direction = d;
      const Vector3 origin = ray.point;
      const double room = std::min(x > 0 ? (4 - from) / d.x() : 9, y > 0 ? (4 - from) / d.y() : 9);
      if (from == 0 && x * y == 0) continue;  // along the wall itself
      const SurfaceWalk inside = walker.walk(ray, 0.9 * room);
      CHECK(inside.wall == no_index);
      CHECK((inside.end.point - origin - 0.9 * room * d).norm() < 1e-12);
      const SurfaceWalk stopped = walker.walk(ray, 1.5 * room);
      CHECK(stopped.wall != no_index);
      CHECK(stopped.length == Approx(room));
      CHECK((stopped.end.point - origin - room * d).norm() < 1e-12);
    }
  }
}

TEST_CASE("the cross between triangles is exact for a field that turns linearly on a plane") {
  const Surface surface(box_surface({4, 4, 1}, 16, 16, 4));
  const SurfaceWalker walker(surface);
  const auto angle_at = [](const Vector3& p) { return 0.3 * p.x() - 0.2 * p.y(); };
  std::vector<Quaternion> frames;
  for (index_t t = 0; t < surface.triangles().size(); ++t) {
    const auto& v = surface.triangles()[t];
    const Vector3 centre = (surface.points[v[0]] + surface.points[v[1]] + surface.points[v[2]]) / 3;
    const Quaternion to_normal = Quaternion::FromTwoVectors(Vector3::UnitZ(), walker.normal(t));
    // Quarter turns are the same cross.
    frames.push_back(to_normal * Eigen::AngleAxisd(angle_at(centre) + t % 4 * std::numbers::pi / 2, Vector3::UnitZ()));
  }
  std::vector<double> smoothness(surface.points.size());
  for (std::size_t v = 0; v < smoothness.size(); ++v) smoothness[v] = 0.1 * surface.points[v].x() + 0.2;
  const CrossSampler cross(surface, walker, frames, smoothness);
  std::size_t checked = 0;
  for (index_t t = 0; t < surface.triangles().size(); ++t) {
    const SurfaceRay at = ray_on(surface, walker, t, 0);
    const Vector3 inner = Vector3(2, 2, at.point.z()) - at.point;
    if (walker.normal(t).z() < 0.5 || inner.cwiseAbs().maxCoeff() > 1.6) continue;
    const CrossSampler::Sample sample = cross.at(t, at.point);
    const Vector3 expected(std::cos(angle_at(at.point)), std::sin(angle_at(at.point)), 0);
    const Vector3 local = sample.axes.transpose() * expected;
    CHECK(local.cwiseAbs().maxCoeff() > 1 - 1e-6);
    CHECK(sample.smoothness == Approx(0.1 * at.point.x() + 0.2));
    ++checked;
  }
  CHECK(checked > 100);
}
