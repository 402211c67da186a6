// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/assemble.hpp"
#include "framehex/verify/conformity.hpp"
#include "framehex/verify/kept_boundary.hpp"
#include "framehex/verify/validity.hpp"

namespace framehex::detail {

/// What a mixed mesh made of tetrahedra breaks of its promise.
struct BrokenPromise {
  std::vector<index_t> vertices;  ///< of the tetrahedra, near the faults; none when nobody knows where
  std::string fault;              ///< the first that was found, for a message; empty: the promise holds
  explicit operator bool() const { return !fault.empty(); }
};

/// Looks for cells that do not meet face to face or are not valid, and for a boundary or a volume that is not kept.
/// @param interfaces  in mode `open` quadrilaterals may face triangles, and the boundary cannot be told from them.
inline BrokenPromise find_broken_promise(const MixedMesh& mesh, std::span<const index_t> vertex_of,
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

/// Marks vertices that are at most some edges away from others.
inline std::vector<std::uint8_t> ball_round(const TetAdjacency& tets, const std::vector<index_t>& centres,
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

/// A mesh that has passed its checks, and how many of the chosen hexahedra it was made without for that.
struct SoundAssembly {
  Assembly assembly;
  std::size_t n_given_up = 0;
};

/// Assembles, checks the result, and where it breaks its promise assembles anew without the chosen hexahedra in a ball round
/// the faults.
///
/// Ends: the ball's radius doubles from round to round until it holds all, and at last there are no hexahedra, prisms or
/// improvements: the tetrahedra as they came.
///
/// @param assemble    callable: chosen candidates, options -> Assembly.
/// @param selected    candidates, ascending.
/// @throws unsound_mesh  when even that does not pass, with the vertices of the tetrahedra near the fault.
template <class Assemble>
SoundAssembly assemble_soundly(Assemble&& assemble, const TetAdjacency& tets, const PotentialHexahedra& candidates,
                               std::vector<index_t> selected, AssemblyOptions options) {
  SoundAssembly result;
  for (std::size_t n_rings = 1;; n_rings *= 2) {
    result.assembly = assemble(selected, options);
    if (result.assembly.status != Status::complete) return result;
    Pulse pulse(options.observer, "checks");
    const BrokenPromise broken =
        find_broken_promise(result.assembly.mesh, result.assembly.vertex_of, tets, options.interfaces, pulse);
    if (!pulse.report(1)) return {cancelled<Assembly>(), result.n_given_up};
    if (!broken) return result;
    if (options.prisms == PrismMode::none && selected.empty() && options.improvement == ImprovementMode::none)
      throw unsound_mesh("the mesh that was made does not pass its own check: " + broken.fault, Entity::vertex,
                         {broken.vertices.begin(), broken.vertices.end()});
    const std::vector<std::uint8_t> ball = ball_round(tets, broken.vertices, n_rings);
    const std::size_t n_given_up = std::erase_if(selected, [&](index_t candidate) {
      return broken.vertices.empty() ||
             std::ranges::any_of(candidates.vertices[candidate], [&](index_t v) { return ball[v] != 0; });
    });
    result.n_given_up += n_given_up;
    if (!selected.empty() && (n_given_up > 0 || n_rings < tets.n_vertices())) continue;
    result.n_given_up += selected.size();
    selected.clear();
    options.prisms = PrismMode::none;
    options.improvement = ImprovementMode::none;
  }
}

}  // namespace framehex::detail
