// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/frame_measures.hpp"
#include "framehex/observer.hpp"
#include "framehex/surface/surface.hpp"
#include "framehex/surface/surface_locator.hpp"

namespace framehex {

/// Gives every vertex without a constraint the frame of the nearest point of the boundary.
///
/// The point is the nearest on the triangles, not the nearest vertex, and its frame the mean of the three corners'.
///
/// @param points       n_vertices positions. @param constraints  n_vertices; only vertices with `none` are changed.
/// @param surface      whose vertices have the frames `boundary.frames`. @param locator  of `surface`.
/// @param frames       n_vertices unit quaternions, changed in place.
/// @param executor     results do not depend on it. @param observer  asked between blocks of vertices.
/// @return complete, or cancelled: some vertices have their frame, the others the one they had.
/// @par Complexity   O(log n) a vertex.
/// @par Source       The paper, section 3.3 (the initial condition).
template <Executor E = SerialExecutor>
Status start_nearest(std::span<const Vector3> points, std::span<const FrameConstraint> constraints,
                     const Surface& surface, const BoundaryFrames& boundary, const SurfaceLocator& locator,
                     std::span<Quaternion> frames, const E& executor = {}, const Observer& observer = {}) {
  if (surface.triangles().empty()) return Status::complete;
  bool stopped = false;
  const StoppableExecutor heard(executor, [&] { return stopped = !keep_going(observer, "frame field", 0); });
  for_blocks(heard, points.size(), detail::block_size, [&](std::size_t first, std::size_t last) {
    for (std::size_t v = first; v < last; ++v) {
      if (constraints[v] != FrameConstraint::none) continue;
      const SurfacePoint at = locator.nearest(points[v]);
      const auto& t = surface.triangles()[at.triangle];
      frames[v] = detail::mean_frame<3>({boundary.frames[t[0]], boundary.frames[t[1]], boundary.frames[t[2]]},
                                        {at.barycentric[0], at.barycentric[1], at.barycentric[2]});
    }
  });
  return stopped ? Status::cancelled : Status::complete;
}

}  // namespace framehex
