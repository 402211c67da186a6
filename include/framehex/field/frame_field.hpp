// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/detail/loop_removal.hpp"
#include "framehex/field/detail/nearest_start.hpp"
#include "framehex/field/detail/representatives.hpp"
#include "framehex/field/frame_diffusion.hpp"
#include "framehex/field/singular_graph.hpp"
#include "framehex/field/smoothing.hpp"
#include "framehex/field/tet_locator.hpp"

#include <memory>

namespace framehex {

/// The field at a point.
struct FrameSample {
  Quaternion frame = Quaternion::Identity();  ///< unit
  double smoothness = 1;
  index_t tet = no_index;  ///< that holds the point, or was reached
};

/// A frame at every vertex of a tetrahedral mesh, for those who go step by step; see `compute_frame_field` for the
/// whole in one call.
///
/// Vertices, cells and triangles are dense indices in the host's order. The host's mesh is read once, by the
/// constructor. Frames are unit quaternions at all times. Copies share the geometry. Const members may be called from
/// several threads at once.
template <TetMesh Mesh>
class FrameField {
public:
  /// All frames are the identity and none has a constraint.
  /// @pre `validate(mesh)` passes. @throws nonmanifold  as `make_adjacency`.
  explicit FrameField(const Mesh& mesh) : FrameField(mesh, make_adjacency(mesh)) {}

  /// @param adjacency  of `mesh`.
  FrameField(const Mesh& mesh, TetAdjacency adjacency) : FrameField(std::move(adjacency), positions(mesh)) {}

  /// @param points  of the mesh whose adjacency it is, one a vertex.
  FrameField(TetAdjacency adjacency, std::vector<Vector3> points)
      : locator_(std::make_shared<const TetLocator>(std::move(adjacency), std::move(points))),
        frames_(n_vertices(), Quaternion::Identity()),
        smoothness_(n_vertices(), 1.0),
        constraints_(n_vertices(), FrameConstraint::none),
        axes_(n_vertices(), Vector3::Zero()) {}

  std::size_t n_vertices() const { return locator_->points().size(); }
  const std::vector<Quaternion>& frames() const { return frames_; }
  const std::vector<double>& smoothness() const { return smoothness_; }
  const std::vector<FrameConstraint>& constraints() const { return constraints_; }
  const std::vector<Vector3>& axes() const { return axes_; }
  const TetAdjacency& adjacency() const { return locator_->adjacency(); }
  const std::vector<Vector3>& points() const { return locator_->points(); }
  const std::shared_ptr<const TetLocator>& locator() const { return locator_; }

  /// Replaces all frames and brings the smoothness up to date; constraints are not looked at.
  /// @throws invalid_field  with the first vertex whose quaternion is not a unit one; invalid_option when their number
  ///                        is not n_vertices.
  template <Executor E = SerialExecutor>
  void set_frames(std::vector<Quaternion> frames, const E& executor = {}) {
    if (frames.size() != n_vertices())
      throw invalid_option("there are " + std::to_string(frames.size()) + " frames for " +
                           std::to_string(n_vertices()) + " vertices");
    for (std::size_t v = 0; v < frames.size(); ++v)
      if (!(std::abs(frames[v].norm() - 1) < 1e-6))
        throw invalid_field("the frame of vertex " + std::to_string(v) + " is not a unit quaternion", Entity::vertex,
                            {v});
    frames_ = std::move(frames);
    smoothness_ = frame_smoothness(adjacency(), frames_, ExecutorRef(executor));
  }

  /// Gives the vertices of the boundary their frames and constraints.
  ///
  /// @param vertex_of  surface vertex -> vertex of this mesh; empty: the same number.
  /// @throws invalid_option  with the surface vertex whose number is out of range.
  void constrain(const BoundaryFrames& boundary, std::span<const index_t> vertex_of = {}) {
    for (std::size_t s = 0; s < boundary.frames.size(); ++s) {
      const std::size_t v = vertex_of.empty() ? s : s < vertex_of.size() ? vertex_of[s] : n_vertices();
      if (v >= n_vertices())
        throw invalid_option("surface vertex " + std::to_string(s) + " is not a vertex of the mesh", Entity::vertex,
                             {s});
      frames_[v] = boundary.frames[s];
      constraints_[v] = boundary.constraints[s];
      axes_[v] = boundary.axes[s];
    }
  }

