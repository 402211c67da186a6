// SPDX-License-Identifier: BSL-1.0
//
// Points for the volume of a cube, 10^4 to 10^6, from analytic frames and from a field on a mesh; with the two
// proximity filters, with and without relaxation. Points for a sphere. Counters: points a second.
#include "framehex/field/frame_field.hpp"
#include "framehex/insertion/rtree_filter.hpp"

#include "support/insertion_fixtures.hpp"
#include "support/kuhn_lattice.hpp"

#include <benchmark/benchmark.h>

namespace {

using namespace framehex;
using namespace framehex::test;

/// Frames that turn about z by 0.3 rad over the height of the unit cube.
Quaternion twist(const Vector3& p) {
  return Quaternion(Eigen::AngleAxisd(0.3 * p.z(), Vector3::UnitZ()));
}

struct TwistedFrames {
  ConstantFrames::Sample sample(const Vector3& p, index_t&) const { return {twist(p), 1.0}; }
};

std::vector<BoundarySeed> cube_seeds(int n) {
  std::vector<BoundarySeed> seeds;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      for (const int k : {0, n}) seeds.push_back({Vector3(i, j, k) / n, Vector3(0, 0, k == 0 ? -1 : 1)});
  return seeds;
}

template <class Order, class Proximity, class Frames>
void fill_cube(benchmark::State& state, const Frames& frames, index_t rounds) {
  const auto n = static_cast<int>(state.range(0));
  const auto seeds = cube_seeds(n);
  const auto size = [n](const Vector3&) { return 1.0 / n; };
  const BoxDomain domain{Quaternion::Identity(), Vector3::Ones()};
  std::size_t n_points = 0;
  for (auto _ : state) {
    const auto result = insert_volume_points<Order, Proximity>(seeds, frames, size, domain, {.rounds = rounds});
    n_points = result.points.size() - result.n_seeds;
  }
  state.counters["points"] = static_cast<double>(n_points);
  state.counters["points/s"] =
      benchmark::Counter(static_cast<double>(n_points), benchmark::Counter::kIsIterationInvariantRate);
  state.SetComplexityN(static_cast<std::int64_t>(n_points));
}

FrameField<IndexedTetMesh> twisted_field() {
  const IndexedTetMesh mesh = kuhn_lattice(24, 24, 24, 1.0 / 24);
  FrameField<IndexedTetMesh> field(mesh);
  std::vector<Quaternion> frames;
  for (const Vector3& p : mesh.points) frames.push_back(twist(p));
  field.set_frames(std::move(frames));
  return field;
}

template <class Order, class Proximity>
void volume_of_analytic_frames(benchmark::State& state) {
  fill_cube<Order, Proximity>(state, TwistedFrames{}, 0);
}
BENCHMARK(volume_of_analytic_frames<SmoothnessOrder, HashGrid>)
    ->Arg(22)
    ->Arg(47)
    ->Arg(100)
    ->Unit(benchmark::kMillisecond)
    ->Complexity();
BENCHMARK(volume_of_analytic_frames<FifoOrder, HashGrid>)
    ->Arg(22)
    ->Arg(47)
    ->Arg(100)
    ->Unit(benchmark::kMillisecond)
    ->Complexity();
BENCHMARK(volume_of_analytic_frames<FifoOrder, RTreeFilter>)
    ->Arg(22)
    ->Arg(47)
    ->Arg(100)
    ->Unit(benchmark::kMillisecond)
    ->Complexity();

template <index_t Rounds>
void volume_of_a_field_on_a_mesh(benchmark::State& state) {
  fill_cube<SmoothnessOrder, HashGrid>(state, twisted_field(), Rounds);
}
BENCHMARK(volume_of_a_field_on_a_mesh<0>)->Arg(22)->Arg(47)->Arg(100)->Unit(benchmark::kMillisecond)->Complexity();
BENCHMARK(volume_of_a_field_on_a_mesh<3>)->Arg(22)->Arg(47)->Arg(100)->Unit(benchmark::kMillisecond);

template <index_t Rounds>
void sphere(benchmark::State& state) {
  const auto mesh = sphere_surface(1, 5);
  const Surface surface(mesh);
  const auto frames = triangle_frames(mesh, Quaternion::Identity());
  const double h = 1.0 / static_cast<double>(state.range(0));
  const auto size = [h](const Vector3&) { return h; };
  const auto curves = insert_curve_points(surface, size);
  std::size_t n_points = 0;
  for (auto _ : state)
    n_points = insert_surface_points(surface, frames, {}, curves, size, {.rounds = Rounds}).samples.size();
  state.counters["points"] = static_cast<double>(n_points);
  state.counters["points/s"] =
      benchmark::Counter(static_cast<double>(n_points), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(sphere<0>)->Arg(30)->Arg(90)->Unit(benchmark::kMillisecond);
BENCHMARK(sphere<3>)->Arg(30)->Arg(90)->Unit(benchmark::kMillisecond);

}  // namespace
