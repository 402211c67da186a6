// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/sound_assembly.hpp"
#include "framehex/mesh/labels.hpp"
#include "framehex/mesh/validation.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/pipeline/detail/stopwatch.hpp"
#include "framehex/recombination/detail/chosen.hpp"
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
  std::span<const LabelledFace> faces = {};  ///< triangles on the boundary or inside, with their patches; stay faces
  std::span<const LabelledEdge> edges = {};  ///< feature edges; they stay edges
  const TetAdjacency* adjacency = nullptr;   ///< of the mesh, by those who have checked it already; else null
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    FinderOptions::each_number(o.finder, visit);
    SelectOptions::each_number(o.selection, visit);
    AssemblyOptions::each_number(o.assembly, visit);
  }
};

/// A recombined mesh, where its parts come from, and how it came about.
///
/// Vertices of the host keep their numbers and places, isolated ones too: point v of the result is vertex v of the host,
/// unless `moved` lists it, or `result_of` says that no cell uses it any longer. New vertices follow. With
/// `ImprovementMode::none` all stay. (`VertexNumbers::compact` gives up the numbers and not the tables.)
struct Recombination {
  MixedMesh mesh;
  std::vector<index_t> vertex_of;  ///< vertex -> vertex of the host, `no_index` for a new or removed one
  std::vector<index_t> result_of;  ///< the inverse: vertex of the host -> vertex, `no_index` for one that is left out
  std::vector<index_t> moved;      ///< vertices of the host that improvement moved, ascending
  std::vector<index_t> candidate_of;  ///< cell -> hexahedral candidate, `no_index` for cells of other kinds
  Csr<index_t> cell_of;               ///< cell -> the host's cells that fill it, ascending; none if it is made anew
  std::size_t n_candidates = 0;       ///< potential hexahedra
  Selection selection;
  std::vector<OpenInterface> open;  ///< quadrilaterals that face two triangles, in mode `open`
  AssemblyStatistics assembly;
  std::size_t n_given_up = 0;  ///< chosen hexahedra left out because a mesh with them did not pass its check
  StageSeconds seconds;
  Status status = Status::complete;
};

namespace detail {

inline std::vector<std::array<index_t, 2>> vertex_pairs(std::span<const LabelledEdge> edges) {
  std::vector<std::array<index_t, 2>> pairs;
  for (const LabelledEdge& edge : edges) pairs.push_back(edge.vertices);
  return pairs;
}

}  // namespace detail

/// Turns a tetrahedral mesh into a hex-dominant one, without needing anything else of framehex. Its boundary vertices stay
/// (unless `assembly.boundary_projection` lets them slide); inside, improvement moves, removes and adds some, unless
/// `assembly.improvement` is `none`.
///
/// The mesh is checked before it is handed out: it conforms (but for the quadrilaterals listed in mode `open`), every cell is
/// valid by the exact test, and each face of the boundary is a triangle of the host's, or two. Two that bend become a bilinear
/// patch through their four corners, and the volume changes by what lies between: label edges that must stay.
///
/// @param mesh     n tetrahedra; validated first.
/// @param options  quality floor, selection, interfaces, labels of facets and edges of the mesh.
/// @return the mixed mesh, and which cells and vertices of the host its own are. When cancelled the mesh is empty and
///         `status` says so.
/// @throws what `validate` throws, before any work; `invalid_option` for a number outside its range, labels of regions of
///         another count, or with the position of a labelled face or edge that is none of the mesh; `unsound_mesh`
///         when the result does not pass its check, which would be a defect.
/// @par Complexity   O(n) for the search and the assembly; the selection has its budget.
/// @par Determinism  The same for any executor, unless the selection is stopped by its time budget.
template <TetMesh M, Executor E = SerialExecutor>
Recombination recombine(const M& mesh, RecombineOptions options = {}, const E& executor = {}) {
  check_options(options);
  Recombination result;
  Stopwatch watch;
  const auto cancelled = [&] {
    result.status = Status::cancelled;
    result.mesh = {};
    return std::move(result);
  };
  // The host is read here and no more: what follows has what was checked.
  const detail::CheckedTets read =
      options.adjacency ? detail::CheckedTets{positions(mesh), {}} : detail::checked_tets(mesh);
  const TetAdjacency& adjacency = options.adjacency ? *options.adjacency : read.adjacency;
  const TetView tets{read.points, adjacency.tets};
  check_regions(adjacency, options.regions);
  check_labelled_edges(adjacency, options.edges);
  std::vector<std::array<index_t, 4>> patches;
  if (!options.faces.empty()) patches = facet_labels(adjacency, options.faces);
  const auto feature_edges = detail::vertex_pairs(options.edges);
  options.finder.regions = options.assembly.regions = options.regions;
  options.finder.facet_patches = patches;
  options.finder.feature_edges = feature_edges;
  options.finder.adjacency = &adjacency;
  options.finder.input_check = InputCheck::skip;
  options.assembly.faces = options.faces;
  options.assembly.edges = options.edges;
  options.finder.observer = options.selection.observer = options.assembly.observer = options.observer;

  PotentialHexahedra candidates = find_potential_hexahedra(tets, options.finder, executor);
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

  const auto assemble_chosen = [&](std::span<const index_t> selected, const AssemblyOptions& how) {
    return assemble(tets, adjacency, candidates, selected, how);
  };
  auto [assembly, n_given_up] =
      detail::assemble_soundly(assemble_chosen, adjacency, candidates, std::move(all), options.assembly);
  result.n_given_up = n_given_up;
  watch.lap(result.seconds.assembly);
  if (assembly.status == Status::cancelled) return cancelled();
  result.mesh = std::move(assembly.mesh);
  result.vertex_of = std::move(assembly.vertex_of);
  result.result_of = std::move(assembly.result_of);
  result.moved = std::move(assembly.moved);
  result.candidate_of = std::move(assembly.candidate_of);
  for (index_t& candidate : result.candidate_of)
    if (candidate != no_index) candidate = members[candidate];
  result.cell_of = std::move(assembly.cell_of);
  result.open = std::move(assembly.open);
  result.assembly = assembly.statistics;
  return result;
}

}  // namespace framehex
