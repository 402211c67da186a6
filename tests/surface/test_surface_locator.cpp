// SPDX-License-Identifier: BSL-1.0
#include "framehex/surface/surface_locator.hpp"

#include <catch2/catch.hpp>
#include <random>

#include "framehex/geometry/spatial_index.hpp"
#include "support/surfaces.hpp"

using namespace framehex;

namespace {

double uniform(std::mt19937_64& engine) {
  return static_cast<double>(engine() >> 11) * 0x1p-53;
}

Vector3 random_point(std::mt19937_64& engine) {
  const double x = uniform(engine), y = uniform(engine), z = uniform(engine);
  return {x, y, z};
}

}  // namespace

TEST_CASE("the nearest point of a triangle is no farther than any point of a fine sampling of it") {
  std::mt19937_64 engine(7);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector3 a = random_point(engine), c = random_point(engine), p = 2 * random_point(engine);
    Vector3 b = random_point(engine);
    if (trial % 4 == 0) b = a + (c - a) * uniform(engine);                // no area
    if (trial % 4 == 1) b = a + (c - a) * 0.3 + 1e-9 * Vector3::UnitX();  // a needle
    if (trial % 50 == 0) b = a;
    const TrianglePoint nearest = nearest_on_triangle(p, a, b, c);
    CHECK(nearest.barycentric.minCoeff() >= 0);
    CHECK(nearest.barycentric.sum() == Approx(1));
    CHECK(
        (nearest.barycentric[0] * a + nearest.barycentric[1] * b + nearest.barycentric[2] * c - nearest.point).norm() <
        1e-12);
    CHECK((nearest.point - p).squaredNorm() == Approx(nearest.squared_distance).margin(1e-14));
    double sampled = 1e300;
    for (int i = 0; i <= 20; ++i)
      for (int j = 0; i + j <= 20; ++j)
        sampled = std::min(sampled, (a + (b - a) * i / 20 + (c - a) * j / 20 - p).norm());
    const double distance = std::sqrt(nearest.squared_distance);
    CHECK(distance <= sampled + 1e-12);
    CHECK(distance >= sampled - 0.05 * std::max((b - a).norm(), (c - a).norm()));
  }
}

TEST_CASE("the locator's nearest point is the nearest of all triangles'") {
  const IndexedTriangleMesh surface = test::torus_surface(0.4, 0.15, 40, 20);
  const SurfaceLocator locator(surface);
  std::mt19937_64 engine(11);
  for (int trial = 0; trial < 500; ++trial) {
    Vector3 p = 2 * random_point(engine) - Vector3::Ones();
    if (trial % 10 == 0) p = surface.points[engine() % surface.points.size()];
    double best = 1e300;
    index_t triangle = no_index;
    for (index_t t = 0; t < surface.triangles.size(); ++t) {
      const auto& v = surface.triangles[t];
      const double d =
          nearest_on_triangle(p, surface.points[v[0]], surface.points[v[1]], surface.points[v[2]]).squared_distance;
      if (d < best) {
        best = d;
        triangle = t;
      }
    }
    const SurfacePoint nearest = locator.nearest(p);
    CHECK(nearest.distance * nearest.distance == Approx(best).margin(1e-300));
    CHECK(nearest.triangle == triangle);
    const auto within = locator.nearest_within(p, 0.1);
    CHECK(within.has_value() == (std::sqrt(best) <= 0.1));
  }
}

