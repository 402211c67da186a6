// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/frame_field.hpp"
#include "framehex/mesh/boundary.hpp"
#include "framehex/mesh/validation.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/surface/cross_field.hpp"
#include "framehex/surface/surface.hpp"
#include "framehex/surface/surface_locator.hpp"

namespace framehex {

/// Which field.
enum class FieldMethod {
  nearest,   ///< of the nearest boundary point (the paper's NN)
  smoothed,  ///< that, smoothed (the paper's Sm)
  best,      ///< harmonic start, diffusion and projection, polish
};

/// What becomes of the cross field of smooth surfaces under `best`.
enum class SurfaceCross {
  free,  ///< frames keep the normal and turn about it as the volume likes; see `surface_crosses`
  kept,  ///< frames on the surface are those of its cross field
};

/// Options of `compute_frame_field` over a surface with its frames.
struct FieldOptions {
  FieldMethod method = FieldMethod::best;
  /// Surface vertex -> vertex of the tetrahedral mesh; empty: the surface's vertices are the mesh's first, in order.
  std::vector<index_t> vertex_of = {};
  BoundaryFrameOptions boundary = {};
  SmoothingOptions smoothing = {};  ///< for `smoothed`
  DiffusionOptions diffusion = {};  ///< for `best`
  SmoothingOptions polish = {       ///< for `best`; edge weights are the Dirichlet energy's unless given
      .diffusivity = Diffusivity::constant,
      .max_sweeps = 10};
  SurfaceCross surface_cross = SurfaceCross::free;  ///< for `best`
  Observer observer = {};                           ///< for all stages that have none of their own

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    BoundaryFrameOptions::each_number(o.boundary, visit);
    SmoothingOptions::each_number(o.smoothing, visit);
    DiffusionOptions::each_number(o.diffusion, visit);
    SmoothingOptions::each_number(o.polish, visit);
  }
};

/// How a field was made.
struct FieldReport {
  DiffusionReport diffusion;      ///< of `best`
  SmoothingReport smoothing;      ///< of `smoothed`, and the polish of `best`
  std::size_t removed_loops = 0;  ///< after the polish of `best`; see `remove_small_loops`
  Status status = Status::complete;
};

namespace detail {

template <class Options>
Options observed_by(Options options, const Observer& observer) {
  if (!options.observer) options.observer = observer;
  return options;
}

/// Whether a method looks at the frames inside before it has made some: a harmonic start does not.
inline bool needs_start(const FieldOptions& options) {
  return options.method != FieldMethod::best || options.diffusion.start == DiffusionStart::current;
}

/// Carries out a method on a field that is constrained, and started where it must be.
///
/// @tparam Field  `FrameField`, or what offers `smooth`, `diffuse`, `remove_small_loops`, `adjacency`, `points` and `align`.
template <class Field, class E>
FieldReport run_method(Field& field, const FieldOptions& options, const E& executor) {
  FieldReport report;
  if (options.method == FieldMethod::smoothed)
    report.smoothing = field.smooth(observed_by(options.smoothing, options.observer), executor);
  if (options.method == FieldMethod::best) {
    report.diffusion = field.diffuse(observed_by(options.diffusion, options.observer), executor);
    if (report.diffusion.status != Status::cancelled) {
      SmoothingOptions polish = observed_by(options.polish, options.observer);
      std::vector<double> weights;
      if (polish.edge_weights.empty()) {
        weights = dirichlet_weights(field.adjacency(), field.points());
        polish.edge_weights = weights;
      }
      report.smoothing = field.smooth(polish, executor);
      if (report.smoothing.status != Status::cancelled) report.removed_loops = field.remove_small_loops();
    }
  }
  if (report.diffusion.status == Status::cancelled || report.smoothing.status == Status::cancelled)
    report.status = Status::cancelled;
  field.align();
  return report;
}

/// Whether frames on the surface stay those of its cross field.
inline bool keeps_crosses(const FieldOptions& options) {
  return options.method != FieldMethod::best || options.surface_cross == SurfaceCross::kept;
}

/// Constrains a new field, starts it and carries out a method.
template <class Mesh, class E>
FieldReport fill_field(FrameField<Mesh>& field, const Surface& surface, const BoundaryFrames& boundary,
                       const FieldOptions& options, const E& executor) {
  field.constrain(boundary, options.vertex_of);
  if (keeps_crosses(options)) field.fix_boundary();
  if (needs_start(options) &&
      field.start_nearest(surface, boundary, SurfaceLocator(surface), executor, options.observer) == Status::cancelled)
    return cancelled<FieldReport>();
  return run_method(field, options, executor);
}

}  // namespace detail

