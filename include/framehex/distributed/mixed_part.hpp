// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/mixed_mesh.hpp"

#include <cstdint>

namespace framehex::distributed {

/// A vertex that another rank has, too.
struct SharedWith {
  index_t vertex;
  int rank;
};

/// A rank's cells of a distributed mesh of any cells, as they are to be written. Spans must outlive the call only.
struct MixedPart {
  const MixedMesh& mesh;
  std::span<const std::int64_t> vertex_ids;  ///< global numbers
  std::span<const std::int64_t> cell_ids;
  std::span<const int> owners;         ///< of the vertices
  std::span<const SharedWith> shared;  ///< with every other rank that has the vertex
};

}  // namespace framehex::distributed