  /// Fixes the frames that have an axis only, as the paper does: the cross field of the surface is kept.
  void fix_boundary() {
    for (FrameConstraint& c : constraints_)
      if (c == FrameConstraint::axis) c = FrameConstraint::fixed;
  }

  /// Start from the nearest boundary point; see `framehex::start_nearest`.
  template <Executor E = SerialExecutor>
  Status start_nearest(const Surface& surface, const BoundaryFrames& boundary, const SurfaceLocator& locator,
                       const E& executor = {}, const Observer& observer = {}) {
    const Status status = framehex::start_nearest(points(), constraints_, surface, boundary, locator, frames_,
                                                  ExecutorRef(executor), observer);
    smoothness_ = frame_smoothness(adjacency(), frames_, ExecutorRef(executor));
    return status;
  }

  /// See `smooth_frames`.
  template <Executor E = SerialExecutor>
  SmoothingReport smooth(const SmoothingOptions& options = {}, const E& executor = {}) {
    return smooth_frames(adjacency(), frames_, smoothness_, constraints_, axes_, options, ExecutorRef(executor));
  }

  /// See `diffuse_frames`.
  template <Executor E = SerialExecutor>
  DiffusionReport diffuse(const DiffusionOptions& options = {}, const E& executor = {}) {
    const DiffusionReport report =
        diffuse_frames(adjacency(), std::span<const Vector3>(points()), std::span<Quaternion>(frames_),
                       std::span<const FrameConstraint>(constraints_), std::span<const Vector3>(axes_), options,
                       ExecutorRef(executor));
    smoothness_ = frame_smoothness(adjacency(), frames_, ExecutorRef(executor));
    return report;
  }

  /// See `framehex::remove_small_loops`.
  std::size_t remove_small_loops() {
    const std::size_t n_removed = framehex::remove_small_loops(adjacency(), frames_, constraints_, axes_);
    if (n_removed > 0) smoothness_ = frame_smoothness(adjacency(), frames_, ExecutorRef(SerialExecutor{}));
    return n_removed;
  }

  /// See `framehex::align_representatives`: `sample` is faster then.
  void align() { align_representatives(adjacency(), frames_); }

  /// See `framehex::singular_graph`.
  SingularGraph singular_graph() const { return framehex::singular_graph(adjacency(), points(), frames_); }

  /// See `framehex::boundary_misalignment`.
  BoundaryMisalignment boundary_misalignment() const {
    return framehex::boundary_misalignment(adjacency(), points(), frames_, constraints_, axes_);
  }

  /// See `framehex::dirichlet_energy`.
  double dirichlet_energy() const {
    return framehex::dirichlet_energy(adjacency(), frames_, dirichlet_weights(adjacency(), points()));
  }

  /// The frame and smoothness at a point: those of the four vertices round it, the frames turned to the representatives
  /// nearest to one another, averaged by the barycentric coordinates.
  ///
  /// @param tet_hint  a tetrahedron near `p`, or anything; receives the one found, for the next call. One per thread.
  /// @return outside the mesh, the value at a boundary point near `p`.
  FrameSample sample(const Vector3& p, index_t& tet_hint) const {
    const TetLocation at = locator_->locate(p, tet_hint);
    FrameSample result;
    if (at.tet == no_index) return result;
    tet_hint = result.tet = at.tet;
    const auto& t = adjacency().tets[at.tet];
    result.frame = detail::mean_frame<4>({frames_[t[0]], frames_[t[1]], frames_[t[2]], frames_[t[3]]}, at.barycentric);
    result.smoothness = 0;
    for (std::size_t i = 0; i < 4; ++i) result.smoothness += at.barycentric[i] * smoothness_[t[i]];
    return result;
  }

private:
  std::shared_ptr<const TetLocator> locator_;
  std::vector<Quaternion> frames_;
  std::vector<double> smoothness_;
  std::vector<FrameConstraint> constraints_;
  std::vector<Vector3> axes_;
};

}  // namespace framehex