/// The field of a background mesh from the crosses of its surface.
///
/// @param mesh             tetrahedra filling `surface`; vertices of its boundary that `options.vertex_of` does not
///                         name are free.
/// @param adjacency        of `mesh`, for those who have it.
/// @param surface          outward.
/// @param triangle_frames  n_triangles unit quaternions, z the outward normal (`SurfaceCrossField::frames`).
/// @param executor         results do not depend on it.
/// @param report           receives the course of the computation; may be null.
/// @return a field without NaN, all quaternions unit; also when cancelled (`report->status`).
/// @pre `validate(mesh)` passes.
/// @throws invalid_field, invalid_option  as `make_boundary_frames`, `FrameField::constrain`, `smooth_frames`,
///                         `diffuse_frames`; entities are numbered in the surface.
/// @par Complexity   see `start_nearest`, `smooth_frames`, `diffuse_frames`.
template <TetMesh Mesh, Executor E = SerialExecutor>
FrameField<Mesh> compute_frame_field(const Mesh& mesh, TetAdjacency adjacency, const Surface& surface,
                                     std::span<const Quaternion> triangle_frames, const FieldOptions& options = {},
                                     const E& executor = {}, FieldReport* report = nullptr) {
  check_options(options);
  FrameField<Mesh> field(mesh, std::move(adjacency));
  const BoundaryFrames boundary = make_boundary_frames(surface, triangle_frames, options.boundary);
  FieldReport course = detail::fill_field(field, surface, boundary, options, executor);
  if (report) *report = std::move(course);
  return field;
}
/// The same, with the adjacency of the mesh made on the way.
template <TetMesh Mesh, Executor E = SerialExecutor>
FrameField<Mesh> compute_frame_field(const Mesh& mesh, const Surface& surface,
                                     std::span<const Quaternion> triangle_frames, const FieldOptions& options = {},
                                     const E& executor = {}, FieldReport* report = nullptr) {
  return compute_frame_field(mesh, make_adjacency(mesh), surface, triangle_frames, options, executor, report);
}

/// Options of a field for a host's mesh alone.
struct MeshFieldOptions {
  FeatureOptions features = {};  ///< `given_edges` in vertices of the mesh
  CrossFieldOptions cross_field = {};
  FieldOptions field = {};  ///< `vertex_of` is not looked at
  /// Label of each tetrahedron: frames follow facets between different labels as they follow the boundary. Empty: the
  /// boundary only.
  std::span<const index_t> regions = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    FeatureOptions::each_number(o.features, visit);
    CrossFieldOptions::each_number(o.cross_field, visit);
    FieldOptions::each_number(o.field, visit);
  }
};

namespace detail {

/// Edges of a mesh as edges of its boundary.
///
/// @throws invalid_option  with the two vertices of an edge that is not on the boundary.
inline std::vector<std::array<index_t, 2>> edges_on_boundary(std::span<const std::array<index_t, 2>> edges,
                                                             const BoundarySurface& boundary) {
  struct SurfaceEdge {
    std::array<index_t, 2> host, surface;
    auto operator<=>(const SurfaceEdge&) const = default;
  };
  std::vector<SurfaceEdge> known;
  if (!edges.empty())
    for (const auto& t : boundary.surface.triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto [low, high] = std::minmax(t[i], t[(i + 1) % 3]);
        known.push_back({{boundary.vertex_of[low], boundary.vertex_of[high]}, {low, high}});
      }
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  std::vector<std::array<index_t, 2>> found;
  for (const auto& [v, w] : edges) {
    const std::array<index_t, 2> host{std::min(v, w), std::max(v, w)};
    const auto range = std::ranges::equal_range(known, host, {}, &SurfaceEdge::host);
    if (range.empty())
      throw invalid_option(
          "given feature edge (" + std::to_string(v) + ", " + std::to_string(w) + ") is no edge of the boundary",
          Entity::edge, {v, w});
    for (const SurfaceEdge& edge : range) found.push_back(edge.surface);
  }
  return found;
}

/// The same error in the numbers of the mesh: those of its boundary are unknown to the host.
inline invalid_field in_mesh_numbers(const invalid_field& e, const BoundarySurface& boundary) {
  const bool is_triangle = e.entity() == Entity::triangle;
  if (!is_triangle && e.entity() != Entity::vertex) return e;
  std::vector<std::size_t> indices;
  std::string names;
  for (const std::size_t i : e.indices()) {
    indices.push_back(is_triangle ? boundary.tet_of[i] : boundary.vertex_of[i]);
    names += " " + std::to_string(indices.back());
  }
  return invalid_field(std::string("no frame can be made on the boundary at ") + (is_triangle ? "cell" : "vertex") +
                           names + " (in the numbers of the boundary: " + e.what() + ")",
                       is_triangle ? Entity::cell : Entity::vertex, indices);
}

/// Features, crosses and frames of a mesh's boundary.
///
/// @return false when cancelled.
/// @throws invalid_field, invalid_option  in the numbers of the mesh.
inline bool frame_boundary(const BoundarySurface& boundary, const MeshFieldOptions& options, Surface& surface,
                           BoundaryFrames& frames) {
  FeatureOptions features = options.features;
  features.given_edges = edges_on_boundary(options.features.given_edges, boundary);
  try {
    surface = Surface(boundary.surface, features);
    const SurfaceCrossField crosses =
        compute_cross_field(surface, observed_by(options.cross_field, options.field.observer));
    if (crosses.status == Status::cancelled) return false;
    frames = make_boundary_frames(surface, crosses.frames, options.field.boundary);
    return true;
  } catch (const invalid_field& e) {
    throw in_mesh_numbers(e, boundary);
  }
}

}  // namespace detail

