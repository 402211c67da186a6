// SPDX-License-Identifier: BSL-1.0
// What reading a host's own mesh costs: the stages that do, over several hosts. Compare with compare.py.
#include "meshes.hpp"

#include <framehex/field/compute_frame_field.hpp>
#include <framehex/mesh/validation.hpp>
#include <framehex/recombination/potential_hex_finder.hpp>
#include <framehex/recombination/potential_prism_finder.hpp>
#include <framehex/recombination/potential_pyramid_finder.hpp>
#include <framehex/selection/candidate_weights.hpp>
#include <framehex/selection/greedy.hpp>
#include <framehex/selection/implicit_graph.hpp>

#include <benchmark/benchmark.h>

namespace {

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

/// The stages over one host's mesh, which must live as long as the benchmarks.
template <framehex::TetMesh M>
void add_stages(const std::string& host, const M& mesh) {
  using namespace framehex;
  const std::size_t n = tetrahedra(mesh).size();
  add("validate", host, n, [&] { return validated_adjacency(mesh).tets.size(); });
  add("hexahedra", host, n, [&] { return find_potential_hexahedra(mesh, {.quality_floor = 0.2}).size(); });
  add("prisms", host, n, [&] { return find_potential_prisms(mesh, {.quality_floor = 0.2}).size(); });
  add("pyramids", host, n, [&] { return find_potential_pyramids(mesh, {.quality_floor = 0.2}).size(); });
  add("field", host, n, [&] { return compute_frame_field(mesh).smoothness().size(); });
}

/// What follows does not see the host any more.
void add_selection(const framehex::IndexedTetMesh& mesh) {
  using namespace framehex;
  static const PotentialHexahedra candidates = find_potential_hexahedra(mesh, {.quality_floor = 0.2});
  add("greedy", "arrays", mesh.tets.size(), [] {
    return select_dynamically(ImplicitIncompatibilityGraph(candidates, volume_times_quality(candidates))).size();
  });
}

}  // namespace

int main(int argc, char** argv) {
  const framehex::IndexedTetMesh arrays = make_arrays(12);
  const PointerMesh pointers(arrays);
  const MatrixMesh matrices(arrays);
  add_stages("arrays", arrays);
  add_stages("pointers", pointers);
  const framehex::EigenTets view(matrices.V, matrices.T);
  add_stages("matrices", view);
  // add_stages("mine", my_mesh);
  add_selection(arrays);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
