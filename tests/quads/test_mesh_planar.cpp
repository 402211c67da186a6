// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/boost_matcher.hpp"
#include "framehex/adapters/lemon_matcher.hpp"
#include "framehex/geometry/bounding_box.hpp"
#include "framehex/pipeline/mesh_planar.hpp"
#include "framehex/pipeline/mesh_shell.hpp"

#include "support/flat_delaunay.hpp"
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

/// What every result has to be: convex quadrilaterals alone, on the curves, irregular vertices adding up.
void check_kept(const QuadMeshing& result, const Surface& input, int characteristic) {
  const QuadMesh& mesh = result.mesh;
  REQUIRE(result.status == Status::complete);
  CHECK(mesh.n_triangles() == 0);
  CHECK(topology_fault(mesh) == std::nullopt);
  CHECK(euler_characteristic(mesh) == characteristic);
  // Inside 4 cells make a vertex regular, on a rim 2.
  std::vector<int> index(mesh.points.size(), 4);
  for (const auto& [a, b] : rim_sides(mesh)) index[a] = 2;
  for (const auto& cell : mesh.cells)
    for (const index_t v : cell) --index[v];
  CHECK(std::accumulate(index.begin(), index.end(), 0) == 4 * characteristic);
  const FeatureCarriers carriers(result.background);  // labels are those of its curves
  const double diagonal = bounding_box(input.points).diagonal().norm();
  for (const LabelledEdge& edge : mesh.edges) {
    REQUIRE(edge.label < carriers.n_curves());
    for (const index_t v : edge.vertices)
      REQUIRE((carriers.onto_curve(edge.label, mesh.points[v]) - mesh.points[v]).norm() < 1e-9 * diagonal);
  }
  const SurfaceLocator locator(input);
  for (const Vector3& p : mesh.points) REQUIRE(locator.nearest(p).distance < 1e-9 * diagonal);
}

void check_result(const QuadMeshing& result, const Surface& input, int characteristic, double least_mean) {
  check_kept(result, input, characteristic);
  const Quality quality = quality_of(result.mesh);
  CHECK(quality.least >= 0.3);
  CHECK(quality.mean >= least_mean);
}

