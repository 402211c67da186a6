// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/frame_field.hpp"
#include "framehex/field/singular_graph.hpp"
#include "framehex/pipeline/meshing_result.hpp"

namespace framehex::detail {

/// Notes what a field is like. @return its singular lines, as polylines.
template <class Field>
Csr<Vector3> describe(const Field& field, MeshingStatistics& s) {
  const auto& smoothness = field.smoothness();
  for (const double value : smoothness) {
    s.smoothness_mean += value / static_cast<double>(smoothness.size());
    s.fraction_smooth += (value >= 0.85 ? 1.0 : 0.0) / static_cast<double>(smoothness.size());
  }
  s.dirichlet_energy = field.dirichlet_energy();
  SingularGraph singular = singular_graph(field.adjacency(), field.points(), field.frames());
  s.n_singular_edges = singular.facets.size();
  return std::move(singular.polylines);
}

/// Frames and smoothness at the vertices of the result.
template <class Field>
void sample_field(const Field& field, MeshingResult& result) {
  index_t hint = no_index;
  for (const Vector3& p : result.recombination.mesh.points) {
    const FrameSample sample = field.sample(p, hint);
    result.frames.push_back(sample.frame);
    result.smoothness.push_back(sample.smoothness);
  }
}

}  // namespace framehex::detail
