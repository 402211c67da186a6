// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/assembler.hpp"
#include "framehex/assembly/detail/cell_origins.hpp"
#include "framehex/assembly/detail/mixed_export.hpp"
#include "framehex/mesh/labels.hpp"

namespace framehex {

/// A mixed mesh and where its parts come from.
///
/// The tetrahedral mesh is the input. With `VertexNumbers::kept`, the default, its vertices keep their numbers.
struct Assembly {
  MixedMesh mesh;
  std::vector<index_t> vertex_of;  ///< vertex -> vertex of the input, `no_index` for a new or removed one
  std::vector<index_t> result_of;  ///< the inverse: vertex of the input -> vertex, `no_index` for one that is left out
  std::vector<index_t> moved;      ///< vertices of the input that improvement moved, ascending
  std::vector<index_t> candidate_of;  ///< cell -> hexahedral candidate, `no_index` for cells of other kinds
  Csr<index_t> cell_of;             ///< cell -> the cells of the input that fill it, ascending; none if it is made anew
  std::vector<OpenInterface> open;  ///< quadrilaterals that face two triangles; empty unless in mode `open`
  AssemblyStatistics statistics;
  Status status = Status::complete;  ///< cancelled: there is no mesh
};

namespace detail {

inline void add_up(const CellComplex& complex, AssemblyStatistics& statistics) {
  for (index_t cell = 0; cell < complex.cells.size(); ++cell) {
    if (!complex.cells[cell].alive) continue;
    const double volume = complex.volume(cell);
    statistics.volume += volume;
    if (complex.cells[cell].kind == CellKind::hexahedron) statistics.hexahedron_volume += volume;
  }
}

/// What faces each open quadrilateral, in the numbers of the exported mesh.
inline std::vector<OpenInterface> list_open(const CellComplex& complex, const MixedExport& result) {
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
inline void map_vertices(const CellComplex& complex, std::span<const index_t> complex_vertex,
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

}  // namespace detail

/// Replaces the tetrahedra of the selected hexahedra by them, and closes the interfaces to the others.
///
/// First the hexahedra take the place of their tetrahedra; face slivers vanish into the quadrilaterals they lie in.
/// Then the mode decides on the quadrilaterals that face two triangles.
///
/// @param mesh        tetrahedra; coordinates are read, nothing is modified.
/// @param adjacency   of `mesh`.
/// @param candidates  potential hexahedra of `mesh`.
/// @param selected    the chosen candidates, in any order.
/// @param options     mode, quality bounds (scaled Jacobians), labels.
/// @pre `validate(mesh)` passes.
/// @return cells that fill the same domain, all valid by the exact test; in the two conforming modes no quadrilateral
///         faces a triangle: chosen cells at which closing fails are left out, and closing begins anew. New vertices are
///         inside only; vertices of the boundary stay, unless improvement may move them. When the observer stops it:
///         nothing, and `status` says so.
/// @throws incompatible_selection  with one candidate that does not fit the mesh, or two that do not fit together.
/// @throws invalid_option          a number outside its range; labels of regions of another count; the position of a
///                                 labelled face or edge that is none of the mesh, as `facet_labels` says.
/// @par Complexity   O(n) but for the search of places for new vertices, which is bounded per open quadrilateral; that
///                   again for each time that closing begins anew, which is rare but on meshes of very poor tetrahedra.
/// @par Determinism  Depends on nothing but the arguments.
/// @par Source       Owen, Canann, Saigal, Pyramid elements for maintaining tetrahedra to hexahedra conformability,
///                   1997. Departs: the cavity round the diagonal is filled from any of its vertices or from a new one,
///                   grows where that helps, and a hexahedron that cannot be closed well is split from its centre.
template <TetMesh M>
Assembly assemble(const M& mesh, const TetAdjacency& adjacency, const PotentialHexahedra& candidates,
                  std::span<const index_t> selected, const AssemblyOptions& options = {}) {
  check_options(options);
  check_regions(adjacency, options.regions);
  if (!options.faces.empty()) facet_labels(adjacency, options.faces);  // refuses those that are none
  check_labelled_edges(adjacency, options.edges);
  const std::vector<Vector3> points = positions(mesh);
  Assembly result;
  detail::Pulse pulse(options.observer, "assembly");
  detail::Assembler assembler(points, adjacency, candidates, options, result.statistics, pulse);
  if (!pulse.report(0) || !assembler.run(selected)) {
    Assembly nothing;
    nothing.status = Status::cancelled;
    return nothing;
  }
  const detail::CellComplex& complex = assembler.complex();
  detail::add_up(complex, result.statistics);
  const bool kept = options.vertex_numbers == VertexNumbers::kept;
  detail::MixedExport exported = detail::export_cells(complex, kept ? points.size() : 0);
  result.open = detail::list_open(complex, exported);
  result.mesh = std::move(exported.mesh);
  detail::map_vertices(complex, exported.vertex_of, points, adjacency, result);
  detail::label_edges(result.mesh, result.result_of, options.edges);
  detail::label_faces(result.mesh, exported.vertex_of, options.faces, assembler.other_cuts(), result.open);
  const detail::CellOrigins origins(adjacency);
  for (const index_t id : exported.cell_of) {
    const auto& cell = complex.cells[id];
    result.candidate_of.push_back(cell.kind == CellKind::hexahedron ? cell.source : no_index);
    origins.append(cell, assembler.tets_of(cell), result.cell_of);
  }
  return result;
}

}  // namespace framehex