TEST_CASE("inside agrees with the implicit equation away from the surface") {
  std::mt19937_64 engine(13);
  SECTION("torus") {
    const SurfaceLocator locator(test::torus_surface(0.4, 0.15, 60, 30));
    for (int trial = 0; trial < 3000; ++trial) {
      const Vector3 p = 1.4 * (random_point(engine) - Vector3::Constant(0.5));
      const double f = std::hypot(std::hypot(p.x(), p.y()) - 0.4, p.z()) - 0.15;
      if (std::abs(f) > 0.003) CHECK(locator.inside(p) == (f < 0));
    }
  }
  SECTION("box of 12 triangles, with many points on the planes, edges and diagonals of its faces") {
    const SurfaceLocator locator(test::box_surface({1, 1, 1}));
    for (int i = -2; i <= 10; ++i)
      for (int j = -2; j <= 10; ++j)
        for (int k = -2; k <= 10; ++k) {
          const bool inside = std::min({i, j, k}) > 0 && std::max({i, j, k}) < 8;
          CHECK(locator.inside(Vector3(i, j, k) / 8.0) == inside);
        }
  }
  SECTION("within rounding of a face") {
    const SurfaceLocator locator(test::box_surface({1, 1, 1}));
    CHECK(locator.inside({0.3, 0.4, std::nextafter(1.0, 0.0)}));
    CHECK_FALSE(locator.inside({0.3, 0.4, std::nextafter(1.0, 2.0)}));
    CHECK_FALSE(locator.inside({0.5, 0.5, 1.0}));
  }
  SECTION("L, whose lids are needles about its inner corner") {
    const SurfaceLocator locator(test::l_shape_surface());
    for (int trial = 0; trial < 3000; ++trial) {
      const Vector3 p = 2.2 * random_point(engine) - Vector3::Constant(0.1);
      const bool inside = p.minCoeff() > 0 && p.z() < 1 && p.x() < 2 && p.y() < 2 && (p.x() < 1 || p.y() < 1);
      CHECK(locator.inside(p) == inside);
    }
  }
}

TEST_CASE("box queries find the triangles that brute force finds") {
  const IndexedTriangleMesh surface = test::sphere_surface(1, 3);
  const SurfaceLocator locator(surface);
  std::vector<Box> boxes;
  for (const auto& t : surface.triangles) {
    const Vector3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
    boxes.push_back({a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)});
  }
  const BoxIndex index(boxes);
  std::mt19937_64 engine(17);
  for (int trial = 0; trial < 100; ++trial) {
    const Vector3 low = 2 * random_point(engine) - Vector3::Ones(), high = low + random_point(engine);
    std::vector<index_t> expected, found, other;
    for (index_t i = 0; i < boxes.size(); ++i)
      if ((boxes[i].low.array() <= high.array()).all() && (low.array() <= boxes[i].high.array()).all())
        expected.push_back(i);
    locator.in_box(low, high, [&](index_t t) { found.push_back(t); });
    index.in_box(low, high, [&](index_t t) {
      other.push_back(t);
      return true;
    });
    std::sort(found.begin(), found.end());
    std::sort(other.begin(), other.end());
    CHECK(found == expected);
    CHECK(other == expected);

    std::vector<std::pair<double, index_t>> by_distance, visited;
    for (index_t i = 0; i < boxes.size(); ++i) {
      const Vector3 gap = (boxes[i].low - low).cwiseMax(low - boxes[i].high).cwiseMax(0);
      by_distance.emplace_back(gap.squaredNorm(), i);
    }
    std::sort(by_distance.begin(), by_distance.end());
    index.by_distance(low, [&](index_t i, double squared) {
      visited.emplace_back(squared, i);
      return visited.size() < 200;
    });
    REQUIRE(visited.size() == 200);
    for (std::size_t i = 0; i < 200; ++i) CHECK(visited[i].first == Approx(by_distance[i].first).margin(1e-12));
  }
}

TEST_CASE("the point index finds what brute force finds") {
  std::mt19937_64 engine(19);
  std::vector<Vector3> points;
  PointIndex grown;
  for (index_t i = 0; i < 500; ++i) {
    points.push_back(random_point(engine));
    if (i % 5 == 4) points.back() = points[i - 1];
    grown.insert(points.back(), i);
  }
  const PointIndex packed(points);
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3 q = random_point(engine);
    index_t nearest = 0;
    for (index_t i = 1; i < points.size(); ++i)
      if ((points[i] - q).squaredNorm() < (points[nearest] - q).squaredNorm()) nearest = i;
    CHECK(grown.nearest(q) == nearest);
    CHECK(packed.nearest(q) == nearest);
    std::size_t expected = 0, found = 0;
    const Vector3 half = Vector3::Constant(0.1);
    for (const Vector3& p : points) expected += ((p - q).cwiseAbs().maxCoeff() <= 0.1);
    grown.in_box(q - half, q + half, [&](index_t, const Vector3&) { return ++found, true; });
    CHECK(found == expected);
  }
  CHECK(PointIndex().nearest({0, 0, 0}) == no_index);
}
