// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/improver.hpp"
#include "framehex/assembly/detail/mixed_export.hpp"
#include "framehex/assembly/optimization.hpp"
#include "framehex/mesh/mixed_faces.hpp"

namespace framehex {

namespace detail {

FRAMEHEX_INLINE std::array<double, 4> least_quality(const CellComplex& complex) {
  std::array<double, 4> least{2, 2, 2, 2};
  for (index_t cell = 0; cell < complex.cells.size(); ++cell) {
    if (!complex.cells[cell].alive) continue;
    double& q = least[static_cast<std::size_t>(complex.cells[cell].kind)];
    q = std::min(q, complex.quality(cell));
  }
  return least;
}

}  // namespace detail

FRAMEHEX_INLINE OptimizationResult optimize(MixedMesh& mesh, const OptimizationOptions& options) {
  check_options(options);
  detail::CellComplex complex;
  for (const Vector3& p : mesh.points) complex.add_vertex(p, false);
  for (index_t cell = 0; cell < mesh.n_cells(); ++cell)
    complex.add(mesh.kinds[cell], mesh.cells[cell], mesh.regions.empty() ? 0 : mesh.regions[cell], no_index);
  for (const CellFace& face : faces_used_once(mesh))
    for (std::size_t i = 0; i < face.size(); ++i)
      complex.on_boundary[face.vertices[i]] = complex.is_protected[face.vertices[i]] = 1;
  for (const LabelledFace& face : mesh.faces) complex.protected_faces.insert(detail::face_key(face.vertices));
  for (const LabelledEdge& edge : mesh.edges) {
    complex.protected_edges.insert(detail::face_key({edge.vertices[0], edge.vertices[1], no_index, no_index}));
    for (const index_t v : edge.vertices) complex.is_protected[v] = 1;
  }
  OptimizationResult result;
  result.before = detail::least_quality(complex);
  AssemblyStatistics statistics;
  detail::Pulse pulse(options.observer, "optimization");
  detail::Improver improver(complex, detail::QualityEnergy::reaching(options.hexahedron_target, options.quality_target),
                            options.boundary_projection, statistics, pulse);
  if (options.reconnection == Reconnection::allowed)
    improver.run(options.max_rounds, false);
  else
    improver.smooth(5 * options.max_rounds, true);
  if (pulse.stopped()) {
    result.status = Status::cancelled;
    result.after = result.before;
    return result;
  }
  result.after = detail::least_quality(complex);
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if (complex.points[v] != mesh.points[v]) ++result.n_moved;
  if (options.reconnection == Reconnection::none) {
    mesh.points = complex.points;
    return result;
  }
  detail::MixedExport exported = detail::export_cells(complex, mesh.points.size());
  exported.mesh.faces = std::move(mesh.faces);
  exported.mesh.edges = std::move(mesh.edges);
  if (mesh.regions.empty()) exported.mesh.regions.clear();
  mesh = std::move(exported.mesh);
  return result;
}

}  // namespace framehex
