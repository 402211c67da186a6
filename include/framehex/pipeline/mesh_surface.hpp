// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/geometry/size_field.hpp"
#include "framehex/pipeline/detail/used_points.hpp"
#include "framehex/pipeline/meshing_options.hpp"
#include "framehex/pipeline/meshing_result.hpp"
#include "framehex/surface/surface.hpp"
#include "framehex/tetrahedralization/tetrahedralizer.hpp"

namespace framehex {

namespace detail {

/// `mesh_surface` once the surface is the library's own.
///
/// @param input  with its features; its patches bound the regions.
MeshingResult mesh_valid_surface(Surface input, const SizeFieldRef& size, const TetrahedralizerRef& tetrahedralizer,
                                 MeshingOptions options, const ExecutorRef& executor);

}  // namespace detail

/// The whole job: from a surface to a hex-dominant mesh of what it encloses.
///
/// The surface may separate several materials: edges where their patches meet have three or more triangles. Every region
/// is filled (see `find_regions`), and what lies between two is meshed once, so that they conform.
///
/// @param surface          any TriangleMesh without open edges; checked first. Vertices of no triangle are left out.
///                         Normals of the outer boundary point outward. Coordinates in the host's unit.
/// @param size             wished edge length at a point: a callable `double(const Vector3&)` > 0, host's unit.
/// @param tetrahedralizer  fills surfaces with tetrahedra, e.g. `TetgenProcess`; its answers are checked.
/// @return the mesh with labels (regions when there are several; patches: those of `options.features.patches`, else of
///         `detect_features`; feature curves), frames, statistics and seconds of each stage.
/// @throws what `validate_surface`, `refuse_self_intersection`, `find_regions`, `tetrahedralize` and the stages throw;
///         nothing is left behind.
/// @par Complexity   about O(n log n) in the number of points, but for the selection, which has its budget.
/// @par Determinism  The same for any executor, unless the selection is stopped by its time budget.
/// @par Source       The paper, section 1, and the stages' own. Departs: regions.
template <TriangleMesh M, Tetrahedralizer T, SizeField Size, Executor E = SerialExecutor>
MeshingResult mesh_surface(const M& surface, const Size& size, const T& tetrahedralizer,
                           const MeshingOptions& options = {}, const E& executor = {}) {
  check_options(options);
  validate_surface(surface);
  Surface input(surface, options.features);
  MeshingOptions numbered = options;
  detail::leave_out_unused_points(input, numbered.features);
  return detail::mesh_valid_surface(std::move(input), size, tetrahedralizer, std::move(numbered), executor);
}

}  // namespace framehex

#ifndef FRAMEHEX_COMPILED
#include "framehex/pipeline/detail/mesh_surface_impl.hpp"
#endif
