// SPDX-License-Identifier: BSL-1.0
#include "framehex/surface/outline_triangulation.hpp"

#include "support/outlines.hpp"

#include <boost/random/uniform_real_distribution.hpp>
#include <catch2/catch.hpp>

#include <random>

using namespace framehex;
using namespace framehex::test;

namespace {

double area(const OutlineTriangulation& t) {
  double sum = 0;
  for (const auto& v : t.mesh.triangles) {
    const auto& p = t.mesh.points;
    sum += (p[v[1]] - p[v[0]]).cross(p[v[2]] - p[v[0]]).z() / 2;
  }
  return sum;
}

void add_inner(PlanarOutline& outline, const std::vector<index_t>& vertices) {
  outline.inner.values.insert(outline.inner.values.end(), vertices.begin(), vertices.end());
  outline.inner.end_row();
}

template <class Error>
void check_refused(const PlanarOutline& outline, Entity entity, const std::vector<std::size_t>& indices) {
  try {
    triangulate_outline(outline);
    FAIL("not refused");
  } catch (const Error& e) {
    INFO(e.what());
    CHECK(e.entity() == entity);
    CHECK(e.indices() == indices);
  }
}

}  // namespace

TEST_CASE("outlines of random stars are filled by as many triangles as Euler says, with their area") {
  std::mt19937_64 engine(4);
  boost::random::uniform_real_distribution<double> radius(0.2, 1);
  for (int n = 3; n < 120; n += 3) {
    std::vector<Vector2> points = circle({0, 0}, 1, n);
    for (Vector2& p : points) p *= radius(engine);
    if (n % 2 == 0) std::reverse(points.begin(), points.end());  // clockwise loops are loops too
    const OutlineTriangulation t = triangulate_outline(one_loop(points));
    CHECK(t.mesh.triangles.size() == points.size() - 2);
    CHECK(area(t) == Approx(std::abs(polygon_area(points))));
    for (const auto& v : t.mesh.triangles)
      CHECK(projected_orientation(2, t.mesh.points[v[0]], t.mesh.points[v[1]], t.mesh.points[v[2]]) > 0);
  }
}

TEST_CASE("no vertex lies inside the circle of a triangle that can see it") {
  const OutlineTriangulation t = triangulate_outline(plate_with_holes());
  const Surface surface = t.surface();
  for (index_t h = 0; h < surface.adjacency.opposite.size(); ++h) {
    if (surface.features.is_feature[h]) continue;
    const auto at = [&](index_t v) { return surface.points[v]; };
    const Vector3 d = at(surface.adjacency.apex(surface.adjacency.opposite[h]));
    Eigen::Matrix3d m;
    int row = 0;
    for (const index_t v : surface.triangles()[h / 3]) {
      const Vector3 r = at(v) - d;
      m.row(row++) << r.x(), r.y(), r.squaredNorm();
    }
    CHECK(m.determinant() < 1e-7);
  }
}

TEST_CASE("holes, islands and parts beside each other") {
  PlanarOutline outline = one_loop(rectangle(4, 4));
  add_loop(outline, {{1, 1}, {3, 1}, {3, 3}, {1, 3}});
  add_loop(outline, {{1.5, 1.5}, {2.5, 1.5}, {2.5, 2.5}, {1.5, 2.5}});
  add_loop(outline, {{5, 0}, {6, 0}, {6, 1}});
  const OutlineTriangulation t = triangulate_outline(outline);
  CHECK(t.n_regions == 3);
  CHECK(area(t) == Approx(16 - 4 + 1 + 0.5));
}

TEST_CASE("inner polylines divide a domain, or end in it") {
  PlanarOutline outline = one_loop({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {0, 1}});
  outline.points.emplace_back(1.5, 0.5);
  add_inner(outline, {1, 4});
  add_inner(outline, {6, 4});
  const OutlineTriangulation t = triangulate_outline(outline);
  CHECK(t.n_regions == 2);
  CHECK(area(t) == Approx(2));
  const Surface surface = t.surface();
  CHECK(surface.features.n_patches == 2);
  CHECK(surface.features.curves.size() == 4 + 2 + 1 + 1);  // the sides at 1 and 4 are halved by the inner one

  PlanarOutline inclusion = one_loop(rectangle(3, 3));
  for (const Vector2& p : circle({1.5, 1.5}, 1, 12)) inclusion.points.push_back(p);
  add_inner(inclusion, {4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 4});
  const OutlineTriangulation both = triangulate_outline(inclusion);
  CHECK(both.n_regions == 2);
  CHECK(area(both) == Approx(9));
}

