// SPDX-License-Identifier: BSL-1.0
#include <catch2/catch.hpp>

#include "framehex/mesh/validation.hpp"
#include "framehex/surface/refinement.hpp"
#include "support/stl.hpp"
#include "support/surface_checks.hpp"
#include "support/surfaces.hpp"

using namespace framehex;

namespace {

/// What every feature graph must satisfy, from its definition.
void check_consistent(const TriangleAdjacency& a, const FeatureGraph& graph) {
  REQUIRE(graph.is_feature.size() == a.opposite.size());
  REQUIRE(graph.triangle_patch.size() == a.triangles.size());
  std::size_t n_edges = 0, n_on_curves = 0;
  for (index_t h = 0; h < a.opposite.size(); ++h) {
    const index_t twin = a.opposite[h];
    if (twin == no_index) {
      CHECK(graph.is_feature[h]);
      ++n_edges;
      continue;
    }
    CHECK(graph.is_feature[h] == graph.is_feature[twin]);
    if (!graph.is_feature[h]) CHECK(graph.triangle_patch[h / 3] == graph.triangle_patch[twin / 3]);
    n_edges += h < twin && graph.is_feature[h];
  }
  for (std::size_t c = 0; c < graph.curves.size(); ++c) {
    const auto curve = graph.curves[c];
    REQUIRE(curve.size() >= 2);
    n_on_curves += curve.size() - 1;
    const auto is_corner = [&](index_t v) { return std::binary_search(graph.corners.begin(), graph.corners.end(), v); };
    CHECK((curve.front() == curve.back() || (is_corner(curve.front()) && is_corner(curve.back()))));
    for (std::size_t i = 1; i + 1 < curve.size(); ++i) CHECK_FALSE(is_corner(curve[i]));
    for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
      bool found = false;
      for (const index_t t : a.triangles_of_vertex[curve[i]])
        for (index_t h = 3 * t; h < 3 * t + 3; ++h)
          if (std::minmax(a.from(h), a.to(h)) == std::minmax(curve[i], curve[i + 1])) found = graph.is_feature[h];
      CHECK(found);
    }
  }
  CHECK(n_edges == n_on_curves);
  for (const index_t patch : graph.triangle_patch) CHECK(patch < graph.n_patches);
}

const auto detect = [](const IndexedTriangleMesh& mesh, const FeatureOptions& options = {}) {
  return detect_features(mesh, options);
};

}  // namespace

TEST_CASE("a box has 8 corners, 12 curves and 6 patches") {
  for (const int n : {1, 3}) {
    const auto surface = test::box_surface({1, 2, 3}, n, n + 1, 2 * n);
    const FeatureGraph graph = detect(surface);
    check_consistent(make_adjacency(surface), graph);
    CHECK(graph.corners.size() == 8);
    CHECK(graph.curves.size() == 12);
    CHECK(graph.n_patches == 6);
  }
}

TEST_CASE("a cylinder has two closed curves and three patches") {
  const auto surface = test::cylinder_surface(0.5, 2, 40);
  const FeatureGraph graph = detect(surface);
  check_consistent(make_adjacency(surface), graph);
  CHECK(graph.corners.empty());
  REQUIRE(graph.curves.size() == 2);
  CHECK(graph.curves[0].size() == 41);
  CHECK(graph.curves[0].front() == graph.curves[0].back());
  CHECK(graph.n_patches == 3);
}

TEST_CASE("smooth surfaces and scans have no features") {
  CHECK(detect(test::sphere_surface(1, 3)).curves.size() == 0);
  CHECK(detect(test::torus_surface(1, 0.4, 30, 20)).curves.size() == 0);
  const auto bunny = test::read_stl(FRAMEHEX_TEST_DATA "/bunny.stl");
  const FeatureGraph graph = detect(bunny);
  check_consistent(make_adjacency(bunny), graph);
  CHECK(graph.curves.size() == 0);
  CHECK(graph.n_patches == 1);
}

TEST_CASE("given edges are kept, whatever their angle, their length and the noise about them") {
  const auto bunny = test::read_stl(FRAMEHEX_TEST_DATA "/bunny.stl");
  const auto& t = bunny.triangles[100];
  const FeatureGraph graph = detect(bunny, {.given_edges = {{t[1], t[0]}}});
  check_consistent(make_adjacency(bunny), graph);
  REQUIRE(graph.curves.size() == 1);
  CHECK(graph.corners.size() == 2);
  CHECK(graph.is_feature[300] == 1);

  const auto box = test::box_surface({1, 1, 1});
  const FeatureGraph split = detect(box, {.given_edges = {{box.triangles[0][0], box.triangles[0][1]},
                                                          {box.triangles[0][1], box.triangles[0][2]},
                                                          {box.triangles[0][2], box.triangles[0][0]}}});
  check_consistent(make_adjacency(box), split);
  CHECK(split.n_patches == 7);
  CHECK_THROWS_AS(detect(box, {.given_edges = {{0, 0}}}), invalid_option);
  CHECK_THROWS_AS(detect(box, {.given_edges = {{0, 99}}}), invalid_option);
  CHECK_THROWS_AS(detect(box, {.angle = 0}), invalid_option);
}

