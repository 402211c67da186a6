// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/field/compute_frame_field.hpp"
#include "framehex/insertion/background.hpp"
#include "support/insertion_fixtures.hpp"
#include "support/stl.hpp"

#include <catch2/catch.hpp>

using namespace framehex;
using namespace framehex::test;

TEST_CASE("sizes of a graded bunny follow their field") {
  const IndexedTriangleMesh surface = read_stl(FRAMEHEX_TEST_DATA "/bunny.stl");
  // 0.7 for the body, 0.35 at the tips of the ears.
  const auto size = [](const Vector3& p) { return 0.7 - 0.35 * std::clamp((p.y() - 6) / 3, 0.0, 1.0); };
  const TriangleAdjacency adjacency = make_adjacency(surface);
  const FeatureGraph features = detect_features(surface, adjacency);
  const SurfaceCrossField cross = compute_cross_field(surface, adjacency, features);
  const CurveInsertion curves = insert_curve_points(surface, features, size);
  const SurfaceInsertion samples =
      insert_surface_points(surface, adjacency, features, cross.frames, cross.smoothness, curves, size);
  const SurfaceLocator locator(surface);
  const IndexedTetMesh background =
      tetrahedralize(TetgenProcess{}, surface, background_points(surface, locator, 1)).mesh;
  const auto field =
      compute_frame_field(background, surface, features, cross.frames, {.method = FieldMethod::smoothed});
  const VolumeInsertion volume = insert_volume_points(samples.seeds(), field, size, SurfaceDomain{locator});

  std::vector<double> ratios, fine;
  for (index_t p = 0; p < volume.points.size(); ++p)
    for (const index_t q : volume.links[p]) {
      if (q == no_index || q < p) continue;
      const double h = size((volume.points[p] + volume.points[q]) / 2);
      ratios.push_back((volume.points[p] - volume.points[q]).norm() / h);
      if (h < 0.5) fine.push_back(ratios.back());
    }
  REQUIRE(!ratios.empty());
  CHECK(median(ratios) == Approx(1).margin(0.1));
  REQUIRE(fine.size() > 20);
  CHECK(median(fine) == Approx(1).margin(0.1));
}
