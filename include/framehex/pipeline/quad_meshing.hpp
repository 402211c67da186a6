// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/insertion/curve_inserter.hpp"
#include "framehex/insertion/surface_inserter.hpp"
#include "framehex/quads/improvement.hpp"
#include "framehex/quads/quadrangulate.hpp"
#include "framehex/surface/cross_field.hpp"
#include "framehex/surface/distinct_bends.hpp"
#include "framehex/surface/distinct_tips.hpp"
#include "framehex/surface/retriangulation.hpp"

namespace framehex {

/// In which order points propose their neighbours.
enum class FrontOrder {
  fifo,       ///< first in, first out: layer by layer from the curves
  smoothness  ///< where the cross field is smoothest first
};

/// Options of the stages of `mesh_planar` and `mesh_shell`; each stage's own options say more.
///
/// What refers to a mesh by number (`curves.added`, `surface.complete`, `quads.frames`) is not looked at: the meshes are
/// made on the way.
struct QuadMeshingOptions {
  /// Without a volume behind them, bends of curves count as those of edges do.
  FeatureOptions features = {.corner_angle = FeatureOptions{}.angle};
  BendOptions bends = {};  ///< which smaller bends are corners too
  TipOptions tips = {};    ///< and which vertices inside patches
  CrossFieldOptions cross_field = {};
  FrontOrder order = FrontOrder::smoothness;
  CurveOptions curves = {};
  SurfaceOptions surface = {};
  RetriangulationOptions retriangulation = {};
  QuadrangulationOptions quads = {};
  QuadImprovementOptions improvement = {};
  double max_field_triangles =
      50'000;              ///< >= 1; the cross field is found on triangles larger than the size beyond about that
  Observer observer = {};  ///< replaces those of the stages when set

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    FeatureOptions::each_number(o.features, visit);
    BendOptions::each_number(o.bends, visit);
    TipOptions::each_number(o.tips, visit);
    CrossFieldOptions::each_number(o.cross_field, visit);
    CurveOptions::each_number(o.curves, visit);
    SurfaceOptions::each_number(o.surface, visit);
    RetriangulationOptions::each_number(o.retriangulation, visit);
    QuadrangulationOptions::each_number(o.quads, visit);
    QuadImprovementOptions::each_number(o.improvement, visit);
    visit("QuadMeshingOptions::max_field_triangles", o.max_field_triangles, 1, unbounded);
  }
};

/// Wall seconds of the stages.
struct QuadStageSeconds {
  double preparation = 0;      ///< features, short edges
  double field = 0;            ///< cross field
  double insertion = 0;        ///< curves and surfaces
  double triangulation = 0;    ///< through the samples
  double quadrangulation = 0;  ///< matching
  double improvement = 0;

  QuadStageSeconds& operator+=(const QuadStageSeconds& other) {
    preparation += other.preparation;
    field += other.field;
    insertion += other.insertion;
    triangulation += other.triangulation;
    quadrangulation += other.quadrangulation;
    improvement += other.improvement;
    return *this;
  }
  double total() const { return preparation + field + insertion + triangulation + quadrangulation + improvement; }
};

/// What the stages found on their way.
struct QuadMeshingStatistics {
  std::size_t n_feature_curves = 0;
  std::size_t n_patches = 0;
  std::size_t n_singularities = 0;       ///< vertices about which the cross field turns
  std::size_t n_points = 0;              ///< samples of corners, curves and surfaces
  std::size_t n_unremoved_vertices = 0;  ///< of the input, that the triangulation had to keep
  std::size_t n_added_vertices = 0;      ///< that keep the triangulation near the input
  std::size_t n_triangles = 0;
  std::size_t n_opened_vertices = 0;  ///< where triangles were joined that share no edge
  /// Curves with one interval more than the size asks for, so that each patch has an even number of them; ascending.
  std::vector<index_t> lengthened_curves = {};
  std::size_t n_split_edges = 0;    ///< of curves, after the triangulation, for the same reason
  std::size_t n_widened_edges = 0;  ///< that got a vertex because they lead from curve to curve where no cell fitted
  std::size_t n_shrunk_places = 0;  ///< about which cells are smaller, because the input was too far from them
  std::size_t n_tried_changes = 0;  ///< of the connectivity of quadrilaterals, in all attempts
  /// Cells of the last attempt that were folded as they were joined; improvement has unfolded them.
  std::size_t n_unfolded = 0;
  /// Triangles of the mesh where no attempt left convex quadrilaterals alone; otherwise 0.
  std::size_t n_left_triangles = 0;
  /// Greatest distance found between curves and the sides along them, and of a shell that is not flat between background
  /// and mesh, both ways, over the diagonal of the input's box.
  double deviation = 0;
};

/// Quadrilaterals, and how they came about.
struct QuadMeshing {
  QuadMesh mesh;       ///< with patches, feature curves and corners, as numbered in the features of the background
  Surface background;  ///< the input with short edges
  SurfaceCrossField cross_field;  ///< on its triangles
  QuadMeshingStatistics statistics;
  QuadStageSeconds seconds;
  Status status = Status::complete;  ///< cancelled: the mesh is empty
};

}  // namespace framehex
