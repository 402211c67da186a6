// SPDX-License-Identifier: BSL-1.0
// What reading a host's own mesh costs: the stages that do, over several hosts. Then, once, the stages that follow, which read
// no host any more. Compare with compare.py.
#include "meshes.hpp"

#include <framehex/assembly/assemble.hpp>
#include <framehex/field/compute_frame_field.hpp>
#include <framehex/insertion/volume_inserter.hpp>
#include <framehex/mesh/validation.hpp>
#include <framehex/recombination/potential_hex_finder.hpp>
#include <framehex/recombination/potential_prism_finder.hpp>
#include <framehex/recombination/potential_pyramid_finder.hpp>
#include <framehex/selection/candidate_weights.hpp>
#include <framehex/selection/conflict_search.hpp>
#include <framehex/selection/greedy.hpp>
#include <framehex/selection/implicit_graph.hpp>
#include <framehex/selection/tomita.hpp>

#include <benchmark/benchmark.h>

namespace {

using namespace framehex;

/// Times `stage()`; what it returns is a count, the same in every host.
template <class Stage>
void add(const std::string& stage_name, const std::string& host, std::size_t n_tets, Stage stage) {
  benchmark::RegisterBenchmark((stage_name + "/" + host).c_str(),
                               [=](benchmark::State& state) {
                                 std::size_t count = 0;
                                 for (auto _ : state) benchmark::DoNotOptimize(count = stage());
                                 state.counters["count"] = static_cast<double>(count);
                                 state.counters["tets"] = static_cast<double>(n_tets);
                               })
      ->Unit(benchmark::kMillisecond)
      ->MinTime(0.1);
}

/// Far from smooth.
std::vector<Quaternion> twisted_frames(const std::vector<Vector3>& points) {
  std::vector<Quaternion> frames;
  for (const Vector3& p : points)
    frames.push_back(
        CubeRotationGroup<>::exponential(Vector3(p.y() * p.z(), 2 * p.x() * p.z(), 3 * p.x() * p.y()) / 150));
  return frames;
}

/// The stages over one host's mesh, which must live as long as the benchmarks.
template <TetMesh M>
void add_stages(const std::string& host, const M& mesh) {
  const std::size_t n = tetrahedra(mesh).size();
  add("validate", host, n, [&] { return validated_adjacency(mesh).tets.size(); });
  add("hexahedra", host, n, [&] { return find_potential_hexahedra(mesh, {.quality_floor = 0.2}).size(); });
  add("prisms", host, n, [&] { return find_potential_prisms(mesh, {.quality_floor = 0.2}).size(); });
  add("pyramids", host, n, [&] { return find_potential_pyramids(mesh, {.quality_floor = 0.2}).size(); });
  add("field", host, n, [&] { return compute_frame_field(mesh).smoothness().size(); });
  const auto field = std::make_shared<FrameField<M>>(compute_frame_field(mesh));
  add("smoothing", host, n, [field] {
    FrameField<M> twisted = *field;
    twisted.set_frames(twisted_frames(field->points()));
    return twisted.smooth({.max_sweeps = 3}).sweeps.size();
  });
  add("points", host, n, [field] {
    const auto seeds = box_seeds(n_cubes);
    return insert_volume_points(std::span<const BoundarySeed>(seeds), *field, ConstantSize{1}, BoxDomain{n_cubes})
        .points.size();
  });
  const auto candidates = std::make_shared<PotentialHexahedra>(find_potential_hexahedra(mesh, {.quality_floor = 0.2}));
  const std::vector<index_t> selected =
      select_greedily(ImplicitIncompatibilityGraph(*candidates, volume_times_quality(*candidates)));
  add("assembly", host, n, [&mesh, candidates, selected, adjacency = make_adjacency(mesh)] {
    return assemble(mesh, adjacency, *candidates, selected, {.improvement = ImprovementMode::none}).mesh.n_cells();
  });
}

/// What follows does not see the host any more.
void add_selection(const IndexedTetMesh& mesh) {
  const std::size_t n = mesh.tets.size();
  static const PotentialHexahedra candidates = find_potential_hexahedra(mesh, {.quality_floor = 0.2});
  add("graph", "arrays", n, [] { return build_incompatibility_graph(candidates).n_conflicts(); });
  add("greedy", "arrays", n, [] {
    return select_greedily(ImplicitIncompatibilityGraph(candidates, volume_times_quality(candidates))).size();
  });
  static const PotentialHexahedra few = find_potential_hexahedra(make_arrays(2), {.quality_floor = 0.2});
  add("Tomita", "arrays", 6 * 8, [] {
    return for_each_maximal_independent_set(build_incompatibility_graph(few), [](auto) {}, {.max_sets = 100'000})
        .n_sets;
  });
}

/// Of points and rotations alone.
void add_kernels() {
  add("matching", "arrays", 0, [] {
    Vector3 sum = Vector3::Zero();
    Quaternion q = Quaternion::Identity();
    const Quaternion turn = CubeRotationGroup<>::exponential(Vector3(0.3, 0.5, 0.7));
    for (int i = 0; i < 100'000; ++i, q = turn * q)
      sum += CubeRotationGroup<>::rotation_vector(Quaternion::Identity(), q.normalized());
    return static_cast<std::size_t>(std::lround(1e3 * sum.norm()));
  });
  add("proximity", "arrays", 0, [] {
    static const IndexedTetMesh mesh = make_arrays(30);
    HashGrid grid(1);
    for (const Vector3& p : mesh.points) grid.insert(p, 1);
    std::size_t n_near = 0;
    for (const Vector3& p : mesh.points)
      grid.for_each_in_box(p - Vector3::Constant(0.7), p + Vector3::Constant(0.7), [&](index_t, const Vector3&) {
        ++n_near;
        return true;
      });
    return n_near;
  });
}

}  // namespace

int main(int argc, char** argv) {
  const IndexedTetMesh arrays = make_arrays(n_cubes);
  const PointerMesh pointers(arrays);
  const MatrixMesh matrices(arrays);
  add_stages("arrays", arrays);
  add_stages("pointers", pointers);
  const EigenTets view(matrices.V, matrices.T);
  add_stages("matrices", view);
  // add_stages("mine", my_mesh);
  add_selection(arrays);
  add_kernels();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
