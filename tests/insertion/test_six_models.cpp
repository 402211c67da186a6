// SPDX-License-Identifier: BSL-1.0
//
// All stages up to the second tetrahedral mesh on six models: a dome, a wing, a bracket with bores, a body with fins, a
// blade with cavities, a scanned bunny. The .ply files are coarse boundary triangulations of the larger models; that of
// the bracket is so coarse that the rim of a bore is no feature of it.
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/field/compute_frame_field.hpp"
#include "framehex/insertion/rtree_filter.hpp"
#include "framehex/surface/refinement.hpp"
#include "framehex/surface/retriangulation.hpp"
#include "framehex/tetrahedralization/background.hpp"
#include "support/insertion_fixtures.hpp"
#include "support/ply.hpp"
#include "support/stl.hpp"

#include <catch2/catch.hpp>

#include <set>

using namespace framehex;
using namespace framehex::test;

namespace {

struct Model {
  const char* file;
  double h;
};

IndexedTriangleMesh read(const Model& model) {
  const std::string path = std::string(FRAMEHEX_TEST_DATA "/") + model.file;
  return path.ends_with(".stl") ? read_stl(path) : read_ply(path);
}

/// Corners from the smallest on: the same for the same oriented triangle.
std::array<index_t, 3> canonical(std::array<index_t, 3> t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

double diagonal(const IndexedTriangleMesh& surface) {
  Vector3 low = surface.points.front(), high = low;
  for (const Vector3& p : surface.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).norm();
}

/// Largest distance of the vertices and triangle centres of one surface from another.
template <TriangleMesh M, TriangleMesh N>
double deviation(const M& mesh, const N& to) {
  const auto& from = detail::flat(mesh);
  const SurfaceLocator locator(to);
  double most = 0;
  for (const Vector3& p : from.points) most = std::max(most, locator.nearest(p).distance);
  for (const auto& t : from.triangles)
    most = std::max(most, locator.nearest((from.points[t[0]] + from.points[t[1]] + from.points[t[2]]) / 3).distance);
  return most;
}

double distance_to_polyline(const Vector3& p, std::span<const index_t> row, std::span<const Vector3> points) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < row.size(); ++i) {
    const Vector3 &a = points[row[i]], ab = points[row[i + 1]] - a;
    const double s = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (p - a - s * ab).norm());
  }
  return least;
}

std::set<std::array<index_t, 3>> boundary_of(const IndexedTetMesh& mesh) {
  std::set<std::array<index_t, 3>> open;
  constexpr int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  for (const auto& tet : mesh.tets)
    for (const auto& f : faces) {
      const auto corner = [&](int i) { return tet[static_cast<std::size_t>(f[i])]; };
      // A face is inner when it came before with the other orientation.
      if (open.erase(canonical({corner(0), corner(2), corner(1)})) == 0)
        open.insert(canonical({corner(0), corner(1), corner(2)}));
    }
  return open;
}

/// The rule, through an index that the insertion did not use: a new point is `k` sizes from every earlier one in the
/// infinity norm of its frame.
void check_distances(const VolumeInsertion& volume, double k, double h) {
  RTreeFilter index(h);
  for (const Vector3& p : volume.points) index.insert(p, h);
  for (std::size_t i = volume.n_seeds; i < volume.points.size(); ++i)
    for_each_near(index, volume.points[i], volume.frames[i].toRotationMatrix(), k * volume.sizes[i] * (1 - 1e-12),
                  [&](index_t j, const Vector3&, double distance) {
                    if (j < i) FAIL("points " << i << " and " << j << " at " << distance / volume.sizes[i]);
                  });
}

}  // namespace

TEST_CASE("on six models the second mesh has every sample and point as a vertex, and the surface, and no more") {
  const Model model = GENERATE(Model{"dome.ply", 0.2}, Model{"naca.ply", 0.045}, Model{"piece.ply", 0.108},
                               Model{"fuselage.ply", 0.2}, Model{"blade.ply", 0.03}, Model{"bunny.stl", 0.26});
  INFO(model.file);
  const IndexedTriangleMesh input = read(model);
  const auto size = [&](const Vector3&) { return model.h; };
  const double edge = 1.5 * model.h;
  const RefinedSurface refined = refine(input, [&](const Vector3&) { return edge; });
  const Surface& surface = refined.surface;
  const IndexedTetMesh background =
      tetrahedralize(TetgenProcess{}, surface, background_points(surface, SurfaceLocator(surface), edge)).mesh;
  const SurfaceCrossField cross = compute_cross_field(surface);
  const auto field = compute_frame_field(background, surface, cross.frames, {.method = FieldMethod::smoothed});

  const CurveInsertion curves = insert_curve_points(surface, size);
  const SurfaceInsertion samples = insert_surface_points(surface, cross.frames, cross.smoothness, curves, size);
  for (const SurfaceSample& sample : curves.samples)
    if (sample.kind == SampleKind::curve)
      REQUIRE(distance_to_polyline(sample.point, surface.features.curves[sample.entity], surface.points) <
              1e-9 * model.h);
  const Retriangulation boundary = retriangulate(surface, samples.samples);
  CHECK(boundary.n_unremoved == 0);
  CHECK(200 * boundary.n_added <= samples.samples.size());
  CHECK(boundary.crossings.empty());
  CHECK(deviation(boundary.surface, input) < 0.01 * diagonal(input));
  CHECK(deviation(input, boundary.surface) < 0.01 * diagonal(input));

  const SurfaceLocator locator(boundary.surface);
  const VolumeInsertion volume = insert_volume_points(samples.seeds(), field, size, SurfaceDomain{locator});
  check_distances(volume, SmoothnessOrder::default_rejection, model.h);
  const std::vector<Vector3> interior(volume.points.begin() + static_cast<std::ptrdiff_t>(volume.n_seeds),
                                      volume.points.end());
  const IndexedTetMesh mesh = tetrahedralize(TetgenProcess{}, boundary.surface, interior).mesh;

  const std::size_t n_samples = samples.samples.size(), n_surface = boundary.surface.points.size();
  CHECK(n_surface == n_samples + boundary.n_unremoved + boundary.n_added);
  REQUIRE(mesh.points.size() == n_surface + interior.size());
  for (std::size_t i = 0; i < n_samples; ++i) REQUIRE(mesh.points[i] == samples.samples[i].point);
  for (std::size_t i = 0; i < interior.size(); ++i) REQUIRE(mesh.points[n_surface + i] == interior[i]);
  std::vector<char> used(mesh.points.size(), 0);
  for (const auto& tet : mesh.tets)
    for (const index_t v : tet) used[v] = 1;
  CHECK(std::count(used.begin(), used.end(), 0) == 0);
  std::set<std::array<index_t, 3>> triangles;
  for (const auto& t : boundary.surface.triangles()) triangles.insert(canonical(t));
  CHECK(boundary_of(mesh) == triangles);

  std::vector<double> lengths;
  for (std::size_t i = volume.n_seeds; i < volume.points.size(); ++i)
    for (const index_t q : volume.links[i])
      if (q != no_index) lengths.push_back((volume.points[q] - volume.points[i]).norm() / model.h);
  REQUIRE(!lengths.empty());
  CHECK(median(lengths) == Approx(1).margin(0.03));
}
