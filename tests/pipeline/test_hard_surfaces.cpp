// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/mesh/mixed_faces.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "framehex/surface/self_intersection.hpp"
#include "framehex/verify/conformity.hpp"
#include "framehex/verify/validity.hpp"
#include "support/hard_surfaces.hpp"

#include <catch2/catch.hpp>

#include <set>

using namespace framehex;

namespace {

double volume_of(const IndexedTriangleMesh& surface) {
  double six = 0;
  for (const auto& t : surface.triangles)
    six += surface.points[t[0]].dot(surface.points[t[1]].cross(surface.points[t[2]]));
  return six / 6;
}

/// Vertices less edges plus faces, which tells bodies apart that differ by a hole, a handle or a bridge.
long euler_characteristic(const auto& faces) {
  std::set<index_t> vertices;
  std::set<std::pair<index_t, index_t>> edges;
  for (const auto& face : faces)
    for (std::size_t i = 0; i < face.size(); ++i) {
      vertices.insert(face[i]);
      edges.insert(std::minmax(face[i], face[(i + 1) % face.size()]));
    }
  return std::ssize(vertices) - std::ssize(edges) + std::ssize(faces);
}

std::vector<std::vector<index_t>> boundary_faces(const MixedMesh& mesh) {
  std::vector<std::vector<index_t>> faces;
  for (const CellFace& face : faces_used_once(mesh))
    faces.emplace_back(face.vertices.begin(), face.vertices.begin() + static_cast<std::ptrdiff_t>(face.size()));
  return faces;
}

/// Meshes a surface at the size of which so many cubes have its volume, and looks at all that is promised.
MeshingResult mesh_and_check(const IndexedTriangleMesh& surface, double n_cells, const MeshingOptions& options = {}) {
  REQUIRE(find_self_intersections(surface).empty());
  const double size = std::cbrt(volume_of(surface) / n_cells);
  MeshingResult result = mesh_surface(surface, ConstantSize{size}, TetgenProcess{}, options);
  const MixedMesh& mesh = result.recombination.mesh;
  CHECK(verify::is_conforming(mesh));
  CHECK(verify::is_valid(mesh));
  CHECK(euler_characteristic(boundary_faces(mesh)) == euler_characteristic(surface.triangles));
  std::set<index_t> forced;
  for (const PoorCell& poor : result.poor_cells)
    if (poor.input_angle) forced.insert(poor.cell);
  std::array<Vector3, 8> corners;
  for (index_t cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto row = mesh.cells[cell];
    for (std::size_t i = 0; i < row.size(); ++i) corners[i] = mesh.points[row[i]];
    CAPTURE(cell, corners[0]);
    if (!forced.contains(cell)) CHECK(scaled_jacobian(mesh.kinds[cell], {corners.data(), row.size()}) >= 0.05);
  }
  return result;
}

}  // namespace

TEST_CASE("blades far thinner than the size are meshed", "[hard]") {
  const double twist = GENERATE(0.0, 0.1);
  mesh_and_check(test::rotor_surface(6, 0.02, twist, 4), 100);
}

TEST_CASE("walls between holes far thinner than the size are meshed", "[hard]") {
  const MeshingResult result = mesh_and_check(test::holed_ball(0.02), 300);
  CHECK(verify::volume(result.recombination.mesh).cells == Approx(volume_of(test::holed_ball(0.02))).epsilon(0.03));
}

TEST_CASE("ends of a bar that nearly meet stay apart", "[hard]") {
  mesh_and_check(test::horseshoe_surface(0.001, 48, 16), GENERATE(100, 300));
}

TEST_CASE("ledges narrower than the size are meshed", "[hard]") {
  mesh_and_check(test::ledged_surface(0.05, 3, 24), 300);
}

TEST_CASE("a coarse surface of long triangles is meshed", "[hard]") {
  mesh_and_check(test::needle_torus(0.02, 8, 8), GENERATE(100, 300));
}

TEST_CASE("a surface as rough as a scan is meshed, and its field has no loops that never go", "[hard]") {
  mesh_and_check(test::rough_torus(0.04, 60, 24), 300);
}

TEST_CASE("without pyramids, too, every quadrilateral faces one", "[hard][regression]") {
  MeshingOptions options;
  options.order = GENERATE(PointOrder::lattice, PointOrder::smoothness);
  options.recombination.assembly.interfaces = InterfaceMode::no_pyramids;
  const MeshingResult result = mesh_and_check(test::bumpy_ball(0.3), 400, options);
  for (const CellKind kind : result.recombination.mesh.kinds) CHECK(kind != CellKind::pyramid);
}

TEST_CASE("vertices that no triangle uses are left out", "[hard][regression]") {
  const IndexedTriangleMesh box = test::box_surface({2, 1, 1});
  IndexedTriangleMesh with = box;
  with.points.insert(with.points.begin() + 3, Vector3(70, 0, 0));
  with.points.emplace_back(0.5, 0.5, 0.5);
  for (auto& t : with.triangles)
    for (index_t& v : t) v += v >= 3 ? 1 : 0;
  MeshingOptions options;
  options.features.given_edges = {{with.triangles[0][0], with.triangles[0][1]}};
  const MixedMesh mesh = mesh_and_check(with, 16, options).recombination.mesh;
  options.features.given_edges = {{box.triangles[0][0], box.triangles[0][1]}};
  CHECK(mesh.points == mesh_and_check(box, 16, options).recombination.mesh.points);
}