TEST_CASE("a planar domain's rim is its feature curve, with corners where it turns") {
  IndexedTriangleMesh square;
  square.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}};
  square.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  const FeatureGraph graph = detect(square);
  check_consistent(make_adjacency(square), graph);
  CHECK(graph.corners == std::vector<index_t>{0, 1, 2, 3});
  CHECK(graph.curves.size() == 4);
}

TEST_CASE("a triangle without area does not make a feature of a smooth edge") {
  // A square lid whose one side carries an extra vertex: the collapsed triangle lies in it.
  auto surface = test::box_surface({1, 1, 1});
  const FeatureGraph before = detect(surface);
  const TriangleAdjacency a = make_adjacency(surface);
  index_t h = 0;  // a diagonal
  while (before.is_feature[h]) ++h;
  const index_t v = static_cast<index_t>(surface.points.size());
  surface.points.push_back((surface.points[a.from(h)] + surface.points[a.to(h)]) / 2);
  const index_t t = h / 3, from = a.from(h), to = a.to(h), apex = a.apex(h);
  surface.triangles[t] = {from, v, apex};
  surface.triangles.push_back({v, to, apex});
  surface.triangles.push_back({from, to, v});  // flat
  validate_closed(surface);
  const FeatureGraph after = detect(surface);
  check_consistent(make_adjacency(surface), after);
  CHECK(after.curves.size() == 12);
  CHECK(after.n_patches == 6);
}

TEST_CASE("refining keeps the shape, the features and the parents") {
  struct Case {
    IndexedTriangleMesh surface;
    double length;
  };
  for (const auto flips : {RefinementFlips::none, RefinementFlips::in_planes})
    for (const Case& c : {Case{test::box_surface({1, 1, 1}), 0.11}, Case{test::cylinder_surface(0.5, 2, 24), 0.1},
                          Case{test::l_shape_surface(), 0.2}, Case{test::torus_surface(1, 0.4, 12, 8), 0.2}}) {
      const FeatureGraph features = detect(c.surface);
      const RefinedSurface fine = refine(c.surface, [&](const Vector3&) { return c.length; }, {.flips = flips});
      validate_closed(fine.surface);
      check_consistent(fine.surface.adjacency, fine.surface.features);
      CHECK(fine.surface.features.corners == features.corners);
      CHECK(fine.surface.features.curves.size() == features.curves.size());
      CHECK(fine.surface.features.n_patches == features.n_patches);
      CHECK(test::euler_characteristic(fine.surface) == test::euler_characteristic(c.surface));
      CHECK(test::enclosed_volume(fine.surface) == Approx(test::enclosed_volume(c.surface)));
      double longest = 0;
      std::vector<double> area(c.surface.triangles.size(), 0);
      for (std::size_t t = 0; t < fine.surface.triangles().size(); ++t) {
        const auto& v = fine.surface.triangles()[t];
        for (std::size_t i = 0; i < 3; ++i)
          longest = std::max(longest, (fine.surface.points[v[i]] - fine.surface.points[v[(i + 1) % 3]]).norm());
        area[fine.parent[t]] += test::area(fine.surface, t);
        CHECK(fine.surface.features.triangle_patch[t] == features.triangle_patch[fine.parent[t]]);
      }
      CHECK(longest <= c.length);
      if (flips == RefinementFlips::in_planes) continue;
      for (std::size_t t = 0; t < area.size(); ++t) CHECK(area[t] == Approx(test::area(c.surface, t)));
    }
}

TEST_CASE("needles of CAD are refined into few and good triangles") {
  for (const auto& surface : {test::cylinder_surface(0.5, 2, 60), test::l_shape_surface()}) {
    const double length = 0.1;
    const RefinedSurface fine = refine(surface, [&](const Vector3&) { return length; });
    double total = 0;
    for (std::size_t t = 0; t < fine.surface.triangles().size(); ++t) total += test::area(fine.surface, t);
    // Equilateral triangles with edges of 0.7 of the allowed length fill the surface, but for short input edges.
    CHECK(static_cast<double>(fine.surface.triangles().size()) < 2 * total / (0.433 * 0.49 * length * length));
  }
}

TEST_CASE("refining refuses lengths that make no sense") {
  const auto surface = test::box_surface({1, 1, 1});
  for (const double length : {0.0, -1.0, std::nan("")})
    CHECK_THROWS_AS(refine(surface, [&](const Vector3&) { return length; }), invalid_field);
  CHECK_THROWS_AS(refine(surface, [](const Vector3&) { return 1e-4; }, {.max_triangles = 10000}), invalid_option);
  const auto same = refine(surface, [](const Vector3&) { return 1e300 * 1e300; });
  CHECK(same.surface.triangles() == surface.triangles);
}
