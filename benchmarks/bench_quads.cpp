// SPDX-License-Identifier: BSL-1.0
// Triangles to quadrilaterals over their number: matching (LEMON, Boost, greedy), improvement, and the whole way from an
// outline. The fitted exponent is Google Benchmark's complexity; a run counts triangles.
#include <benchmark/benchmark.h>

#include "framehex/adapters/boost_matcher.hpp"
#include "framehex/adapters/lemon_matcher.hpp"
#include "framehex/pipeline/mesh_planar.hpp"
#include "support/outlines.hpp"

#include <map>
#include <random>

using namespace framehex;

namespace {

/// Delaunay triangles of a square's lattice of about n triangles, its inner points moved by up to half an interval.
const Surface& jittered_square(std::int64_t n) {
  static std::map<std::int64_t, Surface> known;
  const auto [at, is_new] = known.try_emplace(n);
  if (!is_new) return at->second;
  const int side = static_cast<int>(std::sqrt(static_cast<double>(n) / 2));
  std::mt19937_64 engine(1);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53 - 0.5; };
  IndexedTriangleMesh mesh;
  for (int j = 0; j <= side; ++j)
    for (int i = 0; i <= side; ++i) {
      const bool inside = i > 0 && j > 0 && i < side && j < side;
      const double x = inside ? uniform() : 0, y = inside ? uniform() : 0;
      mesh.points.emplace_back(i + x, j + y, 0);
    }
  const PlanarOutline nameless;
  const detail::OutlineNames names(nameless);
  detail::ConstrainedDelaunay delaunay(mesh.points, names);
  delaunay.insert_points();
  for (const auto& t : delaunay.mesh().corners)
    if (!delaunay.is_box_corner(t[0]) && !delaunay.is_box_corner(t[1]) && !delaunay.is_box_corner(t[2]))
      mesh.triangles.push_back(t);
  return at->second = Surface(mesh);
}

template <class Match>
void matching(benchmark::State& state) {
  const Surface& surface = jittered_square(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(quadrangulate(surface, Match{}));
  state.SetComplexityN(state.range(0));
}

void improvement(benchmark::State& state) {
  const Surface& surface = jittered_square(state.range(0));
  const QuadMesh mesh = quadrangulate(surface, LemonMatcher{}).mesh;
  const FeatureCarriers carriers(surface);
  for (auto _ : state) benchmark::DoNotOptimize(improve_quads(mesh, carriers));
  state.SetComplexityN(state.range(0));
}

/// The plate with three holes.
void whole(benchmark::State& state) {
  const PlanarOutline outline = test::plate_with_holes();
  const double size = std::sqrt(2 * 6.8 / static_cast<double>(state.range(0)));
  std::size_t n_triangles = 0;
  for (auto _ : state) n_triangles = mesh_planar(outline, ConstantSize{size}, LemonMatcher{}).statistics.n_triangles;
  state.counters["triangles"] = static_cast<double>(n_triangles);
  state.SetComplexityN(state.range(0));
}

void sizes(benchmark::internal::Benchmark* run) {
  run->Arg(10'000)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond)->Complexity();
}

}  // namespace

BENCHMARK(matching<LemonMatcher>)->Apply(sizes);
BENCHMARK(matching<GreedyMatcher>)->Apply(sizes);
BENCHMARK(matching<BoostMatcher>)->Arg(1'000)->Arg(10'000)->Unit(benchmark::kMillisecond)->Complexity();
BENCHMARK(improvement)->Apply(sizes);
BENCHMARK(whole)
    ->Arg(10'000)
    ->Arg(40'000)
    ->Arg(160'000)
    ->Arg(640'000)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond)
    ->Complexity();
