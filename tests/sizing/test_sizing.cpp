// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "framehex/sizing/graded_size.hpp"
#include "framehex/sizing/surface_sizes.hpp"
#include "framehex/surface/refinement.hpp"
#include "framehex/surface/surface_locator.hpp"
#include "support/complexes.hpp"
#include "support/insertion_fixtures.hpp"
#include "support/surfaces.hpp"

#include <catch2/catch.hpp>

#include <numbers>
#include <random>

using namespace framehex;
using namespace framehex::test;

namespace {

Vector3 random_point(std::mt19937_64& random, double width) {
  std::uniform_real_distribution<double> x(-width, width);
  return {x(random), x(random), x(random)};
}

Surface refined(const IndexedTriangleMesh& mesh, double edge) {
  return refine(Surface(mesh), [edge](const Vector3&) { return edge; }).surface;
}

double lattice_point_distance(const Vector3& p, const SizeSource& s) {
  // By brute force over the triangle, to a thousandth of its width.
  double best = unbounded;
  constexpr int n = 400;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const double u = double(i) / n, v = double(j) / n;
      best = std::min(
          best, (s.corners[0] + u * (s.corners[1] - s.corners[0]) + v * (s.corners[2] - s.corners[0]) - p).norm());
    }
  return best;
}

/// Edges of hexahedra in units of the wished length at their middle, and longest by shortest of each hexahedron.
struct HexahedronEdges {
  std::vector<double> ratios, anisotropy;
};

HexahedronEdges hexahedron_edges(const MixedMesh& mesh, const GradedSize& size) {
  HexahedronEdges result;
  for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
    if (mesh.kinds[c] != CellKind::hexahedron) continue;
    double shortest = unbounded, longest = 0;
    for (const auto& [a, b] : edges_of(CellKind::hexahedron)) {
      const Vector3 &p = mesh.points[mesh.cells[c][std::size_t(a)]], &q = mesh.points[mesh.cells[c][std::size_t(b)]];
      result.ratios.push_back((p - q).norm() / size((p + q) / 2));
      shortest = std::min(shortest, (p - q).norm());
      longest = std::max(longest, (p - q).norm());
    }
    result.anisotropy.push_back(longest / shortest);
  }
  return result;
}

double quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * double(values.size() - 1))];
}

}  // namespace

TEST_CASE("a graded size is the least that its sources allow, between its bounds") {
  std::mt19937_64 random(7);
  std::vector<SizeSource> sources;
  for (int i = 0; i < 40; ++i) {
    const Vector3 a = random_point(random, 4), length = random_point(random, 1).cwiseAbs();
    const double h = 0.1 + length.x();
    sources.push_back({{a, a + random_point(random, 0.5), a + random_point(random, 0.5)}, {h, h, h}});
  }
  const GradedSizeOptions bounds{.most = 0.9, .least = 0.2, .growth = 0.4};
  const GradedSize size(bounds, sources);
  CHECK(size.n_sources() < sources.size());  // those above 0.9 are of no use
  double lowest = unbounded, highest = 0;
  for (int i = 0; i < 60; ++i) {
    const Vector3 p = random_point(random, 5);
    double expected = bounds.most;
    for (const SizeSource& s : sources)
      expected = std::min(expected, s.lengths[0] + bounds.growth * lattice_point_distance(p, s));
    expected = std::max(expected, bounds.least);
    CHECK(size(p) == Approx(expected).margin(2e-3));
    lowest = std::min(lowest, size(p));
    highest = std::max(highest, size(p));
  }
  CHECK(lowest < 0.7);
  CHECK(highest == bounds.most);
}

TEST_CASE("a graded size grows by no more than its growth") {
  std::mt19937_64 random(8);
  std::vector<SizeSource> sources;
  for (int i = 0; i < 500; ++i) {
    const Vector3 a = random_point(random, 2);
    const double h = 0.01 + random_point(random, 0.2).cwiseAbs().x();
    sources.push_back({{a, a + random_point(random, 0.1), a + random_point(random, 0.1)}, {h, h, h}});
  }
  const GradedSize size({.most = 2, .growth = 0.25}, sources);
  for (int i = 0; i < 20'000; ++i) {
    const Vector3 p = random_point(random, 3), q = p + random_point(random, i % 2 == 0 ? 0.05 : 1);
    REQUIRE(std::abs(size(p) - size(q)) <= 0.25 * (p - q).norm() + 1e-12);
  }
}

TEST_CASE("a graded size without sources is its bound, bit by bit; with a field it is the least of both") {
  const GradedSize constant({.most = 0.3});
  CHECK(constant({1, 2, 3}) == 0.3);
  const IndexedTetMesh tet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};
  const VertexSizeField field(std::make_shared<TetLocator>(make_adjacency(tet), tet.points), {0.1, 0.2, 0.2, 0.2});
  const GradedSize size({.most = 0.16, .least = 0.12}, {}, field);
  CHECK(size({0, 0, 0}) == 0.12);
  CHECK(size({0.4, 0, 0}) == Approx(0.14));
  CHECK(size({0, 0.9, 0}) == 0.16);
}

