// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/validation.hpp"
#include "framehex/pipeline/detail/quad_mesher.hpp"

namespace framehex {

template <TriangleMesh M, Matcher Match, SizeField Size>
QuadMeshing mesh_shell(const M& surface, const Size& size, const Match& matcher,
                       const QuadMeshingOptions& options = {}) {
  check_options(options);
  validate_surface(surface);
  return detail::QuadMesher<Match, Size>(matcher, size, options).run(Surface(surface, options.features));
}

}  // namespace framehex
