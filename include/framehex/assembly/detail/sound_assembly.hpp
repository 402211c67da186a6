// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/assemble.hpp"

#include <string>

namespace framehex::detail {

/// What a mixed mesh made of tetrahedra breaks of its promise.
struct BrokenPromise {
  std::vector<index_t> vertices;  ///< of the tetrahedra, near the faults; none when nobody knows where
  std::string fault;              ///< the first that was found, for a message; empty: the promise holds
  explicit operator bool() const { return !fault.empty(); }
};

/// Looks for cells that do not meet face to face or are not valid, and for a boundary or a volume that is not kept.
/// @param interfaces  in mode `open` quadrilaterals may face triangles, and the boundary cannot be told from them.
BrokenPromise find_broken_promise(const MixedMesh& mesh, std::span<const index_t> vertex_of, const TetAdjacency& tets,
                                  InterfaceMode interfaces, Pulse& pulse);

/// Marks vertices that are at most some edges away from others.
std::vector<std::uint8_t> ball_round(const TetAdjacency& tets, const std::vector<index_t>& centres,
                                     std::size_t n_rings);

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

#ifndef FRAMEHEX_COMPILED
#include "framehex/assembly/detail/sound_assembly_impl.hpp"
#endif
