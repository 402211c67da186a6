// SPDX-License-Identifier: BSL-1.0
#include <catch2/catch.hpp>
#include <random>

#include "framehex/surface/self_intersection.hpp"
#include "support/surfaces.hpp"

using namespace framehex;

namespace {

/// Smallest distance of two triangles, by alternating sampling; zero when they cross. Slow and independent.
bool cross_by_clipping(const std::array<Vector3, 3>& s, const std::array<Vector3, 3>& t) {
  const auto pierces = [](const Vector3& p, const Vector3& q, const std::array<Vector3, 3>& f) {
    Eigen::Matrix3d m;
    m << q - p, f[0] - f[1], f[0] - f[2];
    const Vector3 x = m.fullPivLu().solve(f[0] - p);
    return x[0] >= 0 && x[0] <= 1 && x[1] >= 0 && x[2] >= 0 && x[1] + x[2] <= 1;
  };
  for (std::size_t i = 0; i < 3; ++i)
    if (pierces(s[i], s[(i + 1) % 3], t) || pierces(t[i], t[(i + 1) % 3], s)) return true;
  return false;
}

IndexedTriangleMesh together(const IndexedTriangleMesh& a, const IndexedTriangleMesh& b, const Vector3& shift) {
  IndexedTriangleMesh mesh = a;
  const auto n = static_cast<index_t>(a.points.size());
  for (const Vector3& p : b.points) mesh.points.push_back(p + shift);
  for (const auto& t : b.triangles) mesh.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  return mesh;
}

using Integers = Eigen::Matrix<std::int64_t, 3, 1>;

/// Separating axes, in integers: the normals of all that can be a facet of the difference of two triangles, in space or
/// in one plane.
bool meet_on_lattice(const std::array<Integers, 3>& s, const std::array<Integers, 3>& t) {
  const auto separates = [&](const Integers& axis) {
    const auto [low_s, high_s] = std::minmax({axis.dot(s[0]), axis.dot(s[1]), axis.dot(s[2])});
    const auto [low_t, high_t] = std::minmax({axis.dot(t[0]), axis.dot(t[1]), axis.dot(t[2])});
    return high_s < low_t || high_t < low_s;
  };
  const Integers m = (s[1] - s[0]).cross(s[2] - s[0]), n = (t[1] - t[0]).cross(t[2] - t[0]);
  if (separates(m) || separates(n)) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const Integers e = s[(i + 1) % 3] - s[i], f = t[(i + 1) % 3] - t[i];
    if (separates(m.cross(e)) || separates(n.cross(f))) return false;
    for (std::size_t j = 0; j < 3; ++j)
      if (separates(e.cross(t[(j + 1) % 3] - t[j]))) return false;
  }
  return true;
}

std::size_t n_crossings(std::vector<Vector3> points, const std::array<index_t, 3>& s, const std::array<index_t, 3>& t) {
  IndexedTriangleMesh mesh;
  mesh.points = std::move(points);
  mesh.triangles = {s, t};
  return find_self_intersections(mesh).size();
}

}  // namespace

TEST_CASE("triangles on a small lattice meet exactly when no axis separates them") {
  std::mt19937_64 engine(5);
  std::array<std::array<int, 2>, 2> met{};
  for (int sample = 0; sample < 20000; ++sample) {
    // Every second pair lies in an oblique plane.
    const bool flat = sample % 2 == 1;
    std::array<std::array<Integers, 3>, 2> t;
    std::vector<Vector3> points;
    for (auto& triangle : t)
      for (Integers& p : triangle) {
        for (std::int64_t& x : p) x = static_cast<std::int64_t>(engine() % 6);
        if (flat) p[2] = p[0] + 2 * p[1];
        points.push_back(p.cast<double>() / 64);
      }
    const auto is_null = [](const std::array<Integers, 3>& p) { return (p[1] - p[0]).cross(p[2] - p[0]).isZero(); };
    if (is_null(t[0]) || is_null(t[1])) continue;
    const bool expected = meet_on_lattice(t[0], t[1]);
    ++met[flat][expected];
    if ((n_crossings(points, {0, 1, 2}, {3, 4, 5}) == 1) != expected) FAIL_CHECK("pair " << sample);
  }
  for (const auto& kind : met)
    for (const int n : kind) CHECK(n > 1000);
}

TEST_CASE("a triangle whose rounded normal is null is decided all the same", "[regression]") {
  const double e = 0x1p-52;
  const Vector3 a(0, 0, 0), b(1 + e, 1, 0), c(1, 1 - e, 0);
  CHECK(n_crossings({a, b, c, {.4, .6, 0}, {.4, .7, 0}, {.3, .7, 0}}, {0, 1, 2}, {3, 4, 5}) == 0);
  CHECK(n_crossings({a, b, c, {.4, .3, 0}, {.4, .7, 0}, {.3, .7, 0}}, {0, 1, 2}, {3, 4, 5}) == 1);
  // Folded on it and beside it.
  CHECK(n_crossings({a, b, c, {1, 0, 0}}, {0, 1, 2}, {1, 0, 3}) == 1);
  CHECK(n_crossings({a, b, c, {0, 1, 0}}, {0, 1, 2}, {1, 0, 3}) == 0);
}

