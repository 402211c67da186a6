// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/boost_matcher.hpp"
#include "framehex/adapters/lemon_matcher.hpp"
#include "framehex/pipeline/mesh_planar.hpp"
#include "framehex/pipeline/mesh_shell.hpp"

#include "support/outlines.hpp"
#include "support/ply.hpp"
#include "support/quad_checks.hpp"
#include "support/stl.hpp"
#include "support/surfaces.hpp"

#include <catch2/catch.hpp>

using namespace framehex;
using namespace framehex::test;

namespace {

struct Quality {
  double least = 1, mean = 0;
};

/// Against each cell's own plane.
Quality quality_of(const QuadMesh& mesh) {
  Quality q;
  for (const auto& cell : mesh.cells) {
    std::array<Vector3, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = mesh.points[cell[i]];
    const Vector3 normal = (p[2] - p[0]).cross(p[3] - p[1]).normalized();
    CHECK(is_convex(p, normal));
    const double sj = scaled_jacobian(p, normal);
    q.least = std::min(q.least, sj);
    q.mean += sj / static_cast<double>(mesh.cells.size());
  }
  return q;
}

double area(const QuadMesh& mesh) {
  double sum = 0;
  for (const auto& c : mesh.cells)
    sum += (mesh.points[c[2]] - mesh.points[c[0]]).cross(mesh.points[c[3]] - mesh.points[c[1]]).norm() / 2;
  return sum;
}

/// What every result has to be: quadrilaterals alone, on the curves, irregular vertices adding up.
void check_result(const QuadMeshing& result, const Surface& input, int characteristic, double least_mean) {
  const QuadMesh& mesh = result.mesh;
  REQUIRE(result.status == Status::complete);
  CHECK(mesh.n_triangles() == 0);
  CHECK(topology_fault(mesh) == std::nullopt);
  CHECK(euler_characteristic(mesh) == characteristic);
  const Quality quality = quality_of(mesh);
  CHECK(quality.least >= 0.3);
  CHECK(quality.mean >= least_mean);
  // Inside 4 cells make a vertex regular, on a rim 2.
  std::vector<int> index(mesh.points.size(), 4);
  for (const auto& [a, b] : rim_sides(mesh)) index[a] = 2;
  for (const auto& cell : mesh.cells)
    for (const index_t v : cell) --index[v];
  CHECK(std::accumulate(index.begin(), index.end(), 0) == 4 * characteristic);
  const FeatureCarriers carriers(input);
  const double diagonal = bounding_box(input.points).diagonal().norm();
  for (const LabelledEdge& edge : mesh.edges)
    for (const index_t v : edge.vertices)
      REQUIRE((carriers.onto_curve(edge.label, mesh.points[v]) - mesh.points[v]).norm() < 1e-9 * diagonal);
  const SurfaceLocator locator(input);
  for (const Vector3& p : mesh.points) REQUIRE(locator.nearest(p).distance < 1e-9 * diagonal);
}

Surface surface_of(const PlanarOutline& outline) {
  return triangulate_outline(outline).surface();
}

void check_planar(const PlanarOutline& outline, double size, int characteristic) {
  check_result(mesh_planar(outline, ConstantSize{size}, LemonMatcher{}), surface_of(outline), characteristic, 0.9);
}

}  // namespace

TEST_CASE("a rectangle becomes the exact grid, however it lies") {
  for (const double degrees : {0.0, 10.0, 17.0, 30.0, 45.0, 60.0, 81.3}) {
    CAPTURE(degrees);
    const QuadMeshing result = mesh_planar(one_loop(rectangle(2, 1, degrees)), ConstantSize{0.125}, LemonMatcher{});
    CHECK(result.mesh.cells.size() == 16 * 8);
    CHECK(result.mesh.points.size() == 17 * 9);
    CHECK(quality_of(result.mesh).least > 1 - 1e-9);
    const double a = degrees * std::numbers::pi / 180;
    for (const Vector3& p : result.mesh.points) {
      const double u = 8 * (std::cos(a) * p.x() + std::sin(a) * p.y()),
                   v = 8 * (std::cos(a) * p.y() - std::sin(a) * p.x());
      CHECK(std::abs(u - std::round(u)) < 1e-7);
      CHECK(std::abs(v - std::round(v)) < 1e-7);
    }
  }
}

TEST_CASE("disc and annulus") {
  check_planar(disc(), 0.1, 1);
  check_planar(annulus(), 0.1, 0);
}

TEST_CASE("L and plate with three holes") {
  check_planar(ell(), 0.1, 1);
  check_planar(plate_with_holes(), 0.1, -2);
}

TEST_CASE("gear and section in a box") {
  check_planar(gear(), 0.06, 0);
  check_planar(section_in_box(), 0.09, 0);
}

TEST_CASE("the other order, another matcher, and pairs alone") {
  const Surface input = surface_of(disc());
  check_result(mesh_planar(disc(), ConstantSize{0.12}, LemonMatcher{}, {.order = FrontOrder::fifo}), input, 1, 0.9);
  check_result(mesh_planar(disc(), ConstantSize{0.12}, BoostMatcher{}), input, 1, 0.9);
  const QuadMeshing pairs =
      mesh_planar(disc(), ConstantSize{0.12}, GreedyMatcher{}, {.quads = {.goal = QuadGoal::pairs}});
  CHECK(pairs.mesh.n_triangles() > 0);
  CHECK(4 * pairs.mesh.n_triangles() < pairs.mesh.cells.size());
  CHECK(topology_fault(pairs.mesh) == std::nullopt);
}

