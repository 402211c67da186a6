// SPDX-License-Identifier: BSL-1.0
#include "framehex/geometry/quality.hpp"
#include "framehex/geometry/validity.hpp"
#include "support/cells.hpp"

#include <benchmark/benchmark.h>

#include <random>
#include <vector>

using namespace framehex;

namespace {

template <class F>
void run(benchmark::State& state, F&& f) {
  std::mt19937_64 engine(1);
  std::vector<std::array<Vector3, 8>> cubes(10000);
  for (auto& cube : cubes) cube = test::shaken_cube(static_cast<double>(state.range(0)) / 100, engine);
  std::size_t n = 0;
  for (auto _ : state)
    for (const auto& cube : cubes) n += f(cube);
  benchmark::DoNotOptimize(n);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(cubes.size()));
}

}  // namespace

/// The argument is the amplitude in hundredths: at 20 all cells are valid, at 40 one in ten is not.
static void exact_validity(benchmark::State& state) {
  run(state, [](const auto& cube) { return is_valid(CellKind::hexahedron, cube); });
}
BENCHMARK(exact_validity)->Arg(20)->Arg(40)->Arg(60);

static void scaled_jacobians(benchmark::State& state) {
  run(state, [](const auto& cube) { return scaled_jacobian(CellKind::hexahedron, cube) > 0.2; });
}
BENCHMARK(scaled_jacobians)->Arg(20);

static void volumes(benchmark::State& state) {
  run(state, [](const auto& cube) { return cell_volume(CellKind::hexahedron, cube) > 0.2; });
}
BENCHMARK(volumes)->Arg(20);

/// Argument 0: any four points, which the filter decides; 1: four of an oblique plane, but for rounding.
static void orientations(benchmark::State& state) {
  std::mt19937_64 engine(1);
  const auto uniform = [&engine] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<std::array<Vector3, 4>> points(10000);
  for (auto& p : points) {
    for (Vector3& x : p) x = Vector3(uniform(), uniform(), uniform());
    if (state.range(0) == 1) p[3] = p[0] + uniform() * (p[1] - p[0]) + uniform() * (p[2] - p[0]);
  }
  int sum = 0;
  for (auto _ : state)
    for (const auto& p : points) sum += orientation(p[0], p[1], p[2], p[3]);
  benchmark::DoNotOptimize(sum);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}
BENCHMARK(orientations)->Arg(0)->Arg(1);
