// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/sound_assembly.hpp"
#include "framehex/verify/conformity.hpp"
#include "framehex/verify/kept_boundary.hpp"
#include "framehex/verify/validity.hpp"

namespace framehex::detail {

FRAMEHEX_INLINE BrokenPromise find_broken_promise(const MixedMesh& mesh, std::span<const index_t> vertex_of,
                                                  const TetAdjacency& tets, InterfaceMode interfaces, Pulse& pulse) {
  BrokenPromise broken;
  const auto add = [&](const char* fault, std::span<const index_t> vertices) {
    if (broken.fault.empty()) broken.fault = fault;
    for (const index_t v : vertices)
      if (v < vertex_of.size() && vertex_of[v] != no_index) broken.vertices.push_back(vertex_of[v]);
  };
  const auto add_cells = [&](const char* fault, const std::vector<index_t>& cells) {
    for (const index_t cell : cells) add(fault, mesh.cells[cell]);
  };
  const verify::ConformityReport conformity = verify::is_conforming(mesh);
  pulse.report(0.3);
  add_cells("a cell has a vertex twice", conformity.malformed_cells);
  if (!conformity.malformed_cells.empty()) return broken;
  add_cells("a cell is not valid", verify::is_valid(mesh).invalid_cells);
  pulse.report(0.6);
  if (interfaces == InterfaceMode::open) {
    for (const auto* faces : {&conformity.used_over_twice, &conformity.same_side, &conformity.twisted})
      for (const CellFace& face : *faces) add("cells do not meet face to face", mesh.cells[face.cell]);
    return broken;
  }
  if (!conformity.conforming()) add_cells("cells do not meet face to face", conformity.cells());
  for (const auto& edge : conformity.open_edges) add("the boundary is open", edge);
  const verify::KeptBoundaryReport boundary = verify::keeps_boundary(mesh, vertex_of, tets);
  pulse.report(0.9);
  for (const CellFace& face : boundary.strange)
    add("the boundary is not that of the tetrahedra", mesh.cells[face.cell]);
  for (const auto& facet : boundary.missing) {
    if (broken.fault.empty()) broken.fault = "the boundary is not that of the tetrahedra";
    broken.vertices.insert(broken.vertices.end(), facet.begin(), facet.end());
  }
  constexpr double rounding = 1e-9;
  if (!broken && verify::volume(mesh).relative_difference() > rounding) add("the volume is not kept", {});
  return broken;
}

FRAMEHEX_INLINE std::vector<std::uint8_t> ball_round(const TetAdjacency& tets, const std::vector<index_t>& centres,
                                                     std::size_t n_rings) {
  std::vector<std::uint8_t> inside(tets.n_vertices(), 0);
  std::vector<index_t> ring = centres, next;
  for (const index_t v : ring) inside[v] = 1;
  for (std::size_t i = 0; i < n_rings && !ring.empty(); ++i, std::swap(ring, next)) {
    next.clear();
    for (const index_t v : ring)
      for (const index_t w : tets.vertices_of_vertex[v])
        if (!std::exchange(inside[w], std::uint8_t{1})) next.push_back(w);
  }
  return inside;
}

}  // namespace framehex::detail
