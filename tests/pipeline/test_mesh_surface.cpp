// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "framehex/verify/boundary_deviation.hpp"
#include "framehex/verify/conformity.hpp"
#include "framehex/verify/validity.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/ply.hpp"
#include "support/stl.hpp"
#include "support/surfaces.hpp"

#include <catch2/catch.hpp>

#include <set>

using namespace framehex;

namespace {

/// A box of a x b x c as few triangles, turned about an odd axis.
IndexedTriangleMesh box(const Vector3& sides, double turn) {
  const IndexedTetMesh cell = test::kuhn_lattice(1);
  IndexedTriangleMesh surface = extract_boundary(cell, make_adjacency(cell)).surface;
  const Eigen::AngleAxisd rotation(turn, Vector3(1, 2, -0.5).normalized());
  for (Vector3& p : surface.points) p = rotation * Vector3(p.cwiseProduct(sides));
  return surface;
}

struct Constant {
  double value;
  double operator()(const Vector3&) const { return value; }
};

std::size_t n_of(const MixedMesh& mesh, CellKind kind) {
  return static_cast<std::size_t>(std::count(mesh.kinds.begin(), mesh.kinds.end(), kind));
}

}  // namespace

TEST_CASE("a box at a size that divides its sides is all hexahedra, however it is turned, in every variant") {
  const auto turn = GENERATE(0.0, 0.7);
  const auto order = GENERATE(PointOrder::fifo, PointOrder::smoothness);
  const auto method = GENERATE(FieldMethod::nearest, FieldMethod::smoothed, FieldMethod::best);
  MeshingOptions options;
  options.order = order;
  options.field.method = method;
  const MeshingResult result = mesh_surface(box({4, 3, 2}, turn), Constant{0.5}, TetgenProcess{}, options);
  const MixedMesh& mesh = result.recombination.mesh;
  CHECK(mesh.n_cells() == 8 * 6 * 4);
  CHECK(n_of(mesh, CellKind::hexahedron) == 8 * 6 * 4);
  CHECK(mesh.points.size() == 9 * 7 * 5);
  CHECK(result.recombination.assembly.n_open_quadrilaterals == 0);
  CHECK(result.statistics.n_patches == 6);
  CHECK(result.statistics.n_feature_curves == 12);
  CHECK(result.frames.size() == mesh.points.size());
}

TEST_CASE("the result is the same for any number of threads, and for a second run") {
  const IndexedTriangleMesh surface = box({3, 2.2, 1.7}, 0.3);
  const auto run = [&](const auto& executor) {
    return mesh_surface(surface, Constant{0.4}, TetgenProcess{}, MeshingOptions{}, executor).recombination.mesh;
  };
  const MixedMesh once = run(SerialExecutor{});
  for (const std::size_t threads : {std::size_t{1}, std::size_t{2}, std::size_t{5}}) {
    const MixedMesh again = run(ThreadExecutor(threads));
    CHECK(again.points == once.points);
    CHECK(again.kinds == once.kinds);
    CHECK(again.cells.values == once.cells.values);
  }
}

TEST_CASE("boundary vertices may slide, and the mesh fills the surface to its corners as without") {
  const Vector3 sides(3, 2.2, 1.7);
  const IndexedTriangleMesh surface = box(sides, 0.3);
  const auto mesh_of = [&](bool slides) {
    MeshingOptions options;
    if (!slides) options.recombination.assembly.boundary_projection = [](index_t, Vector3&) { return false; };
    return mesh_surface(surface, Constant{0.4}, TetgenProcess{}, options).recombination.mesh;
  };
  const MixedMesh mesh = mesh_of(true), fixed = mesh_of(false);
  CHECK(verify::is_conforming(mesh));
  CHECK(verify::is_valid(mesh));
  CHECK(verify::volume(mesh).cells == Approx(sides.prod()).epsilon(1e-9));
  const auto deviation = verify::boundary_deviation(mesh, surface);
  CHECK(deviation.mesh_to_surface_max < 1e-9);
  CHECK(deviation.surface_to_mesh_max < 1e-9);
  CHECK(mesh.edges.size() == fixed.edges.size());
  CHECK(mesh.faces.size() == fixed.faces.size());
}

