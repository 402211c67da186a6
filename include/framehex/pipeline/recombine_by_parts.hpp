// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/recombine_in_parts.hpp"
#include "framehex/pipeline/recombine.hpp"

namespace framehex {

namespace detail {

/// A mesh in one place, recombined in parts, as an assembly of the host's vertices and cells.
Assembly join_parts(const std::vector<Vector3>& points, const TetAdjacency& adjacency, VertexNumbers numbers,
                    PartRecombination part);

}  // namespace detail

/// `recombine` in parts: closing and improvement, prisms and contenders are worked on by all threads of the executor at the
/// same time, and the result depends on the numbering no more. With one thread `recombine` takes half the time.
///
/// @param mesh       as for `recombine`.
/// @param options    as for `recombine`, without labelled faces and edges, `boundary_projection` and `free_tets`; interfaces are
///                   `conforming`, cells fit elements of any kind.
/// @param part_size  tetrahedra of a part, at most; 1 or more. See docs/parts.md for what it costs to be small.
/// @return as `recombine` does; the selection's bound is the sum of those of the parts.
/// @throws what `recombine` throws; invalid_option for what is not offered.
/// @par Complexity   that of `recombine`, twice, and up to half as much memory again.
/// @par Determinism  Depends on places and `part_size` alone, but for the numbers in its tables.
template <TetMesh M, Executor E = SerialExecutor>
Recombination recombine_by_parts(const M& mesh, const RecombineOptions& options = {}, std::size_t part_size = 250000,
                                 const E& executor = {}) {
  check_options(options);
  if (!options.faces.empty() || !options.edges.empty() || !options.finder.free_tets.empty() ||
      options.assembly.interfaces != InterfaceMode::conforming)
    throw invalid_option("parts have no labelled faces or edges, take all tetrahedra, and close all interfaces");
  // The host is read here and no more: what follows has what was checked.
  const detail::CheckedTets read =
      options.adjacency ? detail::CheckedTets{positions(mesh), {}} : detail::checked_tets(mesh);
  const TetAdjacency& adjacency = options.adjacency ? *options.adjacency : read.adjacency;
  check_regions(adjacency, options.regions);
  const std::vector<Vector3>& points = read.points;
  std::vector<global_t> vertices(points.size()), cells(adjacency.tets.size());
  std::iota(vertices.begin(), vertices.end(), global_t{0});
  std::iota(cells.begin(), cells.end(), global_t{0});
  PartsOptions how{.finder = options.finder,
                   .selection = options.selection,
                   .assembly = options.assembly,
                   .part_size = part_size,
                   .observer = options.observer};
  how.finder.input_check = InputCheck::skip;
  Recombination result;
  PartRecombination part =
      recombine_in_parts({points, adjacency.tets, vertices, cells, options.regions}, how, executor);
  result.status = part.status;
  if (part.status == Status::cancelled) return result;
  result.n_candidates = static_cast<std::size_t>(part.n_candidates);
  result.n_given_up = static_cast<std::size_t>(part.n_given_up);
  result.selection.members = std::move(part.chosen);
  result.selection.weight = part.weight;
  result.selection.bound = part.bound;
  result.seconds.search = part.search_seconds;
  result.seconds.selection = part.selection_seconds;
  result.seconds.assembly = part.assembly_seconds;
  Assembly assembly = detail::join_parts(points, adjacency, options.assembly.vertex_numbers, std::move(part));
  result.mesh = std::move(assembly.mesh);
  result.vertex_of = std::move(assembly.vertex_of);
  result.result_of = std::move(assembly.result_of);
  result.moved = std::move(assembly.moved);
  result.candidate_of = std::move(assembly.candidate_of);
  result.cell_of = std::move(assembly.cell_of);
  result.assembly = assembly.statistics;
  return result;
}

}  // namespace framehex

#ifndef FRAMEHEX_COMPILED
#include "framehex/pipeline/detail/recombine_by_parts_impl.hpp"
#endif
