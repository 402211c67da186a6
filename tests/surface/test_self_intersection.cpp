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

}  // namespace

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
