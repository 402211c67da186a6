// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/lemon_matcher.hpp"
#include "framehex/pipeline/mesh_planar.hpp"
#include "framehex/pipeline/mesh_shell.hpp"
#include "framehex/verify/quad_quality.hpp"

#include "support/outlines.hpp"
#include "support/surfaces.hpp"

#include <catch2/catch.hpp>

#include <limits>
#include <string_view>

using namespace framehex;
using namespace framehex::test;

namespace {

QuadMeshing planar(const std::vector<Vector2>& points, double size, const QuadMeshingOptions& options = {}) {
  return mesh_planar(one_loop(points), ConstantSize{size}, LemonMatcher{}, options);
}

std::size_t n_kept(const QuadMesh& mesh, const std::vector<Vector2>& points) {
  std::size_t n = 0;
  for (const Vector2& p : points)
    n += std::any_of(mesh.points.begin(), mesh.points.end(), [&](const Vector3& q) { return q.head<2>() == p; });
  return n;
}

/// Each side cut into n.
std::vector<Vector2> subdivided(const std::vector<Vector2>& points, int n) {
  std::vector<Vector2> result;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int k = 0; k < n; ++k)
      result.emplace_back(points[i] + (points[(i + 1) % points.size()] - points[i]) * (static_cast<double>(k) / n));
  return result;
}

IndexedTriangleMesh fan(const std::vector<Vector2>& points) {
  IndexedTriangleMesh mesh;
  for (const Vector2& p : points) mesh.points.emplace_back(p.x(), p.y(), 0);
  for (index_t i = 1; i + 1 < points.size(); ++i) mesh.triangles.push_back({0, i, i + 1});
  return mesh;
}

}  // namespace

TEST_CASE("polygons keep their vertices and with them their area") {
  for (const int n : {3, 5, 6, 7, 8, 9, 10, 12, 16, 24, 36}) {
    CAPTURE(n);
    const std::vector<Vector2> points = circle({0, 0}, 1, n);
    const double side = 2 * std::sin(std::numbers::pi / n);
    for (const QuadMeshing& result :
         {planar(points, std::min(0.2, 0.9 * side)), planar(subdivided(points, 7), 0.1),
          mesh_shell(fan(points), ConstantSize{std::min(0.2, 0.9 * side)}, LemonMatcher{})}) {
      CHECK(n_kept(result.mesh, points) == points.size());
      const verify::QuadQuality quality = verify::quad_quality(result.mesh);
      CHECK(quality.area == Approx(polygon_area(points)).epsilon(1e-9));
      CHECK(quality.n_triangles == 0);
      CHECK(quality.least > 0.3);
    }
  }
}

TEST_CASE("a chamfer between long sides stays, the points of a smooth curve do not") {
  const double a = std::numbers::pi / 6;  // two bends of 30 degrees, then one of 30 again
  std::vector<Vector2> chamfer{{0, 0}, {2, 0}};
  chamfer.emplace_back(chamfer.back() + 0.08 * Vector2(std::cos(a), std::sin(a)));
  chamfer.emplace_back(chamfer.back() + Vector2(std::cos(2 * a), std::sin(2 * a)));
  chamfer.emplace_back(0, chamfer.back().y());
  CHECK(n_kept(planar(chamfer, 0.1).mesh, chamfer) == chamfer.size());
  for (const int n : {48, 100, 400}) {
    CAPTURE(n);
    const QuadMeshing result = planar(circle({0, 0}, 1, n), 0.2);
    CHECK(result.background.features.curves.size() == 1);
    CHECK(result.background.features.corners.empty());
  }
  // A regular polygon of sides that are shorter than the size is a curve. Where sides of that size would be too far from it,
  // those of the size that would do.
  CHECK(planar(circle({0, 0}, 1, 24), 0.3).background.features.corners.empty());
  QuadMeshingOptions unbounded;
  unbounded.retriangulation.max_deviation = std::numeric_limits<double>::infinity();
  const PlanarOutline wheel = one_loop(circle({0, 0}, 1, 24));
  CHECK(mesh_planar(wheel, ConstantSize{0.4}, LemonMatcher{}, unbounded).background.features.corners.empty());
  CHECK(mesh_planar(wheel, ConstantSize{0.4}, LemonMatcher{}).statistics.deviation <= 0.0075);
}