/// Largest distance from points of one surface to the other, over the diagonal: both ways.
double deviation(const QuadMesh& mesh, const IndexedTriangleMesh& surface) {
  IndexedTriangleMesh flat{mesh.points, {}};
  for (const auto& c : mesh.cells) {
    flat.triangles.push_back({c[0], c[1], c[2]});
    flat.triangles.push_back({c[0], c[2], c[3]});
  }
  double largest = 0;
  const auto measure = [&](const IndexedTriangleMesh& from, const IndexedTriangleMesh& to) {
    const SurfaceLocator locator(to);
    const int n = 4;
    for (const auto& t : from.triangles)
      for (int i = 0; i <= n; ++i)
        for (int j = 0; i + j <= n; ++j) {
          const Vector3 p = (i * from.points[t[0]] + j * from.points[t[1]] + (n - i - j) * from.points[t[2]]) / n;
          largest = std::max(largest, locator.nearest(p).distance);
        }
  };
  measure(flat, surface);
  measure(surface, flat);
  return largest / bounding_box(surface.points).diagonal().norm();
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

TEST_CASE("thin regions and sharp corners become quadrilaterals") {
  const auto mesh = [](const PlanarOutline& outline, int characteristic) {
    const QuadMeshing result = mesh_planar(outline, ConstantSize{0.2}, LemonMatcher{});
    check_kept(result, surface_of(outline), characteristic);
    CHECK(quality_of(result.mesh).least > 1e-4);  // a corner of 0.005 rad allows no more than 0.005
  };
  for (const double thickness : {0.5, 0.2, 0.1, 0.05, 0.02, 0.01}) {
    CAPTURE(thickness);
    PlanarOutline ring = disc(), excentric = disc();
    add_loop(ring, circle({0, 0}, 1 - thickness, 128));
    add_loop(excentric, circle({0.7 - thickness, 0}, 0.3, 128));
    mesh(ring, 0);
    mesh(excentric, 0);
    mesh(one_loop(rectangle(2, thickness)), 1);
    mesh(one_loop({{0, 0}, {2, -thickness}, {2, thickness}}), 1);
    mesh(one_loop({{0, 0}, {1, -thickness}, {2, 0}, {1, thickness}}), 1);
    mesh(one_loop({{0, 0}, {2, 0}, {0.3, thickness}}), 1);
  }
}

TEST_CASE("where convex quadrilaterals do not fit, triangles are left and counted") {
  const auto wedge_before_square = [](double h) {
    return one_loop({{0, 0}, {2, -2 * h}, {2, -1}, {4, -1}, {4, 1}, {2, 1}, {2, 2 * h}});
  };
  CHECK_THROWS_AS(mesh_planar(wedge_before_square(5e-9), ConstantSize{0.3}, LemonMatcher{}), invalid_outline);
  for (const auto scope : {QuadImprovementScope::everywhere, QuadImprovementScope::folded})
    for (const double angle : {1e-3, 1e-6}) {  // rad
      CAPTURE(angle);
      const double h = std::tan(angle / 2);
      const PlanarOutline outline = wedge_before_square(h);
      const QuadMeshing result =
          mesh_planar(outline, ConstantSize{0.3}, LemonMatcher{}, {.improvement = {.scope = scope}});
      const QuadMesh& mesh = result.mesh;
      CHECK(result.statistics.n_left_triangles == mesh.n_triangles());
      CHECK(result.statistics.n_left_triangles > 0);
      CHECK(2 * mesh.n_triangles() < mesh.cells.size());
      CHECK(topology_fault(mesh) == std::nullopt);
      CHECK(euler_characteristic(mesh) == 1);
      double covered = 0;
      for (const auto& cell : mesh.cells) {
        const std::size_t n = QuadMesh::n_corners(cell);
        for (std::size_t i = 0; i < n; ++i) {  // exactly convex, all the way round
          const auto at = [&](std::size_t k) -> const Vector3& { return mesh.points[cell[(i + k) % n]]; };
          REQUIRE(projected_orientation(2, at(0), at(1), at(2)) > 0);
          const Vector3 &p = mesh.points[cell[i]], &q = mesh.points[cell[(i + 1) % n]];
          covered += (p.x() * q.y() - p.y() * q.x()) / 2;
        }
      }
      CHECK(covered == Approx(4 + 4 * h));
    }
}

TEST_CASE("without improvement: a mesh all the same, moved only where cells would be folded") {
  const QuadMeshingOptions without{.improvement = {.scope = QuadImprovementScope::folded}};
  for (const auto& [outline, characteristic] :
       {std::pair{disc(), 1}, {annulus(), 0}, {ell(), 1}, {plate_with_holes(), -2}, {gear(), 0}}) {
    const QuadMeshing result = mesh_planar(outline, ConstantSize{0.1}, LemonMatcher{}, without);
    check_kept(result, surface_of(outline), characteristic);
  }
  // A mesh without folded cells keeps all its points and cells.
  std::mt19937_64 engine(6);
  const Surface surface(flat_delaunay(random_flat_points(40, engine)));
  const QuadMesh raw = quadrangulate(surface, LemonMatcher{}).mesh;
  const FeatureCarriers carriers(surface);
  const QuadMesh unfolded = improve_quads(raw, carriers, without.improvement).mesh;
  const QuadImprovement again = improve_quads(unfolded, carriers, without.improvement);
  REQUIRE(again.folded.empty());
  CHECK(again.n_changes == 0);
  CHECK(again.mesh.cells == unfolded.cells);
  REQUIRE(again.mesh.points.size() == unfolded.points.size());
  for (std::size_t v = 0; v < unfolded.points.size(); ++v)
    CHECK((again.mesh.points[v] - unfolded.points[v]).norm() < 1e-12);
}

TEST_CASE("random outlines: all that a result has to be") {
  std::mt19937_64 engine(15);
  const auto uniform = [&](double low, double high) {
    return boost::random::uniform_real_distribution<double>(low, high)(engine);
  };
  for (int i = 0; i < 40; ++i) {
    CAPTURE(i);
    const int n = 4 + static_cast<int>(engine() % 12);
    std::vector<Vector2> star;
    const double bend = uniform(0, 0.3);
    for (int k = 0; k < n; ++k) {
      const double radius = uniform(0.6, 1);
      for (const double part : {0.0, 0.25, 0.5, 0.75}) {  // sides are curved, or broken at their middle
        const double angle = 2 * std::numbers::pi * (k + part) / n, r = radius + bend * part * (1 - part);
        star.emplace_back(r * std::cos(angle), r * std::sin(angle));
      }
    }
    PlanarOutline outline = one_loop(star);
    const bool has_hole = engine() % 2 == 0;
    if (has_hole) add_loop(outline, circle({uniform(-0.1, 0.1), uniform(-0.1, 0.1)}, uniform(0.1, 0.3), 64));
    const QuadMeshing result = mesh_planar(outline, ConstantSize{uniform(0.06, 0.25)}, LemonMatcher{});
    check_kept(result, surface_of(outline), has_hole ? 0 : 1);
  }
}

TEST_CASE("an odd number of intervals: the longest side of a triangle has one more, and is named") {
  std::mt19937_64 engine(77);
  const auto coordinate = [&] { return boost::random::uniform_real_distribution<double>(0, 4)(engine); };
  int n_odd = 0;
  for (int i = 0; i < 1000 && n_odd < 25; ++i) {
    std::array<Vector2, 3> p;
    for (Vector2& q : p) {
      const double x = coordinate(), y = coordinate();
      q = {x, y};
    }
    const double size = 0.4;
    std::array<double, 3> length{};
    std::array<long, 3> wanted{};
    bool clear = true;
    for (std::size_t k = 0; k < 3; ++k) {
      length[k] = (p[(k + 1) % 3] - p[k]).norm();
      wanted[k] = std::lround(length[k] / size);
      clear = clear && std::abs(length[k] / size - static_cast<double>(wanted[k])) < 0.4 && wanted[k] > 1;
    }
    const Vector2 x = p[1] - p[0], y = p[2] - p[0];
    clear = clear && std::abs(x.x() * y.y() - x.y() * y.x()) > 0.4 * length[0] * length[2];
    for (std::size_t k = 0; k < 3; ++k)  // a blunt corner would be none
      clear = clear && (p[(k + 1) % 3] - p[k]).dot(p[(k + 2) % 3] - p[k]) > 0;
    if (!clear) continue;
    const bool odd = (wanted[0] + wanted[1] + wanted[2]) % 2 == 1;
    n_odd += odd;
    if (odd) ++wanted[static_cast<std::size_t>(std::max_element(length.begin(), length.end()) - length.begin())];
    const QuadMeshing result = mesh_planar(one_loop({p[0], p[1], p[2]}), ConstantSize{size}, LemonMatcher{});
    CHECK(result.statistics.lengthened_curves.size() == (odd ? 1 : 0));
    CHECK(result.statistics.n_split_edges == 0);
    std::array<long, 3> found{};
    std::set<index_t> label_of_longest;
    for (const LabelledEdge& edge : result.mesh.edges) {
      const Vector3 middle3 = (result.mesh.points[edge.vertices[0]] + result.mesh.points[edge.vertices[1]]) / 2;
      const Vector2 middle = middle3.head<2>();
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector2 side = p[(k + 1) % 3] - p[k], to = middle - p[k];
        if (std::abs(side.x() * to.y() - side.y() * to.x()) > 1e-6) continue;
        ++found[k];
        if (length[k] == *std::max_element(length.begin(), length.end())) label_of_longest.insert(edge.label);
      }
    }
    CHECK(found == wanted);
    REQUIRE(label_of_longest.size() == 1);
    if (odd) CHECK(result.statistics.lengthened_curves[0] == *label_of_longest.begin());
  }
  CHECK(n_odd == 25);
}

