// SPDX-License-Identifier: BSL-1.0
#include "framehex/recombination/pattern_search.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/recombination/potential_prism_finder.hpp"
#include "framehex/recombination/potential_pyramid_finder.hpp"
#include "support/heavy_meshes.hpp"
#include "support/kuhn_lattice.hpp"

#include <benchmark/benchmark.h>
#include <sys/resource.h>

using namespace framehex;

namespace {

std::int64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss * 1024;
}

template <class Find>
void run(benchmark::State& state, const IndexedTetMesh& mesh, Find&& find) {
  std::size_t n = 0;
  // The peak of the process only grows: it is that of the search when this is the largest so far.
  const std::int64_t before = peak_memory();
  for (auto _ : state) {
    const auto found = find(mesh);
    benchmark::DoNotOptimize(found.vertices.data());
    n = found.size();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(n));
  state.SetComplexityN(static_cast<std::int64_t>(mesh.tets.size()));
  state.counters["tets"] = static_cast<double>(mesh.tets.size());
  state.counters["candidates"] = static_cast<double>(n);
  if (peak_memory() > before && n > 0)
    state.counters["bytes_each"] = static_cast<double>(peak_memory() - before) / static_cast<double>(n);
}

}  // namespace

/// With nothing but the mesh: checks and adjacency are in the time.
static void hexahedra(benchmark::State& state) {
  run(state, test::kuhn_lattice(static_cast<index_t>(state.range(0))),
      [](const auto& mesh) { return find_potential_hexahedra(mesh, {.quality_floor = 1e-4}); });
}
BENCHMARK(hexahedra)->Arg(10)->Arg(20)->Arg(40)->Arg(55)->Unit(benchmark::kMillisecond)->Complexity();

/// The search alone, by the number of threads.
static void hexahedra_by_threads(benchmark::State& state) {
  const auto mesh = test::kuhn_lattice(20);
  const auto adjacency = make_adjacency(mesh);
  run(state, mesh, [&](const auto& m) {
    return find_potential_hexahedra(m,
                                    {.quality_floor = 1e-4, .input_check = InputCheck::skip, .adjacency = &adjacency},
                                    ThreadExecutor(static_cast<std::size_t>(state.range(0))));
  });
}
BENCHMARK(hexahedra_by_threads)
    ->Arg(1)
    ->Arg(2)
    ->Arg(4)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

static void prisms(benchmark::State& state) {
  run(state, test::kuhn_lattice(20),
      [](const auto& mesh) { return find_potential_prisms(mesh, {.quality_floor = 1e-4}); });
}
BENCHMARK(prisms)->Unit(benchmark::kMillisecond);

static void pyramids(benchmark::State& state) {
  run(state, test::kuhn_lattice(20),
      [](const auto& mesh) { return find_potential_pyramids(mesh, {.quality_floor = 1e-4}); });
}
BENCHMARK(pyramids)->Unit(benchmark::kMillisecond);

static void patterns(benchmark::State& state) {
  run(state, test::kuhn_lattice(20),
      [](const auto& mesh) { return find_pattern_hexahedra(mesh, {.quality_floor = 1e-4}); });
}
BENCHMARK(patterns)->Unit(benchmark::kMillisecond);

static void around_one_edge(benchmark::State& state) {
  run(state, test::fan(static_cast<index_t>(state.range(0))),
      [](const auto& mesh) { return find_potential_hexahedra(mesh, {.quality_floor = 1e-4}); });
}
BENCHMARK(around_one_edge)->RangeMultiplier(2)->Range(125, 1000)->Unit(benchmark::kMillisecond)->Complexity();

static void around_one_vertex(benchmark::State& state) {
  run(state, test::banded_star(static_cast<index_t>(state.range(0))),
      [](const auto& mesh) { return find_potential_hexahedra(mesh, {.quality_floor = 1e-4}); });
}
BENCHMARK(around_one_vertex)->Arg(8)->Arg(12)->Arg(16)->Arg(23)->Unit(benchmark::kMillisecond)->Complexity();
