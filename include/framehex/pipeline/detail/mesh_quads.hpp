// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/pipeline/quad_meshing.hpp"

namespace framehex::detail {

/// Meshes a surface; where a small mesh has poor cells, again with other points inside its patches, of which there are
/// many that are as good. The best mesh is kept.
QuadMeshing mesh_quads(const Surface& input, const SizeFieldRef& size, const MatcherRef& matcher,
                       QuadMeshingOptions options);

}  // namespace framehex::detail

#ifndef FRAMEHEX_COMPILED
#include "framehex/pipeline/detail/mesh_quads_impl.hpp"
#endif