TEST_CASE("the angles that make corners can be asked for") {
  const std::vector<Vector2> points = circle({0, 0}, 1, 12);
  QuadMeshingOptions options;
  options.bends.straight = std::numeric_limits<double>::infinity();
  CHECK(planar(points, 0.2, options).background.features.corners.empty());
  options.features.corner_angle = 0.5;  // 30 degrees are 0.52
  CHECK(planar(points, 0.2, options).background.features.corners.size() == 12);
  options = {};
  options.bends.angle = 0.6;
  CHECK(planar(points, 0.2, options).background.features.corners.empty());
  options.bends.angle = 0;
  CHECK_THROWS_AS(planar(points, 0.2, options), invalid_option);
  // All bends of 10 degrees count, whatever rounding makes of them.
  CHECK(planar(circle({0, 0}, 1, 36), 0.1).background.features.corners.size() == 36);
}

TEST_CASE("new corners divide curves, closed or not, and nothing else") {
  const auto rows = [](const FeatureGraph& graph) {
    std::vector<std::vector<index_t>> result;
    for (std::size_t c = 0; c < graph.curves.size(); ++c)
      result.emplace_back(graph.curves[c].begin(), graph.curves[c].end());
    return result;
  };
  FeatureGraph graph;
  graph.corners = {0, 4};
  graph.curves.values = {0, 1, 2, 3, 4, 5, 6, 7, 8, 5, 9, 10, 9};
  graph.curves.offsets = {0, 5, 10, 13};
  FeatureGraph same = graph;
  add_corners(same, {});
  CHECK(rows(same) == rows(graph));
  add_corners(graph, std::vector<index_t>{1, 3, 6, 8});
  CHECK(graph.corners == std::vector<index_t>{0, 1, 3, 4, 6, 8});
  CHECK(rows(graph) == std::vector<std::vector<index_t>>{{0, 1}, {1, 2, 3}, {3, 4}, {6, 7, 8}, {8, 5, 6}, {9, 10, 9}});
}

TEST_CASE("simple triangles have no cells much worse than their own corners") {
  const double rise = std::sqrt(0.75);
  for (const auto& [points, size] : {std::pair{std::vector<Vector2>{{0, 0}, {1, 0}, {0, 1}}, 0.3},
                                     {{{0, 0}, {1, 0}, {0, 1}}, 0.2},
                                     {{{0, 0}, {1, 0}, {0.5, rise}}, 0.2},
                                     {{{0, 0}, {1, 0}, {0.5, rise}}, 0.1}}) {
    CAPTURE(points[2].x(), size);
    const verify::QuadQuality quality = verify::quad_quality(planar(points, size).mesh);
    CHECK(quality.n_triangles == 0);
    CHECK(quality.least > 0.6);
    CHECK(quality.mean > 0.75);
  }
}

TEST_CASE("shells at sizes beyond the body are near it all the same") {
  const IndexedTriangleMesh sphere = sphere_surface(1, 4);
  for (const double size : {1.0, 2.0, 6.0, 1e3, 1e9}) {
    CAPTURE(size);
    const QuadMeshing result = mesh_shell(sphere, ConstantSize{size}, LemonMatcher{});
    CHECK(result.mesh.n_triangles() == 0);
    CHECK(result.statistics.deviation < 0.01);
    CHECK(result.statistics.n_shrunk_places > 0);
    double lowest = 1;  // of the sphere itself
    for (const auto& cell : result.mesh.cells) {
      Vector3 sum = Vector3::Zero();
      for (const index_t v : cell) sum += result.mesh.points[v] / 4;
      lowest = std::min(lowest, sum.norm());
    }
    CHECK(1 - lowest < 0.013 * 2 * std::sqrt(3.0));
  }
}

TEST_CASE("shells of no wished size to speak of are not improved before they are fine enough", "[regression]") {
  // Improvement of eight cells for a torus took half a minute, of what was thrown away.
  std::size_t n_meshes = 0, n_before_improvement = 0;
  std::string_view last;
  QuadMeshingOptions options;
  options.observer = [&](const Progress& progress) {
    if (progress.stage != last) {
      n_meshes += progress.stage == "quadrangulation";
      if (progress.stage == "improvement" && n_before_improvement == 0) n_before_improvement = n_meshes;
      last = progress.stage;
    }
    return true;
  };
  const QuadMeshing result = mesh_shell(torus_surface(1, 0.4, 40, 20), ConstantSize{1000}, LemonMatcher{}, options);
  CHECK(n_before_improvement >= 3);
  CHECK(result.mesh.n_triangles() == 0);
  CHECK(result.statistics.deviation < 0.01);
}