TEST_CASE("bad outlines are refused by what is wrong", "[regression]") {
  PlanarOutline open = one_loop(rectangle(1, 1));
  open.loops.values.pop_back();
  open.loops.offsets.back() = 4;
  check_refused<invalid_outline>(open, Entity::polyline, {0, 0});

  check_refused<invalid_outline>(one_loop({{0, 0}, {1, 1}, {1, 0}, {0, 1}}), Entity::edge, {2, 3, 0, 1});

  PlanarOutline crossing = one_loop(rectangle(2, 2));
  add_loop(crossing, {{1, 1}, {3, 1}, {1.5, 1.5}});
  CHECK_THROWS_AS(triangulate_outline(crossing), invalid_outline);

  PlanarOutline touching = one_loop(rectangle(2, 2));
  add_loop(touching, {{1, 0}, {1.5, 1}, {0.5, 1}});
  check_refused<invalid_outline>(touching, Entity::vertex, {4, 0, 1});

  check_refused<invalid_outline>(one_loop({{0, 0}, {1, 0}, {1, 1}, {0, 0}, {0, 1}}), Entity::vertex, {0, 3});

  PlanarOutline outside = one_loop(rectangle(1, 1));
  outside.points.emplace_back(2, 2);
  outside.points.emplace_back(3, 2);
  add_inner(outside, {4, 5});
  check_refused<invalid_outline>(outside, Entity::polyline, {1});

  PlanarOutline lonely = one_loop(rectangle(1, 1));
  lonely.points.emplace_back(0.5, 0.5);
  check_refused<invalid_outline>(lonely, Entity::vertex, {4});

  PlanarOutline range = one_loop(rectangle(1, 1));
  range.loops.values[2] = 9;
  check_refused<invalid_connectivity>(range, Entity::polyline, {0});

  PlanarOutline infinite = one_loop(rectangle(1, 1));
  infinite.points[3].x() = std::numeric_limits<double>::infinity();
  check_refused<invalid_coordinate>(infinite, Entity::vertex, {3});

  CHECK_THROWS_AS(triangulate_outline({}), invalid_outline);
  CHECK_THROWS_AS(triangulate_outline(one_loop({{0, 0}, {1, 0}, {2, 0}})), invalid_outline);  // a line
}

TEST_CASE("vertices that are all but the same, and domains that are all but nothing, are refused by name") {
  for (const double distance : {1e-8, 1e-10, 1e-12, 1e-14}) {
    CAPTURE(distance);
    check_refused<invalid_outline>(one_loop({{0, 0}, {1, 0}, {1 + distance, 0}, {1, 1}, {0, 1}}), Entity::vertex,
                                   {1, 2});
    PlanarOutline hole = one_loop(rectangle(2, 2));
    add_loop(hole, {{1, distance}, {1.5, 1}, {0.5, 1}});
    check_refused<invalid_outline>(hole, Entity::vertex, {4, 0, 1});
    check_refused<invalid_outline>(one_loop({{0, 0}, {2, 0}, {2, distance}}), Entity::vertex, {1, 2});
    check_refused<invalid_outline>(one_loop({{0, 0}, {1, 0}, {2, 0}, {1, distance}}), Entity::vertex, {1, 3});
  }
  // The text names where to look.
  PlanarOutline hole = one_loop(rectangle(2, 2));
  add_loop(hole, {{1, 1e-9}, {1.5, 1}, {0.5, 1}});
  CHECK_THROWS_WITH(triangulate_outline(hole), Catch::Contains("vertex 4 of loop 1") &&
                                                   Catch::Contains("segment (0, 1) of loop 0") &&
                                                   Catch::Contains("1e-09"));
  // Nearly straight is not thin, nor is what lies between parts of the domain but touches none.
  for (const double bend : {1e-3, 1e-9, 1e-13}) {
    CAPTURE(bend);
    CHECK(area(triangulate_outline(one_loop({{0, 0}, {1, bend}, {2, 0}, {2, 1}, {0, 1}}))) == Approx(2).epsilon(2e-3));
    CHECK(area(triangulate_outline(one_loop({{0, 0}, {1, -bend}, {2, 0}, {2, 1}, {0, 1}}))) == Approx(2).epsilon(2e-3));
  }
  CHECK(triangulate_outline(one_loop(circle({0, 0}, 1, 50'000))).mesh.triangles.size() == 49'998);
}
