// SPDX-License-Identifier: BSL-1.0
#include "support/growth.hpp"

#include <benchmark/benchmark.h>

using namespace framehex;

/// Doublings of the input, and the exponent of the time that fits them (`_BigO`).
template <class Work>
static void growth(benchmark::State& state) {
  const Work work(static_cast<int>(state.range(0)));
  std::size_t result = 0;
  for (auto _ : state) result += work.run();
  benchmark::DoNotOptimize(result);
  state.SetComplexityN(state.range(0));
}

template <class Work>
static void doublings(benchmark::internal::Benchmark* benchmark) {
  benchmark->RangeMultiplier(2)->Range(Work::typical, 16 * Work::typical)->Unit(benchmark::kMillisecond)->Complexity();
}

BENCHMARK_TEMPLATE(growth, test::SlidingOnLongCurves)->Apply(doublings<test::SlidingOnLongCurves>);
BENCHMARK_TEMPLATE(growth, test::FramesOfNeedle)->Apply(doublings<test::FramesOfNeedle>);
BENCHMARK_TEMPLATE(growth, test::SelectionOfCycles)->Apply(doublings<test::SelectionOfCycles>);
BENCHMARK_TEMPLATE(growth, test::FieldOfManyParts)->Apply(doublings<test::FieldOfManyParts>);
BENCHMARK_TEMPLATE(growth, test::SitesOnLongCurves)->Apply(doublings<test::SitesOnLongCurves>);
BENCHMARK_TEMPLATE(growth, test::SearchAtVertices)->Apply(doublings<test::SearchAtVertices>);
BENCHMARK_TEMPLATE(growth, test::RepairOfThinStrip)->Apply(doublings<test::RepairOfThinStrip>);
BENCHMARK_TEMPLATE(growth, test::PrismsInRow)->Apply(doublings<test::PrismsInRow>);
