// SPDX-License-Identifier: BSL-1.0
#include <catch2/catch.hpp>

#include "framehex/verify/kept_boundary.hpp"
#include "framehex/verify/validity.hpp"
#include "support/kuhn_lattice.hpp"

using namespace framehex;

namespace {

void add(MixedMesh& mesh, CellKind kind, std::initializer_list<index_t> corners) {
  mesh.add(kind, {corners.begin(), corners.size()});
}

/// The unit cube with hexahedron 0 1 2 3 4 5 6 7, and room above.
MixedMesh cube() {
  MixedMesh mesh;
  for (const double z : {0.0, 1.0})
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}})
      mesh.points.emplace_back(x, y, z);
  add(mesh, CellKind::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7});
  return mesh;
}

}  // namespace

TEST_CASE("a cube conforms", "[verify]") {
  const MixedMesh mesh = cube();
  const auto report = verify::is_conforming(mesh);
  CHECK(report);
  CHECK(report.cells().empty());
  CHECK(verify::is_valid(mesh));
  const auto volume = verify::volume(mesh);
  CHECK(volume.cells == 1);
  CHECK(volume.boundary == 1);
  CHECK(volume.by_kind[3] == 1);
}

TEST_CASE("a pyramid on a cube conforms, two tetrahedra do not", "[verify]") {
  MixedMesh mesh = cube();
  mesh.points.emplace_back(0.5, 0.5, 1.5);
  SECTION("pyramid") {
    add(mesh, CellKind::pyramid, {4, 5, 6, 7, 8});
    CHECK(verify::is_conforming(mesh));
    CHECK(verify::is_valid(mesh));
    CHECK(verify::volume(mesh).cells == Approx(1 + 1.0 / 6));
    CHECK(verify::volume(mesh).relative_difference() < 1e-14);
  }
  SECTION("tetrahedra") {
    add(mesh, CellKind::tetrahedron, {4, 5, 6, 8});
    add(mesh, CellKind::tetrahedron, {4, 6, 7, 8});
    const auto report = verify::is_conforming(mesh);
    CHECK_FALSE(report.conforming());
    CHECK(report.closed());
    CHECK(report.open_quadrilaterals.size() == 1);
    CHECK(report.open_triangles.size() == 2);
    CHECK(report.cells() == std::vector<index_t>{0, 1, 2});
  }
  SECTION("one tetrahedron") {
    add(mesh, CellKind::tetrahedron, {4, 5, 6, 8});
    const auto report = verify::is_conforming(mesh);
    CHECK_FALSE(report);
    CHECK(report.open_quadrilaterals.size() == 1);
    CHECK(report.open_triangles.size() == 1);
    CHECK(report.cells() == std::vector<index_t>{0, 1});
  }
}

TEST_CASE("two tetrahedra cover a quadrilateral however it is bent", "[verify]") {
  for (const double height : {0.0, 1.0, 2.6, 10.0, 1000.0}) {
    MixedMesh mesh = cube();
    mesh.points[6].z() = 1 + height;  // a half turns by 60 degrees from the mean normal at the square root of 6
    mesh.points.emplace_back(-1, -1, 4);
    add(mesh, CellKind::tetrahedron, {4, 5, 7, 8});
    add(mesh, CellKind::tetrahedron, {5, 6, 7, 8});
    CHECK(verify::volume(mesh).inverted_cells.empty());
    const auto report = verify::is_conforming(mesh);
    CHECK(report.open_quadrilaterals.size() == 1);
    CHECK(report.open_triangles.size() == 2);
    CHECK(report.closed());
  }
}

