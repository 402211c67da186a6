// SPDX-License-Identifier: BSL-1.0
#include "framehex/quads/detail/edge_halving.hpp"
#include "framehex/quads/detail/thin_strips.hpp"

#include "support/flat_delaunay.hpp"
#include "support/surfaces.hpp"

#include <catch2/catch.hpp>

#include <set>

using namespace framehex;
using namespace framehex::test;

namespace {

std::vector<double> patch_areas(const Surface& surface) {
  std::vector<double> areas(surface.features.n_patches, 0);
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
    const auto& v = surface.triangles()[t];
    const Vector3 x = surface.points[v[1]] - surface.points[v[0]], y = surface.points[v[2]] - surface.points[v[0]];
    areas[surface.features.triangle_patch[t]] += x.cross(y).norm() / 2;
  }
  return areas;
}

double curve_length(const Surface& surface, index_t curve) {
  const auto row = surface.features.curves[curve];
  double length = 0;
  for (std::size_t i = 1; i < row.size(); ++i) length += (surface.points[row[i]] - surface.points[row[i - 1]]).norm();
  return length;
}

/// Do the flags of the triangles name the edges of the curves, and is every edge used by as many triangles as before?
void check_features(const Surface& surface) {
  std::set<std::pair<index_t, index_t>> edges;
  for (std::size_t c = 0; c < surface.features.curves.size(); ++c) {
    const auto row = surface.features.curves[c];
    for (std::size_t i = 1; i < row.size(); ++i) edges.insert(std::minmax(row[i - 1], row[i]));
  }
  std::set<std::pair<index_t, index_t>> flagged;
  REQUIRE(surface.features.is_feature.size() == 3 * surface.triangles().size());
  REQUIRE(surface.features.triangle_patch.size() == surface.triangles().size());
  for (index_t h = 0; h < surface.features.is_feature.size(); ++h) {
    const std::pair<index_t, index_t> edge = std::minmax(surface.adjacency.from(h), surface.adjacency.to(h));
    CHECK(bool(surface.features.is_feature[h]) == edges.contains(edge));
    if (surface.features.is_feature[h]) flagged.insert(edge);
    if (surface.adjacency.opposite[h] == no_index) CHECK(surface.features.is_feature[h]);
  }
  CHECK(flagged == edges);
}

/// Three squares that meet in an edge.
IndexedTriangleMesh three_sheets() {
  IndexedTriangleMesh mesh{{{0, 0, 0}, {0, 0, 1}}, {}};
  for (const double angle : {0.0, 2.0, 4.0}) {
    const Vector3 x(std::cos(angle), std::sin(angle), 0);
    const auto n = static_cast<index_t>(mesh.points.size());
    mesh.points.push_back(x);
    mesh.points.push_back(x + Vector3::UnitZ());
    mesh.triangles.push_back({0, n, n + 1});
    mesh.triangles.push_back({0, n + 1, 1});
  }
  return mesh;
}

}  // namespace

TEST_CASE("the longest edge of a curve is halved, and nothing else is changed") {
  std::mt19937_64 engine(3);
  for (const Surface& before : {Surface(box_surface({1, 2, 3}, 2, 3, 2)), Surface(three_sheets()),
                                Surface(flat_delaunay(random_flat_points(20, engine)))})
    for (index_t curve = 0; curve < before.features.curves.size(); ++curve) {
      double longest = 0;
      const auto row = before.features.curves[curve];
      for (std::size_t i = 1; i < row.size(); ++i)
        longest = std::max(longest, (before.points[row[i]] - before.points[row[i - 1]]).norm());
      Surface after = before;
      detail::halve_longest_edge(after, curve);
      REQUIRE(after.points.size() == before.points.size() + 1);
      check_features(after);
      CHECK(after.features.corners == before.features.corners);
      const auto middle = static_cast<index_t>(before.points.size());
      for (index_t c = 0; c < before.features.curves.size(); ++c) {
        const std::span<const index_t> old = before.features.curves[c], now = std::as_const(after).features.curves[c];
        CHECK(now.size() == old.size() + (c == curve ? 1 : 0));
        CHECK(curve_length(after, c) == Approx(curve_length(before, c)));
        const auto found = std::find(now.begin(), now.end(), middle);
        REQUIRE((found != now.end()) == (c == curve));
        if (c != curve) continue;
        for (const index_t end : {*(found - 1), *(found + 1)})
          CHECK((after.points[end] - after.points[middle]).norm() == Approx(longest / 2));
      }
      const std::vector<double> old = patch_areas(before), now = patch_areas(after);
      REQUIRE(now.size() == old.size());
      for (std::size_t p = 0; p < old.size(); ++p) CHECK(now[p] == Approx(old[p]));
    }
}

TEST_CASE("any edges may be halved at once: the triangles cover the patches as before") {
  std::mt19937_64 engine(4);
  for (int i = 0; i < 50; ++i) {
    const Surface before(flat_delaunay(random_flat_points(15, engine)));
    std::vector<detail::EdgeHalver::Edge> edges;
    std::set<std::pair<index_t, index_t>> different;
    for (index_t h = 0; h < before.adjacency.opposite.size(); ++h)
      if (engine() % 3 == 0) {
        edges.push_back({before.adjacency.from(h), before.adjacency.to(h)});
        different.insert(std::minmax(edges.back()[0], edges.back()[1]));
      }
    Surface after = before;
    detail::EdgeHalver(after).run(edges);
    CHECK(after.points.size() == before.points.size() + different.size());
    check_features(after);
    CHECK(patch_areas(after)[0] == Approx(patch_areas(before)[0]));
    for (const auto& t : after.triangles())  // none is turned over
      CHECK(projected_orientation(2, after.points[t[0]], after.points[t[1]], after.points[t[2]]) > 0);
  }
}

TEST_CASE("edges across a strip: all of a row of triangles, none beyond it") {
  // A strip of height 1 from x = 0 to 8, and a square with a point inside beyond it, joined by the edge at x = 8.
  IndexedTriangleMesh mesh;
  for (int x = 0; x <= 8; ++x)
    for (int y = 0; y <= 1; ++y) mesh.points.emplace_back(x, y, 0);
  for (index_t i = 0; i < 8; ++i) {
    const index_t a = 2 * i, b = a + 2, c = b + 1, d = a + 1;
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  for (const Vector3& p : {Vector3(11, -1, 0), Vector3(11, 2, 0), Vector3(10, 0.5, 0)}) mesh.points.push_back(p);
  mesh.triangles.insert(mesh.triangles.end(), {{16, 18, 20}, {18, 19, 20}, {19, 17, 20}, {17, 16, 20}});
  const Surface surface(mesh);
  const std::vector<Vector3> in_strip{{2.2, 0.3, 0}}, beyond{{10.5, 0.5, 0}};
  CHECK(detail::edges_across_strips(surface, in_strip).size() == 16);  // 8 diagonals, 8 rungs
  CHECK(detail::edges_across_strips(surface, beyond).empty());
}