/// The field of a host's tetrahedral mesh: extracts the boundary, finds features, computes the cross field and the
/// field.
///
/// @throws invalid_field   with the vertex, or the cell behind the boundary triangle, that no frame can be made for;
///         invalid_option  for a number outside its range, labels that are not one a tetrahedron, or with the vertices
///                         of a given edge that is not on the boundary; and as `validate`.
template <TetMesh Mesh, Executor E = SerialExecutor>
FrameField<Mesh> compute_frame_field(const Mesh& mesh, const MeshFieldOptions& options = {}, const E& executor = {},
                                     FieldReport* report = nullptr) {
  check_options(options);
  // The host is read here and no more: what follows has what was checked.
  detail::CheckedTets read = detail::checked_tets(mesh);
  FrameField<Mesh> result(std::move(read.adjacency), std::move(read.points));
  if (!options.regions.empty() && options.regions.size() != result.adjacency().tets.size())
    throw invalid_option("there are " + std::to_string(options.regions.size()) + " region labels for " +
                         std::to_string(result.adjacency().tets.size()) + " tetrahedra");
  const BoundarySurface boundary =
      extract_boundary(TetView{result.points(), result.adjacency().tets}, result.adjacency(), options.regions);
  FieldOptions field = options.field;
  field.vertex_of = boundary.vertex_of;
  Surface surface;
  BoundaryFrames frames;
  FieldReport course;
  if (detail::frame_boundary(boundary, options, surface, frames))
    course = detail::fill_field(result, surface, frames, field, executor);
  else
    course.status = Status::cancelled;
  if (report) *report = std::move(course);
  return result;
}

/// Crosses of a surface as a field in the volume has them: what to sample the surface with, so that the points on it
/// agree with those inside.
///
/// @param vertex_of  surface vertex -> vertex of the mesh; empty: the same number.
/// @return per triangle, z the outward normal, x and y the cross; the mean of its three corners' frames turned to the
///         normal.
template <TetMesh Mesh>
std::vector<Quaternion> surface_crosses(const FrameField<Mesh>& field, const Surface& surface,
                                        std::span<const index_t> vertex_of = {}) {
  std::vector<Quaternion> crosses;
  crosses.reserve(surface.triangles().size());
  for (const auto& t : surface.triangles()) {
    std::array<Quaternion, 3> frames;
    std::array<double, 3> weights{1, 1, 1};
    for (std::size_t i = 0; i < 3; ++i) {
      const index_t v = vertex_of.empty() ? t[i] : vertex_of[t[i]];
      frames[i] = field.frames()[v];
      // A corner's frame on a feature may stand at a slant; those of smooth places know the cross best.
      if (field.constraints()[v] == FrameConstraint::axis) weights[i] = 2;
    }
    const Vector3 normal =
        (surface.points[t[1]] - surface.points[t[0]]).cross(surface.points[t[2]] - surface.points[t[0]]);
    Quaternion frame = detail::mean_frame<3>(frames, weights);
    if (normal.norm() > 0) frame = detail::with_z(detail::snapped(frame, normal.normalized()), normal.normalized());
    crosses.push_back(frame);
  }
  return crosses;
}

}  // namespace framehex
