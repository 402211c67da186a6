// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "support/insertion_fixtures.hpp"
#include "support/stl.hpp"

#include <catch2/catch.hpp>

using namespace framehex;
using namespace framehex::test;

TEST_CASE("hexahedra of a graded bunny follow the size field") {
  const IndexedTriangleMesh surface = read_stl(FRAMEHEX_TEST_DATA "/bunny.stl");
  // 0.6 for the body, 0.3 at the tips of the ears.
  const auto size = [](const Vector3& p) { return 0.6 - 0.3 * std::clamp((p.y() - 6) / 3, 0.0, 1.0); };
  const PointOrder order = GENERATE(PointOrder::smoothness, PointOrder::lattice);
  const MeshingResult result =
      mesh_surface(surface, size, TetgenProcess{},
                   {.field = {.method = FieldMethod::smoothed}, .order = order, .background_edge = 0.8});
  CHECK(result.statistics.order == order);
  const MixedMesh& mesh = result.recombination.mesh;

  std::vector<double> ratios, fine;
  for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
    if (mesh.kinds[c] != CellKind::hexahedron) continue;
    const auto corners = mesh.cells[c];
    Vector3 centre = Vector3::Zero();
    for (const index_t v : corners) centre += mesh.points[v] / 8;
    double length = 0;
    const auto at = [&](std::int8_t corner) { return mesh.points[corners[static_cast<std::size_t>(corner)]]; };
    for (const auto& [a, b] : edges_of(CellKind::hexahedron)) length += (at(a) - at(b)).norm() / 12;
    ratios.push_back(length / size(centre));
    if (size(centre) < 0.45) fine.push_back(ratios.back());
  }
  REQUIRE(ratios.size() > 300);
  CHECK(median(ratios) == Approx(1).margin(0.1));
  REQUIRE(fine.size() > 5);
  // A lattice's steps are as long as its bound lets them be.
  const double margin = order == PointOrder::lattice ? AxisScaleOptions{}.longest - 1 : 0.15;
  CHECK(median(fine) == Approx(1).margin(margin));
}
