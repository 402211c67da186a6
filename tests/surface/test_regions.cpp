// SPDX-License-Identifier: BSL-1.0
#include <catch2/catch.hpp>

#include "framehex/mesh/validation.hpp"
#include "framehex/surface/refinement.hpp"
#include "framehex/surface/regions.hpp"
#include "framehex/surface/retriangulation.hpp"
#include "framehex/surface/self_intersection.hpp"
#include "support/complexes.hpp"
#include "support/surface_samples.hpp"

using namespace framehex;

namespace {

std::vector<double> volumes(const Surface& surface) {
  const SurfaceRegions regions = find_regions(surface);
  std::vector<double> result;
  for (index_t r = 0; r < regions.n_regions; ++r) {
    const RegionSurface part = region_surface(surface, regions, r);
    result.push_back(enclosed_volume(part.surface));
  }
  return result;
}

std::size_t n_interfaces(const Surface& surface) {
  const SurfaceRegions regions = find_regions(surface);
  std::size_t n = 0;
  for (index_t p = 0; p < regions.sides.size(); ++p) n += regions.is_interface(p);
  return n;
}

/// The complex with the normals of its interfaces turned, of some or of all.
IndexedTriangleMesh with_turned_walls(const IndexedTriangleMesh& mesh, int which) {
  const Surface surface(mesh);
  const SurfaceRegions regions = find_regions(surface);
  IndexedTriangleMesh turned = mesh;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const index_t patch = surface.features.triangle_patch[t];
    if (regions.is_interface(patch) && (which < 0 || static_cast<int>(t) % 2 == which))
      std::swap(turned.triangles[t][1], turned.triangles[t][2]);
  }
  return turned;
}

}  // namespace

TEST_CASE("the regions of a complex have the volumes of their bodies, whichever way their walls look") {
  const double ball = enclosed_volume(test::sphere_surface(1, 3)),
               middle = enclosed_volume(test::sphere_surface(0.7, 3)),
               inner = enclosed_volume(test::sphere_surface(0.4, 2));
  for (const int which : {-2, -1, 0, 1}) {
    const auto turned = [&](const IndexedTriangleMesh& mesh) {
      return which == -2 ? mesh : with_turned_walls(mesh, which);
    };
    const std::vector<double> box = volumes(turned(test::two_material_box()));
    REQUIRE(box.size() == 2);
    CHECK(box[0] == Approx(1));
    CHECK(box[1] == Approx(1));
    const std::vector<double> sunk = volumes(turned(test::ball_half_in_box()));
    REQUIRE(sunk.size() == 2);
    CHECK(sunk[0] + sunk[1] / 2 == Approx(4));
  }
  const std::vector<double> shells = volumes(test::nested_shells());
  REQUIRE(shells.size() == 3);
  CHECK(shells[0] + shells[1] + shells[2] == Approx(ball));
  CHECK(shells[1] + shells[2] == Approx(middle));
  CHECK(shells[2] == Approx(inner));
}

