// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/complex_builder.hpp"
#include "framehex/assembly/detail/improver.hpp"
#include "framehex/assembly/detail/interface_closer.hpp"
#include "framehex/assembly/detail/mixed_export.hpp"
#include "framehex/assembly/detail/prism_chooser.hpp"
#include "framehex/assembly/detail/pyramid_free.hpp"

namespace framehex {

/// A mixed mesh and where its parts come from.
struct Assembly {
  MixedMesh mesh;
  std::vector<index_t> vertex_of;     ///< vertex -> vertex of the tetrahedral mesh, `no_index` for a new one
  std::vector<index_t> candidate_of;  ///< cell -> hexahedral candidate, `no_index` for cells of other kinds
  std::vector<OpenInterface> open;    ///< quadrilaterals that face two triangles; empty unless in mode `open`
  AssemblyStatistics statistics;
  Status status = Status::complete;  ///< cancelled: there is no mesh
};

namespace detail {

inline void add_selection(ComplexBuilder& builder, const PotentialHexahedra& candidates,
                          std::span<const index_t> selected) {
  for (const index_t candidate : selected) {
    if (candidate >= candidates.size())
      throw incompatible_selection("candidate " + std::to_string(candidate) + " does not exist", Entity::candidate,
                                   {candidate});
    const auto refusal =
        builder.add(CellKind::hexahedron, candidates.vertices[candidate], candidates.tets[candidate], candidate);
    if (!refusal.reason) continue;
    if (refusal.other == no_index)
      throw incompatible_selection("candidate " + std::to_string(candidate) + " does not fit: " + refusal.reason,
                                   Entity::candidate, {candidate});
    const index_t other = builder.complex.cells[refusal.other].source;
    throw incompatible_selection("candidates " + std::to_string(other) + " and " + std::to_string(candidate) +
                                     " do not fit together: " + refusal.reason,
                                 Entity::candidate, {other, candidate});
  }
  for (index_t cell = 0; cell < builder.complex.cells.size(); ++cell)
    if (!builder.complex.valid(cell))
      throw incompatible_selection(
          "candidate " + std::to_string(builder.complex.cells[cell].source) + " is not a valid hexahedron",
          Entity::candidate, {builder.complex.cells[cell].source});
}

inline void check_labels(const TetAdjacency& adjacency, const AssemblyOptions& options) {
  if (!options.regions.empty() && options.regions.size() != adjacency.tets.size())
    throw invalid_option(std::to_string(options.regions.size()) + " region labels for " +
                         std::to_string(adjacency.tets.size()) + " tetrahedra");
  const auto check = [&](index_t v) {
    if (v >= adjacency.n_vertices())
      throw invalid_option("a label refers to vertex " + std::to_string(v) + ", which does not exist", Entity::vertex,
                           {v});
  };
  for (const LabelledFace& face : options.faces)
    for (std::size_t i = 0; i < face.size(); ++i) check(face.vertices[i]);
  for (const LabelledEdge& edge : options.edges)
    for (const index_t v : edge.vertices) check(v);
}

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
///         faces a triangle. New vertices are inside only; vertices of the boundary stay, unless improvement may move
///         them. When the observer stops it: nothing, and `status` says so.
/// @throws incompatible_selection  with one candidate that does not fit the mesh, or two that do not fit together.
/// @throws invalid_option          labels of the wrong size or out of range.
/// @par Complexity   O(n) but for the search of places for new vertices, which is bounded per open quadrilateral.
/// @par Determinism  Depends on nothing but the arguments.
/// @par Source       Owen, Canann, Saigal, Pyramid elements for maintaining tetrahedra to hexahedra conformability,
///                   1997. Departs: the cavity round the diagonal is filled from any of its vertices or from a new one,
///                   grows where that helps, and a hexahedron that cannot be closed well is split from its centre.
template <TetMesh M>
Assembly assemble(const M& mesh, const TetAdjacency& adjacency, const PotentialHexahedra& candidates,
                  std::span<const index_t> selected, const AssemblyOptions& options = {}) {
  detail::check_labels(adjacency, options);
  PotentialPrisms prisms;
  detail::Pulse pulse(options.observer, "assembly");
  const auto cancelled = [] {
    Assembly nothing;
    nothing.status = Status::cancelled;
    return nothing;
  };
  if (!pulse.report(0)) return cancelled();
  detail::ComplexBuilder builder(positions(mesh), adjacency, options);
  detail::add_selection(builder, candidates, selected);
  Assembly result;
  AssemblyStatistics& statistics = result.statistics;
  detail::CellComplex& complex = builder.complex;
  for (index_t cell = 0; cell < complex.cells.size(); ++cell)
    statistics.hexahedron_volume_chosen += complex.volume(cell);
  if (!pulse.report(0.05)) return cancelled();
  if (options.prisms == PrismMode::chosen) {
    const Observer observer = [&](const Progress& p) { return pulse.report(0.05 + 0.05 * p.fraction); };
    prisms = detail::find_free_prisms(builder, adjacency, options,
                                      {.quality_floor = options.prism_quality_floor, .observer = observer});
    if (prisms.status == Status::cancelled) return cancelled();
    detail::choose_prisms(builder, prisms, options.interfaces == InterfaceMode::open ? 3 : 1);
  }
  builder.finish();
  if (!pulse.report(0.1)) return cancelled();

  const detail::Originals originals{adjacency, candidates, prisms};
  statistics.n_open_quadrilaterals = complex.open_quads.size();
  detail::VertexSmoother::Projection projection;
  if (options.boundary_projection)
    projection = [&](index_t v, Vector3& place) {
      return v < adjacency.n_vertices() && options.boundary_projection(v, place);
    };
  detail::Improver improver(complex, detail::QualityEnergy::reaching(options.hexahedron_target, options.quality_target),
                            projection, statistics, pulse);
  const bool improve = options.improvement == ImprovementMode::improve;
  if (options.interfaces == InterfaceMode::no_pyramids) {
    detail::PyramidFreeCloser(complex, originals, options.prism_quality_floor, statistics, pulse).close_all();
  } else {
    detail::InterfaceCloser closer(complex, originals, options.quality_floor, statistics, pulse);
    closer.merge_pairs(options.quality_floor);
    if (options.interfaces == InterfaceMode::conforming) {
      if (improve) improver.reconnect();
      closer.close_all();
    }
  }
  if (improve) improver.run(8, options.interfaces == InterfaceMode::conforming);
  if (!pulse.report(1)) return cancelled();
  detail::add_up(complex, statistics);

  detail::MixedExport exported = detail::export_cells(complex);
  result.open = detail::list_open(complex, exported);
  result.mesh = std::move(exported.mesh);
  detail::label_edges(result.mesh, exported.vertex_of, options.edges);
  std::vector<LabelledFace> labels(options.faces.begin(), options.faces.end());
  labels.insert(labels.end(), builder.extra_labels.begin(), builder.extra_labels.end());
  detail::label_faces(result.mesh, exported.vertex_of, labels, result.open);
  for (const index_t v : exported.vertex_of) result.vertex_of.push_back(v < adjacency.n_vertices() ? v : no_index);
  statistics.n_new_vertices =
      static_cast<std::size_t>(std::count(result.vertex_of.begin(), result.vertex_of.end(), no_index));
  for (index_t v = 0; v < adjacency.n_vertices(); ++v)
    statistics.n_removed_vertices +=
        static_cast<std::size_t>(!adjacency.tets_of_vertex[v].empty() && complex.unused(v));
  for (const index_t cell : exported.cell_of)
    result.candidate_of.push_back(complex.cells[cell].kind == CellKind::hexahedron ? complex.cells[cell].source
                                                                                   : no_index);
  return result;
}

}  // namespace framehex