TEST_CASE("bad wishes are refused") {
  const IndexedTriangleMesh box = box_surface({1, 1, 1});
  const auto one = [](double x) { return std::vector<double>(12, x); };
  CHECK_THROWS_AS(GradedSize({}), invalid_option);
  CHECK_THROWS_AS(GradedSize({.most = 1, .least = 2}), invalid_option);
  CHECK_THROWS_AS(GradedSize({.most = 1, .growth = 0}), invalid_option);
  CHECK_THROWS_AS(
      GradedSize({.most = 1}, {SizeSource{{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0)}, {1, 0, 1}}}),
      invalid_field);
  CHECK_THROWS_AS(triangle_sources(box, std::vector<double>(11, 1.0)), invalid_option);
  CHECK_THROWS_AS(triangle_sources(box, one(0)), invalid_field);
  CHECK_THROWS_AS(triangle_sources(box, one(std::nan(""))), invalid_field);
  CHECK(triangle_sources(box, one(unbounded)).empty());
  CHECK_THROWS_AS(vertex_sources(box, std::vector<double>(8, -1.0), 0.3), invalid_field);
  CHECK_THROWS_AS(vertex_sources(box, std::vector<double>(7, 1.0), 0.3), invalid_option);
  CHECK_THROWS_AS(curvature_sizes(Surface(box), 2), invalid_option);
}

TEST_CASE("sizes at vertices are limited along the edges as the shortest ways allow") {
  const IndexedTriangleMesh sphere = sphere_surface(1, 2);
  std::mt19937_64 random(9);
  std::vector<double> wanted(sphere.points.size());
  for (double& h : wanted) h = 0.05 + 3 * random_point(random, 1).cwiseAbs().x();
  // Floyd and Warshall.
  const std::size_t n = wanted.size();
  std::vector<std::vector<double>> way(n, std::vector<double>(n, unbounded));
  for (std::size_t v = 0; v < n; ++v) way[v][v] = 0;
  for (const auto& t : sphere.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const index_t a = t[i], b = t[(i + 1) % 3];
      way[a][b] = way[b][a] = (sphere.points[a] - sphere.points[b]).norm();
    }
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) way[i][j] = std::min(way[i][j], way[i][k] + way[k][j]);
  std::size_t n_lowered = 0;
  const auto sources = vertex_sources(sphere, wanted, 0.3);
  REQUIRE(sources.size() == sphere.triangles.size());
  for (std::size_t t = 0; t < sources.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const index_t v = sphere.triangles[t][i];
      double expected = wanted[v];
      for (std::size_t w = 0; w < n; ++w) expected = std::min(expected, wanted[w] + 0.3 * way[v][w]);
      n_lowered += expected < wanted[v];
      REQUIRE(sources[t].lengths[i] == Approx(expected));
    }
  CHECK(n_lowered > 50);
}

TEST_CASE("curvature of spheres, cylinders, tori and planes") {
  for (const double k : surface_curvature(Surface(sphere_surface(2, 3)))) CHECK(k == Approx(0.5).epsilon(0.06));
  for (const double h : curvature_sizes(Surface(sphere_surface(2, 3)), 24))
    CHECK(h == Approx(2 * std::numbers::pi * 2 / 24).epsilon(0.06));
  for (const double h : curvature_sizes(Surface(box_surface({3, 2, 1})), 24)) CHECK(std::isinf(h));

  const IndexedTriangleMesh cylinder = cylinder_surface(0.5, 3, 40);
  const std::vector<double> round = surface_curvature(Surface(cylinder));
  for (std::size_t t = 0; t < round.size(); ++t) {
    const auto& v = cylinder.triangles[t];
    const double z = cylinder.points[v[0]].z();
    const bool is_lid = cylinder.points[v[1]].z() == z && cylinder.points[v[2]].z() == z;
    CHECK(round[t] == Approx(is_lid ? 0 : 2).epsilon(0.05).margin(1e-9));
  }

  // Round the tube everywhere, and round the axis by less.
  const std::vector<double> torus = surface_curvature(Surface(torus_surface(3, 0.5, 120, 40)));
  for (const double k : torus) CHECK(k == Approx(2).epsilon(0.05));
}