TEST_CASE("cavities are empty, bodies in them are not, and bodies may stand beside each other") {
  IndexedTriangleMesh mesh = test::sphere_surface(1, 2);
  IndexedTriangleMesh cavity = test::sphere_surface(0.7, 2);
  for (auto& t : cavity.triangles) std::swap(t[1], t[2]);
  test::append(mesh, cavity);
  CHECK(volumes(mesh).size() == 1);
  test::append(mesh, test::sphere_surface(0.3, 1));
  REQUIRE(volumes(mesh).size() == 2);
  CHECK(volumes(mesh)[1] == Approx(enclosed_volume(test::sphere_surface(0.3, 1))));
  IndexedTriangleMesh other = test::box_surface({1, 1, 1});
  for (Vector3& p : other.points) p += Vector3(5, 0, 0);
  test::append(mesh, other);
  CHECK(volumes(mesh).size() == 3);
  CHECK(n_interfaces(mesh) == 0);

  // Two boxes that have an edge in common.
  IndexedTriangleMesh pair = test::box_surface({1, 1, 1});
  const auto n = static_cast<index_t>(pair.points.size());
  std::vector<index_t> number;
  for (const Vector3& p : test::box_surface({1, 1, 1}).points) {
    const Vector3 q = p + Vector3(1, 1, 0);
    const auto at = std::find(pair.points.begin(), pair.points.begin() + n, q);
    number.push_back(static_cast<index_t>(at - pair.points.begin()));
    if (at == pair.points.begin() + n) {
      number.back() = static_cast<index_t>(pair.points.size());
      pair.points.push_back(q);
    }
  }
  for (const auto& t : test::box_surface({1, 1, 1}).triangles)
    pair.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  CHECK(pair.points.size() == 14);
  CHECK(volumes(pair) == std::vector<double>{1, 1});
}

TEST_CASE("surfaces that bound nothing are refused with the triangle or edge") {
  auto box = test::two_material_box();
  box.triangles.pop_back();
  CHECK_THROWS_AS(find_regions(box), open_surface);
  box = test::two_material_box();
  for (auto& t : box.triangles) std::swap(t[1], t[2]);
  CHECK_THROWS_AS(find_regions(box), invalid_surface);
  box = test::two_material_box();
  std::swap(box.triangles[5][1], box.triangles[5][2]);
  try {
    find_regions(box);
    FAIL("a triangle that looks into the material was accepted");
  } catch (const invalid_surface& e) {
    CHECK(e.entity() == Entity::triangle);
    CHECK(e.indices() == std::vector<std::size_t>{5});
  }
}

TEST_CASE("a complex keeps its regions and its interfaces, refined and triangulated anew") {
  struct Case {
    IndexedTriangleMesh mesh;
    double h;
    double tolerance;  // of the volumes: chords cut off about half of (h / radius)^2
    std::size_t n_curves;
  };
  for (const Case& c : {Case{test::two_material_box(), 0.2, 1e-9, 20}, Case{test::nested_shells(), 0.12, 0.06, 0},
                        Case{test::ball_half_in_box(), 0.2, 0.1, 13}}) {
    const Surface surface(c.mesh);
    CHECK(surface.features.curves.size() == c.n_curves);
    const std::vector<double> wanted = volumes(surface);
    for (const bool refined : {false, true}) {
      const Surface fine = refined ? refine(surface, [&](const Vector3&) { return 0.6 * c.h; }).surface : surface;
      const std::vector<double> same = volumes(fine);
      REQUIRE(same.size() == wanted.size());
      for (std::size_t r = 0; r < wanted.size(); ++r) CHECK(same[r] == Approx(wanted[r]));
      CHECK(n_interfaces(fine) == n_interfaces(surface));

      const auto samples = test::scatter_samples(fine, c.h);
      const Retriangulation r = retriangulate(fine, samples);
      CHECK(r.n_unremoved == 0);
      CHECK(r.crossings.empty());
      CHECK(find_self_intersections(r.surface).empty());
      REQUIRE(r.surface.points.size() == samples.size() + r.n_unremoved + r.n_added);
      for (std::size_t i = 0; i < samples.size(); ++i) CHECK(r.surface.points[i] == samples[i].point);
      const std::vector<double> again = volumes(r.surface);
      REQUIRE(again.size() == wanted.size());
      for (std::size_t i = 0; i < wanted.size(); ++i) CHECK(again[i] == Approx(wanted[i]).epsilon(c.tolerance));
      CHECK(n_interfaces(r.surface) == n_interfaces(surface));
      const SurfaceRegions regions = find_regions(r.surface);
      for (index_t i = 0; i < regions.n_regions; ++i)
        CHECK_NOTHROW(validate_closed(region_surface(r.surface, regions, i).surface));
    }
  }
}
