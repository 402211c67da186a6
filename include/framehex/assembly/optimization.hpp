// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/improver.hpp"
#include "framehex/assembly/detail/mixed_export.hpp"
#include "framehex/mesh/mixed_faces.hpp"
#include "framehex/option_ranges.hpp"

namespace framehex {

/// Whether optimisation may change the connectivity of tetrahedra and pyramids.
enum class Reconnection { none, allowed };

/// Options of `optimize`.
struct OptimizationOptions {
  Reconnection reconnection = Reconnection::none;
  /// Scaled Jacobian below which a hexahedron, or another cell, is worked on, 1e-3 to 1.
  double hexahedron_target = 0.37;
  double quality_target = 0.23;
  int max_rounds = 8;  ///< 0 to 1e6
  /// As in `AssemblyOptions`, with vertices of the mixed mesh. Empty: no boundary vertex moves.
  std::function<bool(index_t vertex, Vector3& place)> boundary_projection{};
  Observer observer{};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("OptimizationOptions::hexahedron_target", o.hexahedron_target, 1e-3, 1);
    visit("OptimizationOptions::quality_target", o.quality_target, 1e-3, 1);
    visit("OptimizationOptions::max_rounds", o.max_rounds, 0, 1e6);
  }
};

/// Least scaled Jacobian before and after, by CellKind; 2 for a kind that is not there.
struct OptimizationResult {
  std::array<double, 4> before{2, 2, 2, 2}, after{2, 2, 2, 2};
  std::size_t n_moved = 0;           ///< vertices
  Status status = Status::complete;  ///< cancelled: the mesh is as it was
};

namespace detail {

inline std::array<double, 4> least_quality(const CellComplex& complex) {
  std::array<double, 4> least{2, 2, 2, 2};
  for (index_t cell = 0; cell < complex.cells.size(); ++cell) {
    if (!complex.cells[cell].alive) continue;
    double& q = least[static_cast<std::size_t>(complex.cells[cell].kind)];
    q = std::min(q, complex.quality(cell));
  }
  return least;
}

}  // namespace detail

/// Raises the quality of the bad cells of a mixed mesh by moving vertices near them.
///
/// Interior vertices are free, boundary vertices go where `boundary_projection` puts them. A valid cell never becomes
/// invalid; cells that are invalid at the start stay or become valid. With `Reconnection::allowed` tetrahedra and
/// pyramids are reconnected too: cells are then renumbered, new vertices may follow the old ones, and vertices that no
/// cell uses any longer stay in `points`, so that numbers hold; without, only `points` changes.
///
/// @param mesh  conforming, well-formed; changed in place.
/// @return least qualities before and after.
/// @throws invalid_option  for a number outside its range.
/// @par Complexity   O(n) to find the bad cells; then by their number.
/// @par Source       The energy is a one-sided fourth power in the scaled Jacobian, minimised by damped Gauss-Newton
///                   steps one vertex at a time.
inline OptimizationResult optimize(MixedMesh& mesh, const OptimizationOptions& options = {}) {
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
