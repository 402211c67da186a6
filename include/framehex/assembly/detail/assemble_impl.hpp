// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/assemble.hpp"
#include "framehex/assembly/detail/assembler.hpp"
#include "framehex/assembly/detail/cell_origins.hpp"
#include "framehex/assembly/detail/mixed_export.hpp"
#include "framehex/mesh/labels.hpp"

namespace framehex::detail {

FRAMEHEX_INLINE void add_up(const CellComplex& complex, AssemblyStatistics& statistics) {
  for (index_t cell = 0; cell < complex.cells.size(); ++cell) {
    if (!complex.cells[cell].alive) continue;
    const double volume = complex.volume(cell);
    statistics.volume += volume;
    if (complex.cells[cell].kind == CellKind::hexahedron) statistics.hexahedron_volume += volume;
  }
}

/// What faces each open quadrilateral, in the numbers of the exported mesh.
FRAMEHEX_INLINE std::vector<OpenInterface> list_open(const CellComplex& complex, const MixedExport& result) {
  std::vector<index_t> vertex(complex.n_vertices(), no_index), cell(complex.cells.size(), no_index);
  for (index_t i = 0; i < result.vertex_of.size(); ++i) vertex[result.vertex_of[i]] = i;
  for (index_t i = 0; i < result.cell_of.size(); ++i) cell[result.cell_of[i]] = i;
  std::vector<OpenInterface> list;
  for (const OpenQuad& quad : complex.open_quads) {
    if (!quad.open) continue;
    OpenInterface& interface = list.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) interface.quadrilateral[i] = vertex[quad.vertices[i]];
    interface.cell = cell[quad.cell];
    for (int i = 0; i < 2; ++i) {
      const index_t beyond = complex.across(quad.cell, quad.triangle(i));
      interface.triangle_cells[static_cast<std::size_t>(i)] = beyond == no_index ? no_index : cell[beyond];
    }
  }
  return list;
}

/// Fills the tables of vertices between the input and the result.
FRAMEHEX_INLINE void map_vertices(const CellComplex& complex, std::span<const index_t> complex_vertex,
                                  const std::vector<Vector3>& points, const TetAdjacency& adjacency, Assembly& result) {
  const auto is_removed = [&](index_t v) { return !adjacency.tets_of_vertex[v].empty() && complex.unused(v); };
  result.result_of.assign(points.size(), no_index);
  for (index_t i = 0; i < complex_vertex.size(); ++i) {
    const index_t v = complex_vertex[i];
    const bool is_new = v >= points.size();
    if (is_new)
      ++result.statistics.n_new_vertices;
    else if (is_removed(v))
      result.mesh.points[i] = points[v];  // where it was before it moved and went
    result.vertex_of.push_back(is_new || is_removed(v) ? no_index : v);
    if (result.vertex_of[i] != no_index) result.result_of[v] = i;
  }
  for (index_t v = 0; v < points.size(); ++v) {
    if (is_removed(v)) ++result.statistics.n_removed_vertices;
    if (result.result_of[v] != no_index && complex.points[v] != points[v]) result.moved.push_back(v);
  }
}

FRAMEHEX_INLINE Assembly assemble(const std::vector<Vector3>& points, const TetAdjacency& adjacency,
                                  const PotentialHexahedra& candidates, std::span<const index_t> selected,
                                  const AssemblyOptions& options) {
  check_options(options);
  check_regions(adjacency, options.regions);
  if (!options.faces.empty()) facet_labels(adjacency, options.faces);  // refuses those that are none
  check_labelled_edges(adjacency, options.edges);
  Assembly result;
  Pulse pulse(options.observer, "assembly");
  Assembler assembler(points, adjacency, candidates, options, result.statistics, pulse);
  if (!pulse.report(0) || !assembler.run(selected)) {
    Assembly nothing;
    nothing.status = Status::cancelled;
    return nothing;
  }
  const CellComplex& complex = assembler.complex();
  add_up(complex, result.statistics);
  const bool kept = options.vertex_numbers == VertexNumbers::kept;
  MixedExport exported = export_cells(complex, kept ? points.size() : 0);
  result.open = list_open(complex, exported);
  result.mesh = std::move(exported.mesh);
  map_vertices(complex, exported.vertex_of, points, adjacency, result);
  label_edges(result.mesh, result.result_of, options.edges);
  label_faces(result.mesh, exported.vertex_of, options.faces, assembler.other_cuts(), result.open);
  const CellOrigins origins(adjacency);
  for (const index_t id : exported.cell_of) {
    const auto& cell = complex.cells[id];
    result.candidate_of.push_back(cell.kind == CellKind::hexahedron ? cell.source : no_index);
    origins.append(cell, assembler.tets_of(cell), result.cell_of);
  }
  return result;
}

}  // namespace framehex::detail
