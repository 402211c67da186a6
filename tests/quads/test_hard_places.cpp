// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/lemon_matcher.hpp"
#include "framehex/pipeline/mesh_planar.hpp"
#include "framehex/pipeline/mesh_shell.hpp"
#include "framehex/verify/quad_quality.hpp"

#include "support/outlines.hpp"
#include "support/surfaces.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace framehex;
using namespace framehex::test;

namespace {

/// A cone of height 1 about z, without its base; vertex 0 is the tip.
IndexedTriangleMesh cone(double radius, index_t n_sides) {
  IndexedTriangleMesh mesh;
  mesh.points.emplace_back(0, 0, 1);
  for (index_t i = 0; i < n_sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / n_sides;
    mesh.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % n_sides});
  }
  return mesh;
}

bool has_vertex(const QuadMesh& mesh, const Vector3& p) {
  return std::find(mesh.points.begin(), mesh.points.end(), p) != mesh.points.end();
}

void check_quadrilaterals(const QuadMeshing& result) {
  const verify::QuadQuality quality = verify::quad_quality(result.mesh);
  CHECK(quality.n_triangles == 0);
  CHECK(quality.folded.empty());
  CHECK(quality.n_bad_edges == 0);
  CHECK(quality.index_sum == 4 * quality.euler_characteristic);
}

/// n x n holes in a square with sides of n.
PlanarOutline perforated_plate(int n, const std::vector<Vector2>& hole) {
  PlanarOutline outline;
  const auto add = [&](const std::vector<Vector2>& points, const Vector2& at) {
    const auto first = static_cast<index_t>(outline.points.size());
    for (const Vector2& p : points) {
      outline.loops.values.push_back(static_cast<index_t>(outline.points.size()));
      outline.points.emplace_back(p + at);
    }
    outline.loops.values.push_back(first);
    outline.loops.end_row();
  };
  add({{0, 0}, {n, 0}, {n, n}, {0, n}}, {0, 0});
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y) add(hole, {x + 0.5, y + 0.5});
  return outline;
}

}  // namespace

TEST_CASE("the tips of cones are vertices of the mesh, found with few attempts") {
  for (const double radius : {0.1, 0.2, 0.5}) {
    CAPTURE(radius);
    std::size_t n_attempts = 0;
    QuadMeshingOptions options;
    options.observer = [&](const Progress& progress) {
      n_attempts += progress.stage == "quadrangulation";
      return true;
    };
    const QuadMeshing result = mesh_shell(cone(radius, 50), ConstantSize{0.1}, LemonMatcher{}, options);
    check_quadrilaterals(result);
    CHECK(has_vertex(result.mesh, Vector3(0, 0, 1)));
    CHECK(result.statistics.deviation < 0.01);
    // As sharp as the tip is, where three cells meet, and no worse elsewhere; most of the mesh is far from it.
    CHECK(verify::quad_quality(result.mesh).mean > 0.9);
    CHECK(verify::quad_quality(result.mesh).least > std::min(0.5, 1.4 * radius));
    CHECK(n_attempts < 40);
    CHECK(result.statistics.n_tried_changes < 20'000);
  }
}

TEST_CASE("tips stand out where a cone does, and not on smooth or noisy surfaces") {
  const auto tips = [](const IndexedTriangleMesh& mesh, double size) {
    return distinct_tips(Surface(mesh, FeatureOptions{.corner_angle = FeatureOptions{}.angle}), ConstantSize{size});
  };
  for (const double size : {0.01, 0.1, 10.0}) {
    CAPTURE(size);
    CHECK(tips(cone(0.3, 40), size) == std::vector<index_t>{0});
    CHECK(tips(cone(2, 40), size).empty());  // as flat as a plate
    CHECK(tips(sphere_surface(1, 3), size).empty());
  }
  // Bumps of random height on a plane that is fine for the size.
  constexpr index_t n = 40;
  IndexedTriangleMesh noisy;
  std::mt19937 engine(3);
  for (index_t i = 0; i <= n; ++i)
    for (index_t j = 0; j <= n; ++j)
      noisy.points.emplace_back(i, j, 0.9 * static_cast<double>(engine()) / 4294967296.0);
  for (index_t i = 0; i < n; ++i)
    for (index_t j = 0; j < n; ++j) {
      const index_t a = i * (n + 1) + j, b = a + n + 1;
      noisy.triangles.push_back({a, b, b + 1});
      noisy.triangles.push_back({a, b + 1, a + 1});
    }
  FeatureOptions smooth;
  smooth.angle = smooth.corner_angle = std::numbers::pi;
  CHECK(distinct_tips(Surface(noisy, smooth), ConstantSize{5}, {.defect = 0.5}).empty());
  CHECK_THROWS_AS(distinct_tips(Surface(cone(0.3, 40), {}), ConstantSize{1}, {.defect = 0}), invalid_option);
}

TEST_CASE("plates keep holes that are smaller than the size, and cells spread from them") {
  const std::vector<Vector2> round = circle({0, 0}, 0.3, 12), square = {{-.2, -.2}, {.2, -.2}, {.2, .2}, {-.2, .2}};
  for (const int n : {2, 5}) {
    for (const std::vector<Vector2>& hole : {round, square}) {
      CAPTURE(n);
      CAPTURE(hole.size());
      const QuadMeshing result = mesh_planar(perforated_plate(n, hole), ConstantSize{5}, LemonMatcher{});
      check_quadrilaterals(result);
      const verify::QuadQuality quality = verify::quad_quality(result.mesh);
      CHECK(quality.euler_characteristic == 1 - n * n);
      CHECK(quality.least > 0.45);
      CHECK(quality.mean > 0.85);
      const double lost = quality.area - n * n * (1 - polygon_area(hole));
      CHECK(lost < 0.12 * n * n * polygon_area(hole));
      CHECK(result.statistics.n_tried_changes < 30 * result.mesh.cells.size() + 2000);
    }
  }
}

TEST_CASE("stars with several sharp corners fall into quadrilaterals") {
  const std::vector<Vector2> star = {
      {0.088717318462607095, 0.29249794942467638},   {0.033916866849508516, 0.1531747706567268},
      {0.0054352687664513495, 0.095007592526639428}, {0.014586023295405643, 0.29396603906750951},
      {0.0063344365986687341, 0.13215348469482371},  {-0.25157494072246456, 0.855454506162863},
      {-0.81986558295241729, -0.017477362584575013}, {-0.79582313496899582, -0.099591074090994394},
      {-0.42646457981991115, -0.091449007670517946}, {0.15680685534255195, -0.77108543345675884},
      {0.24937330588888515, -0.15386365070700167}};
  const QuadMeshing result = mesh_planar(one_loop(star), ConstantSize{0.1295089654645717}, LemonMatcher{});
  CHECK(result.statistics.n_left_triangles == 0);
  check_quadrilaterals(result);
}
