// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/mixed_output.hpp"
#include "framehex/pipeline/recombine.hpp"

namespace framehex {

/// `recombine`, with the result written into a mesh of the host's own.
///
/// @param output   is told of nothing until all is done: when cancelled, or when the input is refused, it is as it was.
///                 The i-th call of `add_vertex` and of `add_cell` make vertex and cell i of the tables returned.
/// @param mesh     as for `recombine`; must not be the mesh that `output` writes to.
/// @param options  as for `recombine`. `VertexNumbers::compact` if the host wants no vertex without a cell.
/// @return as `recombine` does; `mesh` is empty.
/// @throws what `recombine` and `output` throw; in the second case the host's mesh holds a part.
/// @par Complexity   that of `recombine`. On the way the result is held once, in flat arrays.
template <MixedOutput O, TetMesh M, Executor E = SerialExecutor>
Recombination recombine_into(O& output, const M& mesh, const RecombineOptions& options = {}, const E& executor = {}) {
  Recombination result = recombine(mesh, options, executor);
  export_mesh(result.mesh, output);
  result.mesh = {};
  return result;
}

}  // namespace framehex
