// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/pipeline/mesh_surface.hpp"

/// What users of the library's own meshes call most, compiled once in the target `framehex::compiled`: a unit that
/// includes this header and links that target does not compile it again. Nothing else changes.
///
/// Compiled are `compute_frame_field`, `find_potential_hexahedra` and `recombine` of an `IndexedTetMesh`, `select` from an
/// `IncompatibilityGraph`, and `mesh_surface` of an `IndexedTriangleMesh` by `TetgenProcess` at a `ConstantSize`, each
/// for `SerialExecutor` and `ThreadExecutor`.

// src/compiled.cpp defines what all others declare.
#ifndef FRAMEHEX_INSTANTIATE
#define FRAMEHEX_INSTANTIATE extern template
#endif
#define FRAMEHEX_INSTANTIATE_FOR(Executor)                                                                            \
  FRAMEHEX_INSTANTIATE FrameField<IndexedTetMesh> compute_frame_field(const IndexedTetMesh&, const MeshFieldOptions&, \
                                                                      const Executor&, FieldReport*);                 \
  FRAMEHEX_INSTANTIATE PotentialHexahedra find_potential_hexahedra(const IndexedTetMesh&, const HexFinderOptions&,    \
                                                                   const Executor&);                                  \
  FRAMEHEX_INSTANTIATE Selection select(const IncompatibilityGraph&, const SelectOptions&, const Executor&);          \
  FRAMEHEX_INSTANTIATE Recombination recombine(const IndexedTetMesh&, RecombineOptions, const Executor&);             \
  FRAMEHEX_INSTANTIATE MeshingResult mesh_surface(const IndexedTriangleMesh&, const ConstantSize&,                    \
                                                  const TetgenProcess&, const MeshingOptions&, const Executor&)

namespace framehex {

FRAMEHEX_INSTANTIATE_FOR(SerialExecutor);
FRAMEHEX_INSTANTIATE_FOR(ThreadExecutor);

}  // namespace framehex

#undef FRAMEHEX_INSTANTIATE_FOR
#undef FRAMEHEX_INSTANTIATE
