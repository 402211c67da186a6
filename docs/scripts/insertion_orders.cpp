// SPDX-License-Identifier: BSL-1.0
//
// Samples of a planar domain in both orders, for docs/scripts/insertion_pictures.py: lines "p ORDER index x y" and
// "l ORDER x1 y1 x2 y2" for the lattice links. Build: g++ -std=c++20 -O2 -Iinclude -Itests -I/usr/include/eigen3.
#include "framehex/insertion/surface_inserter.hpp"
#include "framehex/surface/cross_field.hpp"
#include "framehex/surface/refinement.hpp"

#include "support/surfaces.hpp"

#include <cmath>
#include <cstdio>

using namespace framehex;

namespace {

template <class Order>
void print(const char* name, const RefinedSurface& refined, double h) {
  const SurfaceCrossField cross = compute_cross_field(refined.surface);
  const auto size = [h](const Vector3&) { return h; };
  const CurveInsertion curves = insert_curve_points(refined.surface, size);
  const SurfaceInsertion result =
      insert_surface_points<Order>(refined.surface, cross.frames, cross.smoothness, curves, size, {.rounds = 0});
  const auto on_top = [&](std::size_t i) { return result.samples[i].point.z() > 0.15; };
  for (std::size_t i = 0; i < result.samples.size(); ++i) {
    const Vector3& p = result.samples[i].point;
    if (!on_top(i)) continue;
    std::printf("p %s %zu %.9g %.9g\n", name, i < result.n_curve_samples ? 0 : i, p.x(), p.y());
    for (const index_t j : result.links[i])
      if (j != no_index && j > i && on_top(j))
        std::printf("l %s %.9g %.9g %.9g %.9g\n", name, p.x(), p.y(), result.samples[j].point.x(),
                    result.samples[j].point.y());
  }
}

}  // namespace

int main() {
  // A half disc on a slab: round above, straight below, so that the fronts do not fit together.
  std::vector<Eigen::Vector2d> outline{{0, -0.6}, {1.3, -0.6}, {1.3, 0}};
  for (int i = 0; i <= 60; ++i) {
    const double angle = 3.14159265358979 * i / 60;
    outline.emplace_back(std::cos(angle), std::sin(angle));
  }
  outline.emplace_back(-1.3, 0);
  outline.emplace_back(-1.3, -0.6);
  const IndexedTriangleMesh plate = test::extruded_polygon(outline, 0.16);
  const RefinedSurface refined = refine(plate, [](const Vector3&) { return 0.05; });
  print<FifoOrder>("fifo", refined, 0.06);
  print<SmoothnessOrder>("smoothness", refined, 0.06);
}