TEST_CASE("faces that do not fit are found", "[verify]") {
  MixedMesh mesh = cube();
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}})
    mesh.points.emplace_back(x, y, 2.0);
  SECTION("two cubes") {
    add(mesh, CellKind::hexahedron, {4, 5, 6, 7, 8, 9, 10, 11});
    CHECK(verify::is_conforming(mesh));
  }
  SECTION("the same cube twice") {
    add(mesh, CellKind::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7});
    const auto report = verify::is_conforming(mesh);
    CHECK(report.same_side.size() == 12);
    CHECK(report.cells() == std::vector<index_t>{0, 1});
  }
  SECTION("three times") {
    add(mesh, CellKind::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7});
    add(mesh, CellKind::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7});
    CHECK(verify::is_conforming(mesh).used_over_twice.size() == 18);
  }
  SECTION("twisted") {
    add(mesh, CellKind::hexahedron, {4, 6, 5, 7, 8, 10, 9, 11});
    const auto report = verify::is_conforming(mesh);
    CHECK(report.twisted.size() == 2);
    CHECK(report.cells() == std::vector<index_t>{0, 1});
  }
  SECTION("three common vertices") {
    mesh.points.emplace_back(0.0, 1.0, 1.0);
    add(mesh, CellKind::hexahedron, {4, 5, 6, 12, 8, 9, 10, 11});
    const auto report = verify::is_conforming(mesh);
    CHECK(report.three_vertices_shared.size() == 2);
    CHECK_FALSE(report.conforming());
  }
  SECTION("cubes that touch along an edge have a closed boundary") {
    mesh.points = {};
    for (const double z : {0.0, 1.0})
      for (const double y : {0.0, 1.0, 2.0})
        for (const double x : {0.0, 1.0, 2.0}) mesh.points.emplace_back(x, y, z);
    mesh.kinds.clear();
    mesh.cells = {};
    add(mesh, CellKind::hexahedron, {0, 1, 4, 3, 9, 10, 13, 12});
    add(mesh, CellKind::hexahedron, {4, 5, 8, 7, 13, 14, 17, 16});
    const auto report = verify::is_conforming(mesh);
    CHECK(report.conforming());
    CHECK(report.closed());
    CHECK(report.nonmanifold_edges == std::vector<std::array<index_t, 2>>{{4, 13}});
  }
}

TEST_CASE("malformed cells are reported and nothing else breaks", "[verify]") {
  MixedMesh mesh = cube();
  add(mesh, CellKind::tetrahedron, {4, 5, 6, 99});
  add(mesh, CellKind::tetrahedron, {4, 5, 6, 4});
  mesh.kinds.push_back(CellKind::hexahedron);
  mesh.cells.values.push_back(1);
  mesh.cells.end_row();
  const auto report = verify::is_conforming(mesh);
  CHECK(report.malformed_cells == std::vector<index_t>{1, 2, 3});
  CHECK(report.open_quadrilaterals.empty());
  CHECK(verify::is_valid(mesh).malformed_cells == std::vector<index_t>{1, 2, 3});
  CHECK_FALSE(verify::is_conforming(mesh));
}

TEST_CASE("cells that are not valid are named", "[verify]") {
  MixedMesh mesh = cube();
  SECTION("inside out") {
    mesh.points.emplace_back(0.5, 0.5, 0.5);
    add(mesh, CellKind::pyramid, {4, 5, 6, 7, 8});
    CHECK(verify::is_valid(mesh).invalid_cells == std::vector<index_t>{1});
    CHECK(verify::volume(mesh).inverted_cells == std::vector<index_t>{1});
  }
  SECTION("flat") {
    mesh.points.emplace_back(0.5, 0.5, 1);
    add(mesh, CellKind::tetrahedron, {4, 5, 6, 8});
    CHECK(verify::is_valid(mesh).invalid_cells == std::vector<index_t>{1});
  }
  SECTION("not a number") {
    mesh.points[3].x() = std::nan("");
    CHECK(verify::is_valid(mesh).malformed_cells == std::vector<index_t>{0});
  }
}

TEST_CASE("nothing is a mesh too", "[verify]") {
  CHECK(verify::is_conforming({}));
  CHECK(verify::is_valid({}));
  CHECK(verify::volume({}).relative_difference() == 0);
}

TEST_CASE("a boundary of quadrilaterals is that of the triangles whichever way they are cut", "[verify]") {
  const IndexedTetMesh tets = test::kuhn_lattice(1);
  const TetAdjacency adjacency = make_adjacency(tets);
  MixedMesh mesh;
  mesh.points = tets.points;
  std::vector<index_t> same(8);
  for (index_t v = 0; v < 8; ++v) same[v] = v;
  add(mesh, CellKind::hexahedron, {0, 1, 3, 2, 4, 5, 7, 6});
  CHECK(verify::keeps_boundary(mesh, same, adjacency));
  MixedMesh split;
  split.points = tets.points;
  for (const auto& t : tets.tets) split.add(CellKind::tetrahedron, t);
  CHECK(verify::keeps_boundary(split, same, adjacency));

  MixedMesh hole;
  hole.points = tets.points;
  for (std::size_t t = 1; t < tets.tets.size(); ++t) hole.add(CellKind::tetrahedron, tets.tets[t]);
  const auto report = verify::keeps_boundary(hole, same, adjacency);
  CHECK_FALSE(report);
  CHECK(report.strange.size() == 2);
  CHECK(report.missing.size() == 2);

  same[3] = no_index;
  const auto renamed = verify::keeps_boundary(mesh, same, adjacency);
  CHECK(renamed.strange.size() == 3);
  CHECK(renamed.missing.size() == 6);
}
