// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/mixed_mesh.hpp"
#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"

#include <functional>

namespace framehex {

/// What becomes of a quadrilateral of a hexahedron or prism that faces two triangles.
enum class InterfaceMode {
  conforming,   ///< closed by a pyramid, or by splitting the cell behind it: no quadrilateral faces two triangles
  no_pyramids,  ///< the same without pyramids, for solvers that lack them; costs most of the hexahedra next to
                ///< tetrahedra
  open          ///< left as it is where two tetrahedra with one apex cannot be merged, and listed
};

/// Whether the cells that are not hexahedra may be joined to prisms.
enum class PrismMode { none, chosen };

/// Whether, after closing, cells of low quality are improved by moving vertices and reconnecting tetrahedra.
/// `none` moves and removes no vertex either.
enum class ImprovementMode { none, improve };

/// What the cells must suit beside the exact test of validity.
enum class CellFit {
  any,           ///< elements of any kind of solver
  finite_volume  ///< and finite volumes: inner faces that look into all directions, and faces that can be cut into
  ///< tetrahedra with the centres of their cells; costs hexahedra on sharp edges and in walls of one cell
};

/// What becomes of the numbers of the input's vertices.
enum class VertexNumbers {
  kept,    ///< vertex v of the input is point v of the result, also when no cell uses it (any longer); new ones follow
  compact  ///< vertices that no cell uses are left out, the others move up
};

/// How `assemble` works. The label fields refer to memory of the caller that must outlive the call.
struct AssemblyOptions {
  InterfaceMode interfaces = InterfaceMode::conforming;
  PrismMode prisms = PrismMode::chosen;
  ImprovementMode improvement = ImprovementMode::improve;
  CellFit fit = CellFit::any;  ///< finite volumes: with `conforming` only
  VertexNumbers vertex_numbers = VertexNumbers::kept;
  /// Least scaled Jacobian of a prism that is chosen, 0 to 1.
  double prism_quality_floor = 0.25;
  /// Least scaled Jacobian that a closed interface may leave, 0 to 1, before a hexahedron is given up for it.
  double quality_floor = 0.05;
  /// Scaled Jacobian below which improvement works on a cell that is not a hexahedron, 1e-3 to 1.
  double quality_target = 0.23;
  /// Scaled Jacobian below which improvement works on a hexahedron, 1e-3 to 1.
  double hexahedron_target = 0.37;
  /// Label of each tetrahedron, n_tets entries, or empty for one region.
  std::span<const index_t> regions{};
  /// Labelled triangles of the tetrahedral mesh, on its boundary or inside, in its vertex numbers. Inner ones stay
  /// faces. Boundary faces without one come out with the label after the greatest that is given (0: none is).
  std::span<const LabelledFace> faces{};
  /// Labelled edges of the tetrahedral mesh (feature curves); they stay edges.
  std::span<const LabelledEdge> edges{};
  /// Lets improvement move boundary vertices: brings a trial place of vertex `vertex` of the tetrahedral mesh back to
  /// its surface or curve, or returns false when that vertex may not move. Empty: no boundary vertex moves.
  /// `BoundarySlider` is one.
  std::function<bool(index_t vertex, Vector3& place)> boundary_projection{};
  Observer observer{};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("AssemblyOptions::prism_quality_floor", o.prism_quality_floor, 0, 1);
    visit("AssemblyOptions::quality_floor", o.quality_floor, 0, 1);
    visit("AssemblyOptions::quality_target", o.quality_target, 1e-3, 1);
    visit("AssemblyOptions::hexahedron_target", o.hexahedron_target, 1e-3, 1);
  }
};

/// A quadrilateral that faces two triangles.
struct OpenInterface {
  std::array<index_t, 4> quadrilateral;   ///< vertices of the result, anticlockwise seen from outside its cell
  index_t cell;                           ///< cell of the result whose face it is
  std::array<index_t, 2> triangle_cells;  ///< cells of the result that have the two triangles, `no_index`: boundary
};

/// What `assemble` did.
struct AssemblyStatistics {
  std::size_t n_open_quadrilaterals = 0;  ///< before closing
  std::size_t n_merged = 0;               ///< closed by two tetrahedra with one apex
  std::size_t n_raised = 0;               ///< closed by a pyramid to another vertex or to a new one
  std::size_t n_split = 0;                ///< hexahedra and prisms split from a new vertex at their centre
  std::size_t n_dissolved = 0;            ///< hexahedra and prisms taken back into their tetrahedra
  std::size_t n_withdrawn = 0;            ///< of those, left out from the start because they could not be closed
  std::size_t n_refitted = 0;             ///< places where cells were replaced to fit `AssemblyOptions::fit`
  std::size_t n_unfit = 0;                ///< cells that do not fit it all the same
  std::size_t n_new_vertices = 0;         ///< of the result, that the input did not have
  std::size_t n_removed_vertices = 0;     ///< of the input's cells, that no cell of the result uses
  double hexahedron_volume_chosen = 0;    ///< of the selection
  double hexahedron_volume = 0;           ///< of the result
  double volume = 0;
};

}  // namespace framehex
