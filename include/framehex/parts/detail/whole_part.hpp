// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/sound_assembly.hpp"
#include "framehex/parts/detail/calling_thread.hpp"
#include "framehex/parts/detail/tet_patch.hpp"
#include "framehex/parts/result.hpp"
#include "framehex/recombination/detail/chosen.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/selection/candidate_weights.hpp"
#include "framehex/selection/implicit_graph.hpp"

#include <chrono>
#include <utility>

namespace framehex::detail {

/// A mesh of one part, on the rank that holds it. @return false when stopped.
template <Executor E>
bool recombine_whole(const TetPatch& patch, const PartsOptions& options, const E& executor, CallingThread& thread,
                     global_t first_new, PartRecombination& result) {
  auto last = std::chrono::steady_clock::now();
  const auto lap = [&](double& seconds) {
    const auto now = std::chrono::steady_clock::now();
    seconds = std::chrono::duration<double>(now - std::exchange(last, now)).count();
  };
  HexFinderOptions finder = options.finder;
  finder.adjacency = &patch.adjacency;
  finder.input_check = InputCheck::skip;
  finder.regions = patch.regions;
  finder.observer = thread.part("recombination");
  PotentialHexahedra candidates = find_potential_hexahedra(patch.mesh, finder, executor);
  if (candidates.status == Status::cancelled) return false;
  lap(result.search_seconds);
  SelectOptions selecting = options.selection;
  selecting.observer = thread.part("selection");
  const Selection selection =
      select(ImplicitIncompatibilityGraph(candidates, volume_times_quality(candidates)), selecting, executor);
  if (selection.status == SelectionStatus::cancelled) return false;
  lap(result.selection_seconds);
  result.n_candidates = static_cast<std::int64_t>(candidates.size());
  result.n_chosen = static_cast<std::int64_t>(selection.members.size());
  result.weight = selection.weight;
  result.bound = selection.bound;
  result.chosen = selection.members;
  candidates = chosen(candidates, selection.members);
  std::vector<index_t> all(candidates.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<index_t>(i);
  AssemblyOptions assembling = options.assembly;
  assembling.regions = patch.regions;
  assembling.faces = {};
  assembling.edges = {};
  assembling.vertex_numbers = VertexNumbers::compact;
  assembling.observer = thread.part("assembly");
  const auto make = [&](std::span<const index_t> selected, const AssemblyOptions& how) {
    return assemble(patch.mesh, patch.adjacency, candidates, selected, how);
  };
  auto [assembly, n_given_up] = assemble_soundly(make, patch.adjacency, candidates, std::move(all), assembling);
  result.n_given_up = static_cast<std::int64_t>(n_given_up);
  if (assembly.status == Status::cancelled) return false;
  lap(result.assembly_seconds);
  result.mesh = std::move(assembly.mesh);
  result.mesh.faces.clear();
  result.assembly = assembly.statistics;
  result.candidate_of = std::move(assembly.candidate_of);
  for (index_t& candidate : result.candidate_of)
    if (candidate != no_index) candidate = selection.members[candidate];
  for (const index_t v : assembly.vertex_of)
    result.vertex_numbers.push_back(v == no_index ? first_new++ : patch.vertex_number[v]);
  for (const index_t v : assembly.moved) result.moved.push_back(assembly.result_of[v]);
  std::sort(result.moved.begin(), result.moved.end());
  for (std::size_t i = 0; i < result.mesh.n_cells(); ++i) {
    result.cell_numbers.push_back(static_cast<global_t>(i));
    for (const index_t tet : assembly.cell_of[i]) result.cell_of.values.push_back(patch.tet_number[tet]);
    result.cell_of.end_row();
  }
  return true;
}

}  // namespace framehex::detail
