// SPDX-License-Identifier: BSL-1.0
#include "framehex/io/soup_repair.hpp"
#include "framehex/io/surface_faults.hpp"
#include "support/surfaces.hpp"

#include <catch2/catch.hpp>
#include <random>

using namespace framehex;
using Catch::Matchers::Contains;

namespace {

/// Triangles numbered in a file from 100 on, which share no vertices.
SurfaceSoup soup_of(const IndexedTriangleMesh& mesh) {
  SurfaceSoup soup;
  for (index_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto first = static_cast<index_t>(soup.mesh.points.size());
    for (const index_t v : mesh.triangles[t]) soup.mesh.points.push_back(mesh.points[v]);
    soup.mesh.triangles.push_back({first, first + 1, first + 2});
    soup.polygons.push_back(100 + t);
    soup.patches.push_back(t % 2);
  }
  soup.patch_names = {"even", "odd"};
  return soup;
}

IndexedTriangleMesh joined(IndexedTriangleMesh a, const IndexedTriangleMesh& b, const Vector3& by) {
  const auto first = static_cast<index_t>(a.points.size());
  for (const Vector3& p : b.points) a.points.push_back(p + by);
  for (const auto& t : b.triangles) a.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return a;
}

double enclosed_volume(const IndexedTriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) sum += mesh.points[t[0]].dot(mesh.points[t[1]].cross(mesh.points[t[2]]));
  return sum / 6;
}

template <class Error>
std::string message_of(const IndexedTriangleMesh& mesh) {
  try {
    const SoupSurface soup = surface_of_soup(soup_of(mesh));
    check_closed(soup);
    check_crossings(soup);
  } catch (const Error& e) {
    return e.what();
  }
  return "no such error";
}

}  // namespace

TEST_CASE("faults of a surface are told by the file's polygons and coordinates, five of them and their number") {
  const IndexedTriangleMesh box = test::box_surface({1, 1, 1}, 3, 3, 3);
  CHECK_NOTHROW(check_closed(surface_of_soup(soup_of(box))));
  CHECK_NOTHROW(check_crossings(surface_of_soup(soup_of(box))));

  IndexedTriangleMesh open = box;
  open.triangles.erase(open.triangles.begin() + 7);
  const std::string one_hole = message_of<open_surface>(open);
  CHECK_THAT(one_hole, Contains("open along 3 edges: polygon 1"));
  const auto& t = box.triangles[7];
  for (std::size_t i = 0; i < 3; ++i) CHECK_THAT(one_hole, Contains(detail::FaultReport::place(box.points[t[i]])));
  open.triangles.resize(30);
  const std::string many = message_of<open_surface>(open);
  CHECK(std::count(many.begin(), many.end(), ';') == 5);
  CHECK_THAT(many, Contains("; and ") && Contains(" more"));

  IndexedTriangleMesh twice = box;
  twice.triangles.push_back(box.triangles[4]);
  CHECK_THAT(message_of<nonmanifold>(twice), Contains("a triangle stands twice: polygon 208 is polygon 104 again"));
  twice.triangles.insert(twice.triangles.end(), box.triangles.begin(), box.triangles.begin() + 9);
  CHECK_THAT(message_of<nonmanifold>(twice), Contains("10 triangles stand more than once") && Contains("and 5 more"));

  const IndexedTriangleMesh unit = test::box_surface({1, 1, 1});
  CHECK_THAT(message_of<nonmanifold>(joined(unit, unit, {1, 1, 0})),
             Contains("an edge has more than two triangles") && Contains("from (1, 1, "));
  CHECK_THAT(message_of<nonmanifold>(joined(unit, unit, {1, 1, 1})),
             Contains("itself at a vertex") && Contains("(1, 1, 1)"));
  CHECK_THAT(message_of<invalid_surface>(joined(unit, unit, {0.5, 0.4, 0.3})),
             Contains("overlapping or touching bodies"));
  IndexedTriangleMesh crossing = test::box_surface({1, 1, 1}, 2, 2, 2);
  for (Vector3& p : crossing.points)
    if (p.isApprox(Vector3(0.5, 0.5, 1))) p.z() = -0.5;  // through the floor
  CHECK_THAT(message_of<invalid_surface>(crossing), Contains("the surface crosses or touches itself"));
}

