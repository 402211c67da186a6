// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/compute_frame_field.hpp"
#include "framehex/lattice/periodic_parameterization.hpp"
#include "support/surfaces.hpp"
#include "support/unstructured.hpp"

namespace framehex::test {

/// A tetrahedral mesh with a frame per vertex, and its boundary.
struct Body {
  IndexedTetMesh mesh;
  TetAdjacency adjacency;
  BoundarySurface boundary;
  Surface surface;
  std::vector<Quaternion> frames;

  explicit Body(IndexedTetMesh tets)
      : mesh(std::move(tets)),
        adjacency(make_adjacency(mesh)),
        boundary(extract_boundary(mesh, adjacency)),
        surface(boundary.surface),
        frames(mesh.points.size(), Quaternion::Identity()) {}

  template <class E = SerialExecutor>
  LatticePoints lattice(double size, LatticeReport* report = nullptr, const E& executor = {},
                        const LatticeOptions& options = {}) const {
    return place_lattice(adjacency, mesh.points, frames, surface, ConstantSize{size}, options, executor, report,
                         boundary.vertex_of);
  }
};

}  // namespace framehex::test
