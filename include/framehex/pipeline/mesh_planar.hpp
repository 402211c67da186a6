// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/pipeline/detail/quad_mesher.hpp"
#include "framehex/surface/outline_triangulation.hpp"

namespace framehex {

template <Matcher Match, SizeField Size>
QuadMeshing mesh_planar(const PlanarOutline& outline, const Size& size, const Match& matcher,
                        const QuadMeshingOptions& options = {}) {
  check_options(options);
  return detail::QuadMesher<Match, Size>(matcher, size, options)
      .run(triangulate_outline(outline).surface(options.features));
}

}  // namespace framehex