TEST_CASE("improvement slides boundary vertices of a curved body, and none leaves its surface") {
  const IndexedTriangleMesh surface = test::sphere_surface(1, 3);
  AssemblyOptions assembly{.hexahedron_target = 0.6};  // much to do
  const auto mesh_of = [&] {
    MeshingOptions options;
    options.recombination.assembly = assembly;
    return mesh_surface(surface, Constant{0.3}, TetgenProcess{}, options).recombination.mesh;
  };
  const auto boundary_points = [](const MixedMesh& mesh) {
    std::set<std::array<double, 3>> points;
    for (const LabelledFace& face : mesh.faces)
      for (const index_t v : face.vertices)
        if (v != no_index) points.insert({mesh.points[v].x(), mesh.points[v].y(), mesh.points[v].z()});
    return points;
  };
  const MixedMesh improved = mesh_of();
  assembly.boundary_projection = [](index_t, Vector3&) { return false; };
  const auto held = boundary_points(mesh_of());
  assembly.improvement = ImprovementMode::none;
  CHECK(boundary_points(mesh_of()) == held);

  const SurfaceLocator locator(surface);
  std::size_t n_moved = 0;
  for (const auto& p : boundary_points(improved)) {
    CHECK(locator.nearest(Vector3(p[0], p[1], p[2])).distance < 1e-9);
    n_moved += 1 - held.count(p);
  }
  CHECK(n_moved > 0);
  CHECK(verify::is_conforming(improved));
  CHECK(verify::is_valid(improved));
}

TEST_CASE("a job can be cancelled at any stage, and then leaves no mesh") {
  const IndexedTriangleMesh surface = box({3, 2, 2}, 0.3);
  std::size_t n_calls = 0;
  MeshingOptions options;
  options.observer = [&](const Progress&) { return ++n_calls, true; };
  CHECK(mesh_surface(surface, Constant{0.4}, TetgenProcess{}, options).status == Status::complete);
  REQUIRE(n_calls > 10);
  for (std::size_t stop = 1; stop < n_calls; stop += 1 + n_calls / 12) {
    std::size_t n = 0;
    options.observer = [&](const Progress&) { return ++n < stop; };
    const MeshingResult result = mesh_surface(surface, Constant{0.4}, TetgenProcess{}, options);
    CHECK(result.status == Status::cancelled);
    CHECK(result.recombination.mesh.n_cells() == 0);
    CHECK(n <= stop + 2);
  }
}

TEST_CASE("bad sizes are refused before any work") {
  const IndexedTriangleMesh surface = box({1, 1, 1}, 0);
  for (const double size : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    CHECK_THROWS_AS(mesh_surface(surface, Constant{size}, TetgenProcess{}), error);
  CHECK_THROWS_AS(mesh_surface(surface, Constant{1e-6}, TetgenProcess{}), invalid_option);
}

TEST_CASE("points in smoothness order make more hexahedra than first in, first out") {
  const auto [surface, size] = GENERATE(std::pair(test::read_ply(FRAMEHEX_TEST_DATA "/dome.ply"), 0.156),
                                        std::pair(test::read_stl(FRAMEHEX_TEST_DATA "/bunny.stl"), 0.26));
  const auto hexahedra_by_volume = [&, &surface = surface, &size = size](PointOrder order) {
    MeshingOptions options;
    options.order = order;
    options.field.method = FieldMethod::smoothed;
    options.recombination.selection.method = SelectMethod::greedy;
    const MixedMesh mesh = mesh_surface(surface, Constant{size}, TetgenProcess{}, options).recombination.mesh;
    const verify::VolumeReport volume = verify::volume(mesh);
    return volume.by_kind[static_cast<std::size_t>(CellKind::hexahedron)] / volume.cells;
  };
  CHECK(hexahedra_by_volume(PointOrder::smoothness) > hexahedra_by_volume(PointOrder::fifo));
}