TEST_CASE("thickness of walls") {
  const double thick = 0.2, reach = 0.5;
  const Surface plate = refined(box_surface({3, 2, thick}), 0.4);
  const std::vector<double> of_plate = wall_thickness(plate, find_regions(plate), reach);
  for (std::size_t t = 0; t < of_plate.size(); ++t) {
    const auto& v = plate.triangles()[t];
    const Vector3 normal = (plate.points[v[1]] - plate.points[v[0]]).cross(plate.points[v[2]] - plate.points[v[0]]);
    const bool is_lid = std::abs(normal.normalized().z()) > 0.5;
    if (is_lid)
      CHECK(of_plate[t] == Approx(thick));
    else
      CHECK(std::isinf(of_plate[t]));
  }

  // Between two spheres: the shell is a wall, the cavity is none.
  IndexedTriangleMesh shell = sphere_surface(1, 4), inner = sphere_surface(0.9, 4);
  for (auto& t : inner.triangles) std::swap(t[1], t[2]);
  append(shell, inner);
  for (const double h : wall_thickness(Surface(shell), find_regions(Surface(shell)), 3))
    CHECK(h == Approx(0.1).margin(0.01));

  // A corner of 45 degrees is no wall, one of 20 degrees is.
  for (const double degrees : {45.0, 20.0}) {
    const double y = std::tan(degrees * std::numbers::pi / 180);
    const Surface wedge(extruded_polygon({{0, 0}, {1, 0}, {1, y}}, 5));
    const auto of_wedge = wall_thickness(wedge, find_regions(wedge), 0.9);
    CHECK(std::any_of(of_wedge.begin(), of_wedge.end(), [](double h) { return std::isfinite(h); }) == (degrees < 30));
  }
}

TEST_CASE("walls of two materials are looked at from both sides of what is between them") {
  const IndexedTriangleMesh shells = nested_shells(3);  // of radius 1, 0.7 and 0.4
  const Surface surface(shells);
  const auto thickness = wall_thickness(surface, find_regions(surface), 0.45);
  for (const double h : thickness) CHECK(h == Approx(0.3).margin(0.03));
}

TEST_CASE("a ray meets what brute force finds") {
  const IndexedTriangleMesh sphere = sphere_surface(1, 3);
  const SurfaceLocator locator(sphere);
  std::mt19937_64 random(10);
  for (int i = 0; i < 2000; ++i) {
    const Vector3 from = random_point(random, 0.5), direction = random_point(random, 1).normalized();
    const auto hit = locator.first_hit(from, direction, 10);
    REQUIRE(hit);
    const Vector3 p = from + hit->distance * direction;
    const auto& t = sphere.triangles[hit->triangle];
    CHECK(nearest_on_triangle(p, sphere.points[t[0]], sphere.points[t[1]], sphere.points[t[2]]).squared_distance <
          1e-20);
    CHECK(p.norm() == Approx(1).margin(0.02));
    CHECK_FALSE(locator.first_hit(from, direction, 0.99 * hit->distance));
    CHECK_FALSE(locator.first_hit(p + direction, direction, 10));
    const auto behind = locator.first_hit(from, direction, 10, hit->triangle);
    CHECK((!behind || behind->triangle != hit->triangle));
  }
}

TEST_CASE("hexahedra of a graded box follow its sizes and are no flatter than the sizes let them") {
  const IndexedTriangleMesh box = box_surface({4, 3, 3});
  std::vector<double> lengths(box.triangles.size(), unbounded);
  for (std::size_t t = 0; t < lengths.size(); ++t) {
    const auto& v = box.triangles[t];
    if (box.points[v[0]].x() == 0 && box.points[v[1]].x() == 0 && box.points[v[2]].x() == 0) lengths[t] = 0.15;
  }
  const GradedSize size({.most = 0.5, .growth = 0.15}, triangle_sources(box, lengths));
  // A lattice lengthens and shortens steps on purpose.
  const MeshingResult result = mesh_surface(box, size, TetgenProcess{}, {.order = PointOrder::smoothness});
  const HexahedronEdges edges = hexahedron_edges(result.recombination.mesh, size);
  REQUIRE(edges.anisotropy.size() > 500);
  CHECK(median(edges.ratios) == Approx(1).margin(0.1));
  CHECK(quantile(edges.ratios, 0.05) > 0.6);
  CHECK(quantile(edges.ratios, 0.95) < 1.6);
  CHECK(median(edges.anisotropy) < 1.6);
  CHECK(quantile(edges.anisotropy, 0.95) < 2.5);
}

TEST_CASE("so many cells go across a wall as are wished") {
  const IndexedTriangleMesh plate = box_surface({2, 2, 0.2});
  const Surface fine = refined(plate, 0.2);
  const SurfaceRegions regions = find_regions(fine);
  const GradedSize size({.most = 0.2}, wall_sources(fine, regions, wall_thickness(fine, regions, 0.8), 4));
  CHECK(size({1, 1, 0.1}) == Approx(0.05));
  const MixedMesh mesh =
      mesh_surface(plate, size, TetgenProcess{}, {.order = PointOrder::smoothness}).recombination.mesh;
  // Where the plate is a plane lattice, vertices lie at five heights.
  std::array<std::size_t, 5> at_height{};
  std::size_t n_between = 0;
  for (const Vector3& p : mesh.points) {
    const double layer = p.z() / 0.05;
    std::abs(layer - std::round(layer)) < 0.2 ? void(++at_height[std::size_t(std::lround(layer))]) : void(++n_between);
  }
  for (const std::size_t n : at_height) CHECK(n > mesh.points.size() / 8);
  CHECK(n_between < mesh.points.size() / 20);
}
