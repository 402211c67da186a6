// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/compute_frame_field.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/pipeline/recombine.hpp"

/// What users of the library's own meshes call most, compiled once in the target `framehex::compiled`: a unit that
/// includes this header and links that target does not compile it again. Nothing else changes.
///
/// Compiled are `compute_frame_field`, `find_potential_hexahedra` and `recombine` of an `IndexedTetMesh`, `select` from an
/// `IncompatibilityGraph`, each for `SerialExecutor` and `ThreadExecutor`. `mesh_surface` needs nothing of this header: it
/// is in `framehex::compiled` for any surface, size field, tetrahedraliser and executor.

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
  FRAMEHEX_INSTANTIATE Recombination recombine(const IndexedTetMesh&, RecombineOptions, const Executor&)

namespace framehex {

FRAMEHEX_INSTANTIATE_FOR(SerialExecutor);
FRAMEHEX_INSTANTIATE_FOR(ThreadExecutor);

}  // namespace framehex

#undef FRAMEHEX_INSTANTIATE_FOR
#undef FRAMEHEX_INSTANTIATE
