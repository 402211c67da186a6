// SPDX-License-Identifier: BSL-1.0
// The surface stages over their size: nearest points (our box tree and Boost's R-tree), inside test, feature detection,
// refinement, cross field, retriangulation, self-intersections. The fitted exponent is Google Benchmark's complexity.
#include <benchmark/benchmark.h>

#include "framehex/geometry/spatial_index.hpp"
#include "framehex/surface/cross_field.hpp"
#include "framehex/surface/feature_detection.hpp"
#include "framehex/surface/refinement.hpp"
#include "framehex/surface/retriangulation.hpp"
#include "framehex/surface/self_intersection.hpp"
#include "framehex/surface/surface_locator.hpp"
#include "support/surface_samples.hpp"
#include "support/surfaces.hpp"

using namespace framehex;

namespace {

/// A torus of about n triangles.
IndexedTriangleMesh torus(std::int64_t n) {
  const int around = static_cast<int>(std::sqrt(static_cast<double>(n)));
  return test::torus_surface(1, 0.4, around, around / 2);
}

std::vector<Vector3> points_near(const IndexedTriangleMesh& surface, double spread, std::size_t n) {
  std::mt19937_64 engine(1);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-52 - 1; };
  std::vector<Vector3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3& p = surface.points[engine() % surface.points.size()];
    const double x = uniform(), y = uniform(), z = uniform();
    points.emplace_back(p + spread * Vector3(x, y, z));
  }
  return points;
}

void nearest_point(benchmark::State& state) {
  const auto surface = torus(state.range(0));
  const SurfaceLocator locator(surface);
  const auto queries = points_near(surface, 0.1, 4096);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(locator.nearest(queries[i++ % queries.size()]));
}

void nearest_point_in_rtree(benchmark::State& state) {
  const auto surface = torus(state.range(0));
  std::vector<Box> boxes;
  for (const auto& t : surface.triangles) {
    const Vector3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
    boxes.push_back({a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)});
  }
  const BoxIndex index(boxes);
  const auto queries = points_near(surface, 0.1, 4096);
  std::size_t i = 0;
  for (auto _ : state) {
    const Vector3& q = queries[i++ % queries.size()];
    double best = 1e300;
    index.by_distance(q, [&](index_t t, double squared) {
      if (squared > best) return false;
      const auto& v = surface.triangles[t];
      const auto p = nearest_on_triangle(q, surface.points[v[0]], surface.points[v[1]], surface.points[v[2]]);
      best = std::min(best, p.squared_distance);
      return true;
    });
    benchmark::DoNotOptimize(best);
  }
}

void inside(benchmark::State& state) {
  const auto surface = torus(state.range(0));
  const SurfaceLocator locator(surface);
  const auto queries = points_near(surface, 0.1, 4096);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(locator.inside(queries[i++ % queries.size()]));
}

void features_of_cylinder(benchmark::State& state) {
  const auto surface = test::cylinder_surface(1, 1, static_cast<int>(state.range(0) / 4));
  for (auto _ : state) benchmark::DoNotOptimize(detect_features(surface));
  state.SetComplexityN(state.range(0));
}

void refine_cylinder(benchmark::State& state) {
  const Surface surface = test::cylinder_surface(0.5, 2, 64);
  const double length = 4 / std::sqrt(static_cast<double>(state.range(0)));
  std::size_t n = 0;
  for (auto _ : state) {
    const auto fine = refine(surface, [&](const Vector3&) { return length; });
    n = fine.surface.triangles().size();
  }
  state.SetComplexityN(static_cast<std::int64_t>(n));
  state.counters["triangles"] = static_cast<double>(n);
}

void cross_field_with_features(benchmark::State& state) {
  const int n = static_cast<int>(std::sqrt(static_cast<double>(state.range(0)) / 12));
  const Surface surface = test::box_surface({1, 1, 1}, n, n, n);
  for (auto _ : state) benchmark::DoNotOptimize(compute_cross_field(surface));
  state.SetComplexityN(state.range(0));
}

void cross_field_closed(benchmark::State& state) {
  const Surface surface = torus(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(compute_cross_field(surface));
  state.SetComplexityN(state.range(0));
}

void retriangulate_torus(benchmark::State& state) {
  const Surface surface = torus(state.range(0));
  const double h = std::sqrt(2 * 15.8 / static_cast<double>(state.range(0))) * 1.5;
  const auto samples = test::scatter_samples(surface, h);
  for (auto _ : state) benchmark::DoNotOptimize(retriangulate(surface, samples));
  state.SetComplexityN(state.range(0));
  state.counters["samples"] = static_cast<double>(samples.size());
}

void self_intersections(benchmark::State& state) {
  const auto surface = torus(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(find_self_intersections(surface));
  state.SetComplexityN(state.range(0));
}

}  // namespace

BENCHMARK(nearest_point)->Arg(1000)->Arg(10000)->Arg(100000);
BENCHMARK(nearest_point_in_rtree)->Arg(1000)->Arg(10000)->Arg(100000);
BENCHMARK(inside)->Arg(1000)->Arg(10000)->Arg(100000);
BENCHMARK(features_of_cylinder)->Arg(1000)->Arg(10000)->Arg(100000)->Complexity()->Unit(benchmark::kMillisecond);
BENCHMARK(refine_cylinder)->Arg(1000)->Arg(10000)->Arg(100000)->Complexity()->Unit(benchmark::kMillisecond);
BENCHMARK(cross_field_with_features)->Arg(1000)->Arg(10000)->Arg(100000)->Complexity()->Unit(benchmark::kMillisecond);
BENCHMARK(cross_field_closed)->Arg(1000)->Arg(10000)->Arg(100000)->Complexity()->Unit(benchmark::kMillisecond);
BENCHMARK(retriangulate_torus)->Arg(1000)->Arg(10000)->Arg(100000)->Complexity()->Unit(benchmark::kMillisecond);
BENCHMARK(self_intersections)->Arg(1000)->Arg(10000)->Arg(100000)->Complexity()->Unit(benchmark::kMillisecond);
