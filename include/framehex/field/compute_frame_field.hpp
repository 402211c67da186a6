// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/frame_field.hpp"
#include "framehex/mesh/boundary.hpp"

namespace framehex {

/// Which field.
enum class FieldMethod {
  nearest,   ///< of the nearest boundary point (the paper's NN)
  smoothed,  ///< that, smoothed (the paper's Sm)
  best,      ///< harmonic start, diffusion and projection, polish
};

struct FieldOptions {
  FieldMethod method = FieldMethod::best;
  /// Surface vertex -> vertex of the tetrahedral mesh; empty: the surface's vertices are the mesh's first, in order.
  std::vector<index_t> vertex_of = {};
  BoundaryFrameOptions boundary = {};
  SmoothingOptions smoothing = {};
  Observer observer = {};
};

/// How a field was made.
struct FieldReport {
  SmoothingReport smoothing;
  Status status = Status::complete;
};

/// The field of a background mesh from the crosses of its surface.
///
/// @param mesh             tetrahedra filling `surface`; vertices of its boundary that `options.vertex_of` does not
/// name
///                         are free.
/// @param surface, features  outward triangles and their features.
/// @param triangle_frames  n_triangles unit quaternions, z the outward normal (`SurfaceCrossField::frames`).
/// @param report           receives the course of the computation; may be null.
/// @return a field without NaN, all quaternions unit.
/// @throws nonmanifold, invalid_field, invalid_option  as `make_adjacency`, `make_boundary_frames`,
/// `FrameField::constrain`,
///                         `smooth_frames`; entities are numbered in the surface.
template <TetMesh Mesh, class E = SerialExecutor>
FrameField<Mesh> compute_frame_field(const Mesh& mesh, const IndexedTriangleMesh& surface, const FeatureGraph& features,
                                     std::span<const Quaternion> triangle_frames, const FieldOptions& options = {},
                                     const E& executor = {}, FieldReport* report = nullptr) {
  const BoundaryFrames boundary =
      make_boundary_frames(surface, make_adjacency(surface), features, triangle_frames, options.boundary);
  FrameField<Mesh> field(mesh);
  field.constrain(boundary, options.vertex_of);
  field.start_nearest(surface, boundary, SurfaceLocator(surface), executor);
  FieldReport course;
  if (options.method != FieldMethod::nearest) {
    field.fix_boundary();
    SmoothingOptions smoothing = options.smoothing;
    if (!smoothing.observer) smoothing.observer = options.observer;
    course.smoothing = field.smooth(smoothing, executor);
    if (course.smoothing.status == Status::cancelled) course.status = Status::cancelled;
  }
  if (report) *report = std::move(course);
  return field;
}

}  // namespace framehex