TEST_CASE("regions share the curves between them, an odd one gets an interval more") {
  PlanarOutline outline = one_loop({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {0, 1}});
  outline.inner.values = {1, 4};
  outline.inner.end_row();
  check_planar(outline, 0.21, 1);
  const QuadMeshing result = mesh_planar(outline, ConstantSize{0.21}, LemonMatcher{});
  std::set<index_t> patches(result.mesh.patches.begin(), result.mesh.patches.end());
  CHECK(patches.size() == 2);
  CHECK(area(result.mesh) == Approx(2));

  const QuadMeshing triangle = mesh_planar(one_loop({{0, 0}, {3, 0}, {1.2, 2.4}}), ConstantSize{0.5}, LemonMatcher{});
  CHECK(triangle.mesh.n_triangles() == 0);
  CHECK(triangle.statistics.lengthened_curves.size() == 1);
}

TEST_CASE("thin regions become quadrilaterals or are refused by name, never folded cells") {
  std::size_t n_meshed = 0;
  for (const double thickness : {0.5, 0.2, 0.1, 0.05, 0.02, 0.01}) {
    CAPTURE(thickness);
    PlanarOutline ring = disc(), excentric = disc();
    add_loop(ring, circle({0, 0}, 1 - thickness, 128));
    add_loop(excentric, circle({0.7 - thickness, 0}, 0.3, 128));
    const PlanarOutline wedge = one_loop({{0, 0}, {2, -thickness}, {2, thickness}});
    for (const PlanarOutline& outline : {ring, excentric, wedge, one_loop(rectangle(2, thickness))}) {
      try {
        const QuadMesh mesh = mesh_planar(outline, ConstantSize{0.2}, LemonMatcher{}).mesh;
        for (const auto& cell : mesh.cells) {
          std::array<Vector3, 4> p;
          for (std::size_t i = 0; i < 4; ++i) p[i] = mesh.points[cell[i]];
          CHECK(is_convex(p, Vector3::UnitZ()));
        }
        ++n_meshed;
      } catch (const invalid_surface& e) {
        CHECK(e.entity() == Entity::vertex);
        CHECK(e.indices().size() == 3);
      }
    }
  }
  CHECK(n_meshed >= 20);
}

TEST_CASE("shells: open and closed surfaces") {
  const IndexedTriangleMesh dome = read_ply(FRAMEHEX_TEST_DATA "/dome.ply"),
                            bunny = read_stl(FRAMEHEX_TEST_DATA "/bunny.stl");
  check_result(mesh_shell(dome, ConstantSize{0.2}, LemonMatcher{}), Surface(dome), 2, 0.9);
  check_result(mesh_shell(bunny, ConstantSize{0.3}, LemonMatcher{}), Surface(bunny), 2, 0.85);
  // Half of a torus: a tube with two rims.
  IndexedTriangleMesh tube = torus_surface(2, 0.7, 48, 24);
  std::erase_if(tube.triangles, [&](const auto& t) {
    return tube.points[t[0]].y() + tube.points[t[1]].y() + tube.points[t[2]].y() < 0;
  });
  check_result(mesh_shell(tube, ConstantSize{0.2}, LemonMatcher{}), Surface(tube), 0, 0.9);
}

TEST_CASE("shells: bad input is refused by name, and work can be cancelled") {
  IndexedTriangleMesh strip;  // of Moebius: six quadrilaterals, the ends joined upside down
  for (int i = 0; i < 6; ++i)
    for (const double side : {-0.3, 0.3}) {
      const double angle = 2 * std::numbers::pi * i / 6, half = angle / 2, r = 1 + side * std::cos(half);
      strip.points.emplace_back(r * std::cos(angle), r * std::sin(angle), side * std::sin(half));
    }
  for (index_t i = 0; i < 6; ++i) {
    const index_t a = 2 * i, b = a + 1, c = i == 5 ? 1 : a + 2, d = i == 5 ? 0 : a + 3;
    strip.triangles.push_back({a, c, b});
    strip.triangles.push_back({b, c, d});
  }
  try {
    mesh_shell(strip, ConstantSize{0.2}, LemonMatcher{});
    FAIL("a Moebius strip has one side only");
  } catch (const nonmanifold& e) {
    CHECK(e.entity() == Entity::triangle);
    CHECK(e.indices().size() == 2);
  }
  CHECK_THROWS_AS(mesh_shell(IndexedTriangleMesh{}, ConstantSize{0.2}, LemonMatcher{}), open_surface);
  const auto box = box_surface({1, 1, 1});
  CHECK_THROWS_AS(mesh_shell(box, ConstantSize{-1}, LemonMatcher{}), invalid_field);
  CHECK_THROWS_AS(mesh_shell(box, ConstantSize{1e-6}, LemonMatcher{}), invalid_option);
  int n_heard = 0;
  const auto stop_at = [&](int n) { return [&n_heard, n](const Progress&) { return ++n_heard < n; }; };
  for (const int n : {1, 2, 3, 5, 8}) {
    n_heard = 0;
    const QuadMeshing result = mesh_shell(box, ConstantSize{0.1}, LemonMatcher{}, {.observer = stop_at(n)});
    CHECK(result.status == Status::cancelled);
    CHECK(result.mesh.cells.empty());
  }
}