TEST_CASE("repair closes what noise, repetition and vertices on edges opened, and keeps volume, patches and numbers") {
  std::mt19937_64 random(17);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (int round = 0; round < 60; ++round) {
    INFO(round);
    const IndexedTriangleMesh body =
        round % 2 == 0 ? test::box_surface({1, 2, 3}, 2, 3, 2) : test::sphere_surface(1, 1);
    const double volume = enclosed_volume(body), diagonal = round % 2 == 0 ? std::sqrt(14.0) : std::sqrt(12.0);
    SurfaceSoup soup = soup_of(body);
    REQUIRE(detail::EdgeUses(surface_of_soup(soup).surface).closed());

    // Some triangles are cut at a point of one edge, more than once, and their neighbours not told.
    std::size_t n_cuts = round % 3 == 0 ? 0 : 1 + random() % 6;
    for (std::size_t k = 0; k < n_cuts; ++k) {
      const std::size_t t = random() % soup.mesh.triangles.size(), i = random() % 3;
      const auto [a, b, c] = std::tuple(soup.mesh.triangles[t][i], soup.mesh.triangles[t][(i + 1) % 3],
                                        soup.mesh.triangles[t][(i + 2) % 3]);
      const auto v = static_cast<index_t>(soup.mesh.points.size());
      const double at = 0.2 + 0.6 * unit();
      soup.mesh.points.push_back((1 - at) * soup.mesh.points[a] + at * soup.mesh.points[b]);
      soup.mesh.triangles[t] = {a, v, c};
      soup.mesh.triangles.push_back({v, b, c});
      soup.polygons.push_back(soup.polygons[t]);
      soup.patches.push_back(soup.patches[t]);
    }
    const std::size_t n_repeated = round % 5 == 0 ? 0 : random() % 4;
    for (std::size_t k = 0; k < n_repeated; ++k) {
      const std::size_t t = random() % soup.mesh.triangles.size();
      soup.mesh.triangles.push_back(soup.mesh.triangles[t]);
      soup.polygons.push_back(900);
      soup.patches.push_back(soup.patches[t]);
    }
    const double noise = round % 4 == 0 ? 0 : std::pow(10, -5 - 3 * unit()) * diagonal;
    if (noise > 0) {  // every triangle gets vertices of its own
      const IndexedTriangleMesh shared = std::exchange(soup.mesh, {});
      for (const auto& t : shared.triangles) {
        const auto first = static_cast<index_t>(soup.mesh.points.size());
        soup.mesh.triangles.push_back({first, first + 1, first + 2});
        for (const index_t v : t)
          soup.mesh.points.push_back(shared.points[v] + noise * Vector3(unit() - 0.5, unit() - 0.5, unit() - 0.5));
      }
    }
    const SoupRepair repair = repair_soup(soup);
    REQUIRE(repair.closed);
    CHECK(repair.weld_tolerance <= 100 * noise);
    CHECK(repair.n_repeated == n_repeated);
    CHECK(soup.polygons.size() == soup.mesh.triangles.size());
    const SoupSurface repaired = surface_of_soup(soup);
    CHECK_NOTHROW(check_closed(repaired));
    CHECK(enclosed_volume(repaired.surface) == Approx(volume).epsilon(1e-3));
    for (std::size_t t = 0; t < repaired.polygons.size(); ++t)
      if (repaired.polygons[t] != 900) CHECK(repaired.patches[t] == (repaired.polygons[t] - 100) % 2);
  }
}

TEST_CASE("repair leaves alone what is closed, and says where it cannot close") {
  const IndexedTriangleMesh box = test::box_surface({1, 1, 1e-8});
  SurfaceSoup thin = soup_of(box);
  const SoupRepair nothing = repair_soup(thin);
  CHECK((nothing.closed && nothing.weld_tolerance == 0 && nothing.n_repeated == 0 && nothing.n_split == 0));
  CHECK(surface_of_soup(thin).surface.points.size() == 8);
  IndexedTriangleMesh open = test::box_surface({1, 1, 1});
  open.triangles.pop_back();
  SurfaceSoup hole = soup_of(open);
  CHECK(!repair_soup(hole).closed);
  // A wall between two bodies that stand face to face goes: they become one.
  const IndexedTriangleMesh unit = test::box_surface({1, 1, 1});
  IndexedTriangleMesh mirrored = unit;
  for (Vector3& p : mirrored.points) p.x() = -p.x();
  SurfaceSoup walls = soup_of(joined(unit, mirrored, {0, 0, 0}));
  CHECK(repair_soup(walls).n_repeated == 4);
  CHECK(std::abs(enclosed_volume(surface_of_soup(walls).surface)) == Approx(2));
  // Or it stays, once.
  walls = soup_of(joined(unit, mirrored, {0, 0, 0}));
  const SoupRepair divided = repair_soup(walls, 1e-4, TouchingFaces::divided);
  CHECK((divided.closed && divided.n_repeated == 2 && divided.weld_tolerance == 0));
  CHECK_NOTHROW(check_complex(surface_of_soup(walls)));
}
