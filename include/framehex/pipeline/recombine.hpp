// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/assemble.hpp"
#include "framehex/mesh/validation.hpp"
#include "framehex/pipeline/detail/stopwatch.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/selection/candidate_weights.hpp"
#include "framehex/selection/implicit_graph.hpp"
#include "framehex/selection/select.hpp"

namespace framehex {

/// Spans must outlive the call only.
struct RecombineOptions {
  HexFinderOptions finder = {};  ///< its labels, adjacency and observer are set from those below
  /// Proves nothing but for small meshes: what a proof wins is a hundredth of a per cent, for half of the time.
  SelectOptions selection = {.gap = 1, .exact_below = 2000};
  AssemblyOptions assembly = {};             ///< its labels and observer are set from those below
  std::span<const index_t> regions = {};     ///< label of each tetrahedron, n entries, or empty for one region
  std::span<const LabelledFace> faces = {};  ///< triangles on the boundary or between regions, with their patches
  std::span<const LabelledEdge> edges = {};  ///< feature edges; they stay edges
  const TetAdjacency* adjacency = nullptr;   ///< of the mesh, by those who have checked it already; else null
  Observer observer = {};
};

/// A recombined mesh and how it came about.
struct Recombination {
  MixedMesh mesh;
  std::size_t n_candidates = 0;  ///< potential hexahedra
  Selection selection;
  std::vector<OpenInterface> open;  ///< quadrilaterals that face two triangles, in mode `open`
  AssemblyStatistics assembly;
  StageSeconds seconds;
  Status status = Status::complete;
};

namespace detail {

/// Labels of the facets opposite each corner of each tetrahedron; `no_index` where none is given.
inline std::vector<std::array<index_t, 4>> label_facets(const TetAdjacency& adjacency,
                                                        std::span<const LabelledFace> faces) {
  std::vector<std::array<index_t, 4>> labels(adjacency.tets.size(), {no_index, no_index, no_index, no_index});
  if (faces.empty()) return labels;
  using Labelled = std::pair<std::array<index_t, 3>, index_t>;
  std::vector<Labelled> sorted_faces;
  for (const LabelledFace& face : faces)
    sorted_faces.emplace_back(sorted({face.vertices[0], face.vertices[1], face.vertices[2]}), face.label);
  std::sort(sorted_faces.begin(), sorted_faces.end());
  for (std::size_t tet = 0; tet < labels.size(); ++tet)
    for (std::size_t i = 0; i < 4; ++i) {
      const Labelled key{sorted(facet(adjacency.tets[tet], static_cast<int>(i))), 0};
      const auto at = std::lower_bound(sorted_faces.begin(), sorted_faces.end(), key);
      if (at != sorted_faces.end() && at->first == key.first) labels[tet][i] = at->second;
    }
  return labels;
}

/// Some candidates on their own, in the order given.
inline PotentialHexahedra chosen(const PotentialHexahedra& candidates, std::span<const index_t> members) {
  PotentialHexahedra result;
  for (const index_t v : members) {
    result.vertices.push_back(candidates.vertices[v]);
    result.quality.push_back(candidates.quality[v]);
    result.volume.push_back(candidates.volume[v]);
    for (const auto& [from, to] :
         {std::pair(&candidates.tets, &result.tets), std::pair(&candidates.face_slivers, &result.face_slivers)}) {
      const auto row = (*from)[v];
      to->values.insert(to->values.end(), row.begin(), row.end());
      to->end_row();
    }
  }
  return result;
}

inline std::vector<std::array<index_t, 2>> vertex_pairs(std::span<const LabelledEdge> edges) {
  std::vector<std::array<index_t, 2>> pairs;
  for (const LabelledEdge& edge : edges) pairs.push_back(edge.vertices);
  return pairs;
}

}  // namespace detail

/// Turns a tetrahedral mesh into a hex-dominant one without moving its vertices or needing anything else of framehex.
///
/// @param mesh     n tetrahedra; validated first.
/// @param options  quality floor, selection, interfaces, labels.
/// @return the mixed mesh; it fills the same volume. When cancelled the mesh is empty and `status` says so.
/// @throws what `validate` throws, before any work; `invalid_option` for options out of range.
/// @par Complexity   O(n) for the search and the assembly; the selection has its budget.
/// @par Determinism  The same for any executor, unless the selection is stopped by its time budget.
template <TetMesh M, Executor E = SerialExecutor>
Recombination recombine(const M& mesh, RecombineOptions options = {}, const E& executor = {}) {
  Recombination result;
  Stopwatch watch;
  const auto cancelled = [&] {
    result.status = Status::cancelled;
    result.mesh = {};
    return std::move(result);
  };
  const TetAdjacency validated = options.adjacency ? TetAdjacency{} : validated_adjacency(mesh);
  const TetAdjacency& adjacency = options.adjacency ? *options.adjacency : validated;
  const auto patches = detail::label_facets(adjacency, options.faces);
  const auto feature_edges = detail::vertex_pairs(options.edges);
  options.finder.regions = options.assembly.regions = options.regions;
  options.finder.facet_patches = patches;
  options.finder.feature_edges = feature_edges;
  options.finder.adjacency = &adjacency;
  options.finder.input_check = InputCheck::skip;
  options.assembly.faces = options.faces;
  options.assembly.edges = options.edges;
  options.finder.observer = options.selection.observer = options.assembly.observer = options.observer;

  PotentialHexahedra candidates = find_potential_hexahedra(mesh, options.finder, executor);
  if (candidates.status == Status::cancelled) return cancelled();
  result.n_candidates = candidates.size();
  watch.lap(result.seconds.search);

  result.selection =
      select(ImplicitIncompatibilityGraph(candidates, volume_times_quality(candidates)), options.selection, executor);
  watch.lap(result.seconds.selection);
  if (result.selection.status == SelectionStatus::cancelled) return cancelled();
  // The others are of no use any more, and many.
  const std::vector<index_t> members = result.selection.members;
  candidates = detail::chosen(candidates, members);
  std::vector<index_t> all(members.size());
  std::iota(all.begin(), all.end(), index_t{0});

  Assembly assembly = assemble(mesh, adjacency, candidates, all, options.assembly);
  watch.lap(result.seconds.assembly);
  if (assembly.status == Status::cancelled) return cancelled();
  result.mesh = std::move(assembly.mesh);
  result.open = std::move(assembly.open);
  result.assembly = assembly.statistics;
  return result;
}

}  // namespace framehex