TEST_CASE("triangles of no area count by the segments that they are", "[regression]") {
  const Vector3 a(0, 0, 0), b(2, 2, 2), middle(1, 1, 1);
  // Through a proper triangle, past it, and touching its corner.
  CHECK(n_crossings({a, middle, b, {2, 1, 0}, {0, 1, 2}, {1, 0, 1}}, {0, 1, 2}, {3, 4, 5}) == 1);
  CHECK(n_crossings({a, middle, b, {4, 3, 2}, {2, 3, 4}, {3, 2, 2}}, {0, 1, 2}, {3, 4, 5}) == 0);
  CHECK(n_crossings({a, middle, b, {2, 2, 2}, {3, 2, 2}, {2, 3, 2}}, {0, 1, 2}, {3, 4, 5}) == 1);
  // Two segments on one line, and on two lines that cross.
  CHECK(n_crossings({a, middle, b, {3, 3, 3}, {4, 4, 4}, {5, 5, 5}}, {0, 1, 2}, {3, 4, 5}) == 0);
  CHECK(n_crossings({a, middle, b, {2, 2, 2}, {4, 4, 4}, {5, 5, 5}}, {0, 1, 2}, {3, 4, 5}) == 1);
  CHECK(n_crossings({a, middle, b, {1, 1, 0}, {1, 1, 1}, {1, 1, 2}}, {0, 1, 2}, {3, 4, 5}) == 1);
  // A needle, as meshes have them: beside its neighbours it does not count, at a common corner or a common edge.
  CHECK(n_crossings({a, middle, b, {1, 0, 0}, {1, 0, 1}}, {0, 1, 2}, {1, 3, 4}) == 0);
  CHECK(n_crossings({a, middle, b, {1, 0, 0}}, {0, 1, 2}, {0, 2, 3}) == 0);
  CHECK(n_crossings({a, middle, b, {1, 0, 0}}, {0, 1, 2}, {0, 1, 3}) == 0);
}

TEST_CASE("random triangles cross exactly when a linear solver says so") {
  std::mt19937_64 engine(3);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  IndexedTriangleMesh mesh;
  for (index_t t = 0; t < 120; ++t) {
    const Vector3 centre(uniform(), uniform(), uniform());
    for (int i = 0; i < 3; ++i) mesh.points.push_back(centre + 0.5 * Vector3(uniform(), uniform(), uniform()));
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  std::vector<std::array<index_t, 2>> expected;
  for (index_t s = 0; s < 120; ++s)
    for (index_t t = s + 1; t < 120; ++t)
      if (cross_by_clipping({mesh.points[3 * s], mesh.points[3 * s + 1], mesh.points[3 * s + 2]},
                            {mesh.points[3 * t], mesh.points[3 * t + 1], mesh.points[3 * t + 2]}))
        expected.push_back({s, t});
  CHECK(expected.size() > 50);
  CHECK(find_self_intersections(mesh) == expected);
  CHECK(find_self_intersections(mesh, 3).size() == 3);
}

TEST_CASE("proper surfaces do not cross themselves, flat faces included") {
  CHECK(find_self_intersections(test::box_surface({1, 1, 1})).empty());
  CHECK(find_self_intersections(test::box_surface({1, 2, 3}, 5, 6, 7)).empty());
  CHECK(find_self_intersections(test::cylinder_surface(1, 1, 50)).empty());
  CHECK(find_self_intersections(test::l_shape_surface()).empty());
  CHECK(find_self_intersections(test::torus_surface(1, 0.4, 30, 20)).empty());
  CHECK(find_self_intersections(test::torus_surface(1, 0.995, 30, 20)).empty());
}

TEST_CASE("surfaces that overlap, touch or fold are found") {
  const auto box = test::box_surface({1, 1, 1});
  CHECK_FALSE(find_self_intersections(together(box, box, {0.5, 0.25, 0.3})).empty());
  CHECK_FALSE(find_self_intersections(together(box, box, {1, 0, 0})).empty());    // face on face
  CHECK_FALSE(find_self_intersections(together(box, box, {1, 0.3, 0})).empty());  // part of a face
  CHECK_FALSE(find_self_intersections(together(box, box, {1, 1, 1})).empty());    // corner at corner
  CHECK(find_self_intersections(together(box, box, {std::nextafter(1.0, 2.0), 0, 0})).empty());
  CHECK_FALSE(find_self_intersections(test::torus_surface(1, 1.1, 30, 20)).empty());

  IndexedTriangleMesh fold;
  fold.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.5, 0}, {0.2, -0.5, 0}};
  fold.triangles = {{0, 1, 2}, {1, 0, 3}};
  CHECK(find_self_intersections(fold).size() == 1);
  fold.triangles = {{0, 1, 2}, {1, 0, 4}};
  CHECK(find_self_intersections(fold).empty());
  fold.triangles = {{0, 1, 2}, {2, 1, 0}};
  CHECK(find_self_intersections(fold).size() == 1);
}
