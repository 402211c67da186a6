// SPDX-License-Identifier: BSL-1.0
#include <catch2/catch.hpp>

#include "framehex/mesh/boundary.hpp"
#include "framehex/verify/boundary_deviation.hpp"
#include "support/kuhn_lattice.hpp"

using namespace framehex;

TEST_CASE("the boundary of a cube lies on the cube", "[verify]") {
  const IndexedTetMesh lattice = test::kuhn_lattice(2);
  const IndexedTriangleMesh surface = extract_boundary(lattice, make_adjacency(lattice)).surface;
  MixedMesh mesh;
  for (const double z : {0.0, 2.0})
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}})
      mesh.points.emplace_back(x, y, z);
  const std::array<index_t, 8> corners{0, 1, 2, 3, 4, 5, 6, 7};
  mesh.add(CellKind::hexahedron, corners);
  SECTION("exactly") {
    const auto report = verify::boundary_deviation(mesh, surface, 1e-12);
    CHECK(report.mesh_to_surface_max < 1e-15);
    CHECK(report.surface_to_mesh_max < 1e-15);
    CHECK(report.diagonal == Approx(std::sqrt(12.0)));
    CHECK(report.cells().empty());
  }
  SECTION("but for one side that stands out") {
    for (std::size_t v = 4; v < 8; ++v) mesh.points[v].z() = 2.25;
    const auto report = verify::boundary_deviation(mesh, surface, 0.2);
    CHECK(report.mesh_to_surface_max == Approx(0.25));
    CHECK(report.surface_to_mesh_max == Approx(0.25));
    CHECK(report.faces.size() == 5);  // the side itself, and those that end at its corners
    CHECK(report.cells() == std::vector<index_t>{0});
  }
}
