// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/rotation.hpp"
#include "framehex/pipeline/meshing_options.hpp"
#include "framehex/pipeline/recombine.hpp"
#include "framehex/surface/limited_size.hpp"

namespace framehex {

/// What the stages found on their way.
struct MeshingStatistics {
  std::size_t n_feature_curves = 0;
  std::size_t n_patches = 0;
  std::size_t n_regions = 0;
  std::size_t n_background_tets = 0;
  double smoothness_mean = 0;  ///< over the background vertices
  double fraction_smooth = 0;  ///< share of them with smoothness >= 0.85
  double dirichlet_energy = 0;
  std::size_t n_singular_edges = 0;        ///< facets through which a singular line of the field passes
  PointOrder order = PointOrder::lattice;  ///< that placed the points: not the one asked for where fronts took over
  LatticeMapping mapping = LatticeMapping::phases;  ///< that of the lattice, if there is one
  double lattice_volume = 0;  ///< share of the volume in which the lattice is regular; 0 also where fronts replace it
  std::size_t n_surface_points = 0;  ///< corners, curves and surfaces
  std::size_t n_volume_points = 0;
  std::size_t n_unremoved_vertices = 0;  ///< vertices of the input that the retriangulation had to keep
  std::size_t n_repair_vertices = 0;     ///< added where triangles of the wished size would leave the input, or cross
  std::size_t n_tets = 0;                ///< of the second mesh
};

/// A cell whose scaled Jacobian is below `MeshingOptions::least_quality` all the same.
struct PoorCell {
  index_t cell;
  double quality;
  Vector3 place;     ///< its centre
  bool input_angle;  ///< the input has an edge there whose faces enclose an angle that leaves room for no better cell
};

/// A hex-dominant mesh of the inside of a surface, and how it came about.
struct MeshingResult {
  Recombination recombination;     ///< `.mesh`, `.selection`, `.assembly`, `.seconds` (of all stages)
  std::vector<Quaternion> frames;  ///< frame at each point of the mesh
  std::vector<double> smoothness;  ///< smoothness of the field there, at most 1
  Csr<Vector3> singular_lines;     ///< of the field, as polylines
  /// Where the size is smaller than wished, and what it is there: wherever the surface comes too near itself for points of
  /// the wished size. It grows by 0.3 of the distance from these places.
  std::vector<SizeLimit> size_limits;
  std::vector<PoorCell> poor_cells;  ///< ascending
  MeshingStatistics statistics;
  Status status = Status::complete;  ///< cancelled: the mesh is empty
};

}  // namespace framehex