TEST_CASE("shells: open and closed surfaces") {
  const IndexedTriangleMesh dome = read_ply(FRAMEHEX_TEST_DATA "/dome.ply"),
                            bunny = read_stl(FRAMEHEX_TEST_DATA "/bunny.stl");
  for (const auto& [surface, size, mean] : {std::tuple{dome, 0.2, 0.9}, {bunny, 0.3, 0.85}}) {
    const QuadMeshing result = mesh_shell(surface, ConstantSize{size}, LemonMatcher{});
    check_result(result, Surface(surface), 2, mean);
    CHECK(deviation(result.mesh, surface) < 0.01);
  }
  // Half of a torus: a tube with two rims.
  IndexedTriangleMesh tube = torus_surface(2, 0.7, 48, 24);
  std::erase_if(tube.triangles, [&](const auto& t) {
    return tube.points[t[0]].y() + tube.points[t[1]].y() + tube.points[t[2]].y() < 0;
  });
  check_result(mesh_shell(tube, ConstantSize{0.2}, LemonMatcher{}), Surface(tube), 0, 0.9);
}

TEST_CASE("a shell of coarse cells is within one hundredth of the diagonal too") {
  const IndexedTriangleMesh bunny = read_stl(FRAMEHEX_TEST_DATA "/bunny.stl");
  for (const double size : {0.52, 1.04, 2.0}) {
    CAPTURE(size);
    const QuadMeshing result = mesh_shell(bunny, ConstantSize{size}, LemonMatcher{});
    check_result(result, Surface(bunny), 2, 0.85);
    CHECK(result.statistics.deviation < 0.01);
    CHECK(deviation(result.mesh, bunny) < 0.01);
  }
}

