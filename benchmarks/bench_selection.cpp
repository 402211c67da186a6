// SPDX-License-Identifier: BSL-1.0
// Selection where two lattices meet in a ball. The argument is the number of cells across: 8, 12, 20, 60. Times are CPU
// seconds of one thread. `docs/scripts/selection_plot.py` draws docs/images/selection_gap.png from the output of
//   bench_selection --benchmark_filter='trade_off|find' --benchmark_format=json
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/selection/conflict_search.hpp"
#include "framehex/selection/select.hpp"
#include "lattice_ball.hpp"

#include <benchmark/benchmark.h>

#include <map>

using namespace framehex;

namespace {

const IndexedTetMesh& ball(std::int64_t n_across) {
  static std::map<std::int64_t, IndexedTetMesh> meshes;
  auto [it, is_new] = meshes.try_emplace(n_across);
  if (is_new) it->second = benchmarks::lattice_ball(static_cast<int>(n_across));
  return it->second;
}

constexpr double quality_floor = 0.3;

const PotentialHexahedra& candidates(std::int64_t n_across) {
  static std::map<std::int64_t, PotentialHexahedra> found;
  auto [it, is_new] = found.try_emplace(n_across);
  if (is_new) it->second = find_potential_hexahedra(ball(n_across), {.quality_floor = quality_floor});
  return it->second;
}

auto rounded_quality(const PotentialHexahedra& hexahedra) {
  return [&](index_t i) { return std::round(1e4 * static_cast<double>(hexahedra.quality[i])); };
}

ImplicitIncompatibilityGraph graph(std::int64_t n_across) {
  return {candidates(n_across), rounded_quality(candidates(n_across))};
}

void report(benchmark::State& state, const Selection& selection, const ImplicitIncompatibilityGraph& g) {
  state.counters["candidates"] = static_cast<double>(g.size());
  state.counters["selected"] = static_cast<double>(selection.members.size());
  state.counters["weight"] = selection.weight;
  state.counters["bound"] = selection.bound;
  state.counters["gap_percent"] = 100 * selection.gap();
  state.counters["status"] = static_cast<double>(selection.status);
}

void find(benchmark::State& state) {
  const IndexedTetMesh& mesh = ball(state.range(0));
  for (auto _ : state)
    benchmark::DoNotOptimize(find_potential_hexahedra(mesh, {.quality_floor = quality_floor}).size());
  state.counters["tets"] = static_cast<double>(mesh.tets.size());
}

void build_graph(benchmark::State& state) {
  const PotentialHexahedra& hexahedra = candidates(state.range(0));
  std::size_t n_conflicts = 0;
  for (auto _ : state) n_conflicts = build_incompatibility_graph(hexahedra, rounded_quality(hexahedra)).n_conflicts();
  state.counters["candidates"] = static_cast<double>(hexahedra.size());
  state.counters["conflicts"] = static_cast<double>(n_conflicts);
  state.counters["conflicts/s"] =
      benchmark::Counter(static_cast<double>(n_conflicts), benchmark::Counter::kIsIterationInvariantRate);
}

void select_by(benchmark::State& state, const SelectOptions& options) {
  const ImplicitIncompatibilityGraph g = graph(state.range(0));
  Selection selection;
  for (auto _ : state) selection = select(g, options);
  report(state, selection, g);
}

void greedy(benchmark::State& state) {
  select_by(state, {.method = SelectMethod::greedy});
}
/// What `recombine` does: nothing is proven.
void first(benchmark::State& state) {
  select_by(state, {.gap = 1, .exact_below = 2000});
}
void best(benchmark::State& state) {
  select_by(state, {});
}
void best_one_percent(benchmark::State& state) {
  select_by(state, {.gap = 0.01});
}
void exact(benchmark::State& state) {
  select_by(state, {.method = SelectMethod::exact, .max_rounds = 200});
}

/// The second argument is the budget in rounds.
void trade_off(benchmark::State& state) {
  select_by(state,
            {.gap = 0, .max_rounds = static_cast<std::size_t>(state.range(1)), .max_nodes = 0, .exact_below = 0});
}

void sizes(benchmark::internal::Benchmark* b) {
  for (const int n : {8, 12, 20, 60}) b->Arg(n);
  b->Unit(benchmark::kMillisecond)->Iterations(1);
}

void sizes_and_rounds(benchmark::internal::Benchmark* b) {
  for (const int n : {12, 20, 60})
    for (const int rounds : {0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32}) b->Args({n, rounds});
  b->Unit(benchmark::kMillisecond)->Iterations(1);
}

}  // namespace

BENCHMARK(find)->Apply(sizes);
BENCHMARK(build_graph)->Apply(sizes)->Arg(40)->Arg(64);
BENCHMARK(greedy)->Apply(sizes);
BENCHMARK(first)->Apply(sizes);
BENCHMARK(best)->Apply(sizes);
BENCHMARK(best_one_percent)->Arg(60)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(exact)->Arg(8)->Arg(12)->Arg(20)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(trade_off)->Apply(sizes_and_rounds);
