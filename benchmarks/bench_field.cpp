// SPDX-License-Identifier: BSL-1.0
//
// Frame fields: closest matching, sweeps of the paper's smoothing, and whole fields on balls of 10^4 to 10^6
// tetrahedra.
#include "framehex/field/compute_frame_field.hpp"

#include "support/mapped_lattices.hpp"

#include <benchmark/benchmark.h>

#include <random>

namespace {

using namespace framehex;
using Group = CubeRotationGroup<>;

std::vector<Quaternion> random_frames(std::size_t n) {
  std::mt19937_64 engine(1);
  std::vector<Quaternion> frames;
  const auto number = [&] { return static_cast<double>(engine() >> 11) * 0x1p-52 - 1; };
  while (frames.size() < n) {
    const Quaternion q(number(), number(), number(), number());
    if (q.norm() > 0.1) frames.push_back(q.normalized());
  }
  return frames;
}

void matching_in_closed_form(benchmark::State& state) {
  const auto frames = random_frames(1025);
  for (auto _ : state)
    for (std::size_t i = 0; i < 1024; ++i) benchmark::DoNotOptimize(Group::rotation_vector(frames[i], frames[i + 1]));
  state.SetItemsProcessed(1024 * state.iterations());
}
BENCHMARK(matching_in_closed_form);

/// The same by trying the 24 as the paper says: the axis and angle of each, and the least is kept.
void matching_by_brute_force(benchmark::State& state) {
  const auto frames = random_frames(1025);
  std::vector<Quaternion> elements;
  for (int g = 0; g < 24; ++g) elements.push_back(Group::element(g));
  for (auto _ : state)
    for (std::size_t i = 0; i < 1024; ++i) {
      Vector3 best = Vector3::Constant(10);
      for (const Quaternion& g : elements) {
        Quaternion q = frames[i + 1] * g * frames[i].conjugate();
        if (q.w() < 0) q.coeffs() = -q.coeffs();
        const Vector3 v = Group::logarithm(q);
        if (v.squaredNorm() < best.squaredNorm()) best = v;
      }
      benchmark::DoNotOptimize(best);
    }
  state.SetItemsProcessed(1024 * state.iterations());
}
BENCHMARK(matching_by_brute_force);

/// And with a short cut: axis and angle only of the one of greatest |w|.
void matching_by_brute_force_on_w(benchmark::State& state) {
  const auto frames = random_frames(1025);
  std::vector<Quaternion> elements;
  for (int g = 0; g < 24; ++g) elements.push_back(Group::element(g));
  for (auto _ : state)
    for (std::size_t i = 0; i < 1024; ++i) {
      Quaternion best(0, 0, 0, 0);
      for (const Quaternion& g : elements) {
        Quaternion q = frames[i + 1] * g * frames[i].conjugate();
        if (q.w() < 0) q.coeffs() = -q.coeffs();
        if (q.w() > best.w()) best = q;
      }
      benchmark::DoNotOptimize(Vector3(Group::logarithm(best)));
    }
  state.SetItemsProcessed(1024 * state.iterations());
}
BENCHMARK(matching_by_brute_force_on_w);

/// One sweep over a field that is far from converged; items are vertices visited.
void sweep(benchmark::State& state) {
  const IndexedTetMesh mesh = test::ball_mesh(static_cast<index_t>(state.range(0)), 0.95);
  const TetAdjacency adjacency = make_adjacency(mesh);
  const std::vector<FrameConstraint> constraints(mesh.points.size(), FrameConstraint::none);
  const std::vector<Vector3> axes(mesh.points.size(), Vector3::Zero());
  std::vector<Quaternion> start;
  for (const Vector3& p : mesh.points)
    start.push_back(Group::exponential(Vector3(p.y() * p.z(), 2 * p.x() * p.z(), 3 * p.x() * p.y())));
  std::vector<double> smoothness(start.size());
  for (auto _ : state) {
    std::vector<Quaternion> frames = start;
    smooth_frames(adjacency, frames, smoothness, constraints, axes, {.max_sweeps = 1});
    benchmark::DoNotOptimize(frames.data());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(start.size()) * state.iterations());
}
BENCHMARK(sweep)->Arg(12)->Arg(26)->Unit(benchmark::kMillisecond);

/// Whole fields, everything included from the mesh to the smoothness. The argument is the number of cubes along a side
/// of the lattice: 6 n^3 tetrahedra, which the fit of the exponent uses.
void whole_field(benchmark::State& state, FieldMethod method) {
  const IndexedTetMesh mesh = test::ball_mesh(static_cast<index_t>(state.range(0)), 0.95);
  for (auto _ : state) {
    const auto field = compute_frame_field(mesh, MeshFieldOptions{.field = {.method = method}});
    benchmark::DoNotOptimize(field.frames().data());
  }
  state.counters["tets"] = static_cast<double>(mesh.tets.size());
  state.SetItemsProcessed(static_cast<std::int64_t>(mesh.tets.size()) * state.iterations());
}
BENCHMARK_CAPTURE(whole_field, nearest, FieldMethod::nearest)->Arg(12)->Arg(26)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(whole_field, smoothed, FieldMethod::smoothed)->Arg(12)->Arg(26)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(whole_field, best, FieldMethod::best)
    ->Arg(12)
    ->Arg(26)
    ->Arg(55)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
