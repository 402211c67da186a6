// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/compute_frame_field.hpp"
#include "framehex/insertion/curve_inserter.hpp"
#include "framehex/insertion/surface_inserter.hpp"
#include "framehex/insertion/volume_inserter.hpp"
#include "framehex/lattice/periodic_parameterization.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/pipeline/recombine.hpp"
#include "framehex/surface/cross_field.hpp"
#include "framehex/surface/retriangulation.hpp"
#include "framehex/surface/surface.hpp"

#include <optional>

namespace framehex {

/// How points are placed: by fronts, in the order in which points propose their neighbours, or all at once. Where a lattice
/// is not to be had, because there are interfaces between regions or because its map is bad, fronts take over.
enum class PointOrder {
  fifo,        ///< first in, first out: layer by layer from the boundary
  smoothness,  ///< where the frame field is smoothest first
  lattice      ///< of one lattice for the whole volume, filled in order of smoothness where it has gaps
};

/// Whether the frame field follows the interfaces between regions.
enum class InterfaceFrames {
  aligned,  ///< as it follows the boundary
  free,     ///< it passes through them
};

/// Options of all stages; each stage's own options say more.
///
/// What refers to vertices or tetrahedra of a mesh by number (`field.vertex_of`; labels and `finder.free_tets` of
/// `recombination`) is not looked at: the meshes are made on the way.
struct MeshingOptions {
  FeatureOptions features = {};
  CrossFieldOptions cross_field = {};
  FieldOptions field = {};
  InterfaceFrames interfaces = InterfaceFrames::aligned;
  PointOrder order = PointOrder::lattice;
  LatticeOptions lattice = {};
  CurveOptions curves = {};
  SurfaceOptions surface = {};
  RetriangulationOptions retriangulation = {};
  VolumeOptions volume = {};
  RecombineOptions recombination = {};  ///< its boundary projection, when empty, becomes one to the surface
  std::optional<double> background_edge =
      {};                              ///< > 0, edge of the background mesh; the mean size on the surface when empty
  double max_background_points = 2e7;  ///< refuse an edge that asks for more
  /// Least scaled Jacobian, 0 to 0.3, below which sizes shrink where a cell has it, for as long as that helps.
  double least_quality = 0.05;
  Observer observer = {};  ///< replaces those of the stages when set

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    FeatureOptions::each_number(o.features, visit);
    CrossFieldOptions::each_number(o.cross_field, visit);
    FieldOptions::each_number(o.field, visit);
    LatticeOptions::each_number(o.lattice, visit);
    CurveOptions::each_number(o.curves, visit);
    SurfaceOptions::each_number(o.surface, visit);
    RetriangulationOptions::each_number(o.retriangulation, visit);
    VolumeOptions::each_number(o.volume, visit);
    RecombineOptions::each_number(o.recombination, visit);
    visit("MeshingOptions::background_edge", o.background_edge, least_positive, largest_finite);
    visit("MeshingOptions::max_background_points", o.max_background_points, 0, unbounded);
    visit("MeshingOptions::least_quality", o.least_quality, 0, 0.3);
  }
};

}  // namespace framehex
