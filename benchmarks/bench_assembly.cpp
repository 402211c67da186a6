// SPDX-License-Identifier: BSL-1.0
#include "framehex/assembly/assemble.hpp"
#include "framehex/verify/validity.hpp"
#include "support/cube_candidates.hpp"

#include <benchmark/benchmark.h>

#include <random>

using namespace framehex;

namespace {

struct Input {
  IndexedTetMesh mesh;
  TetAdjacency adjacency;
  PotentialHexahedra cubes;
  std::vector<index_t> selected;
};

/// Four fifths of the cubes of a jittered lattice, at random.
Input make_input(index_t n) {
  Input input{test::kuhn_lattice(n), {}, test::cube_candidates(n), {}};
  std::mt19937_64 engine(1);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  for (Vector3& p : input.mesh.points)
    for (int i = 0; i < 3; ++i)
      if (p[i] > 0 && p[i] < n) p[i] += 0.3 * uniform() - 0.15;
  input.adjacency = make_adjacency(input.mesh);
  for (index_t i = 0; i < n * n * n; ++i)
    if (uniform() < 0.8) input.selected.push_back(i);
  return input;
}

void run(benchmark::State& state, InterfaceMode mode, ImprovementMode improvement) {
  const Input input = make_input(static_cast<index_t>(state.range(0)));
  std::size_t n_open = 0;
  for (auto _ : state) {
    const Assembly result = assemble(input.mesh, input.adjacency, input.cubes, input.selected,
                                     {.interfaces = mode, .improvement = improvement});
    n_open = result.statistics.n_open_quadrilaterals;
    benchmark::DoNotOptimize(result.mesh.points.data());
  }
  state.counters["open_quadrilaterals"] = static_cast<double>(n_open);
}

void verify_mesh(benchmark::State& state) {
  const Input input = make_input(static_cast<index_t>(state.range(0)));
  const Assembly result = assemble(input.mesh, input.adjacency, input.cubes, input.selected);
  for (auto _ : state) {
    benchmark::DoNotOptimize(verify::is_conforming(result.mesh).conforming());
    benchmark::DoNotOptimize(verify::is_valid(result.mesh).invalid_cells.size());
  }
}

}  // namespace

BENCHMARK_CAPTURE(run, open, InterfaceMode::open, ImprovementMode::none)
    ->Arg(10)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(run, closed, InterfaceMode::conforming, ImprovementMode::none)
    ->Arg(10)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(run, closed_and_improved, InterfaceMode::conforming, ImprovementMode::improve)
    ->Arg(10)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(verify_mesh)->Arg(20)->Unit(benchmark::kMillisecond);