TEST_CASE(
    "shells stay within one hundredth of the diagonal of a sphere, half a sphere and a torus, whatever the size") {
  // Against the surfaces themselves, of which the input is a fine triangulation.
  const auto check_near = [](const IndexedTriangleMesh& surface, double size, int characteristic, auto&& distance) {
    CAPTURE(size, characteristic);
    const QuadMeshing result = mesh_shell(surface, ConstantSize{size}, LemonMatcher{});
    check_result(result, Surface(surface), characteristic, 0.9);
    const double diagonal = bounding_box(surface.points).diagonal().norm();
    double largest = 0;
    for (const auto& c : result.mesh.cells)
      for (int i = 0; i <= 6; ++i)
        for (int j = 0; j <= 6; ++j) {  // of the bilinear patch
          const double u = i / 6.0, v = j / 6.0;
          const auto& p = result.mesh.points;
          const Vector3 x =
              (1 - u) * (1 - v) * p[c[0]] + u * (1 - v) * p[c[1]] + u * v * p[c[2]] + (1 - u) * v * p[c[3]];
          largest = std::max(largest, std::abs(distance(x)) / diagonal);
        }
    CHECK(largest < 0.01);
    CHECK(result.statistics.deviation <= 0.0101);
    CHECK(result.statistics.deviation > 0.5 * largest);
  };
  const auto to_sphere = [](const Vector3& p) { return p.norm() - 1; };
  const IndexedTriangleMesh sphere = sphere_surface(1, 5);
  IndexedTriangleMesh half;  // by latitudes
  const index_t n = 96, rings = 24;
  half.points.emplace_back(0, 0, 1);
  for (index_t j = 1; j <= rings; ++j)
    for (index_t i = 0; i < n; ++i) {
      const double a = 2 * std::numbers::pi * i / n, b = std::numbers::pi / 2 * j / rings;
      half.points.emplace_back(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b));
    }
  for (index_t i = 0; i < n; ++i) {
    half.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
    for (index_t j = 0; j + 1 < rings; ++j) {
      const index_t a = 1 + j * n + i, b = 1 + j * n + (i + 1) % n;
      half.triangles.push_back({a, a + n, b + n});
      half.triangles.push_back({a, b + n, b});
    }
  }
  for (const double size : {0.2, 0.4, 1.0}) {
    check_near(sphere, size, 2, to_sphere);
    check_near(half, size, 1, to_sphere);
  }
  for (const double size : {0.2, 0.8})
    check_near(torus_surface(2, 0.7, 160, 60), size, 0,
               [](const Vector3& p) { return std::hypot(std::hypot(p.x(), p.y()) - 2, p.z()) - 0.7; });
}

TEST_CASE("shells: bad input is refused by name, and work can be cancelled") {
  const IndexedTriangleMesh strip = moebius_strip(6);
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
