// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/surface/surface.hpp"

namespace framehex {

/// A vertex about which the crosses turn.
struct CrossSingularity {
  index_t vertex;
  int index;  ///< in quarter turns
};

/// A cross in each triangle of a surface.
struct SurfaceCrossField {
  std::vector<Quaternion> frames;               ///< n_triangles; z is the outward normal, x and y the cross
  std::vector<double> smoothness;               ///< n_vertices, 0 to 1
  std::vector<CrossSingularity> singularities;  ///< ascending vertices; on a closed surface the indices sum to 4 times
                                                ///< its Euler characteristic
  Status status = Status::complete;             ///< cancelled: all else is empty
};

/// How crosses are chosen where no feature prescribes them.
struct CrossFieldOptions {
  double curvature = 0;     ///< >= 0; on closed patches, pull of the principal directions (0: the smoothest field)
  int max_iterations = 30;  ///< >= 0; of the eigenvalue solver on closed patches
  double tolerance = 1e-3;  ///< > 0 to 1; relative change of the eigenvalue at which it stops
  int diffusion_steps = 3;  ///< >= 0; on closed patches, rounds of spreading and bringing back to unit size
  Observer observer = {};   ///< silent while a matrix is factorised

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("CrossFieldOptions::curvature", o.curvature, 0, largest_finite);
    visit("CrossFieldOptions::max_iterations", o.max_iterations, 0, 1e9);
    visit("CrossFieldOptions::tolerance", o.tolerance, least_positive, 1);
    visit("CrossFieldOptions::diffusion_steps", o.diffusion_steps, 0, 1e9);
  }
};

/// Smoothest crosses on a surface that follow its features.
///
/// Unknown is one complex number a mid-edge, the fourth power of the cross relative to the edge (a Crouzeix-Raviart
/// element on the flat triangles, which are hinged at the edges). On feature edges it is 1: the cross follows the edge,
/// exactly, from both sides, and corners need no decision. Patches with features solve Laplace's equation; closed
/// patches without any take the eigenvector of the least eigenvalue, or with `options.curvature` > 0 one that is pulled
/// to the principal directions of curvature. Patches do not see each other.
///
/// @param surface  may have rims, which are features then. Needles are harmless, but crosses are per triangle: refine()
///                 large triangles first.
/// @return frames of unit quaternions without NaN, whatever the shape of the triangles.
/// @throws invalid_option  for a number outside its range.
/// @par Complexity   One sparse factorisation of n_edges complex unknowns for all patches with features and some for
///                   each closed one: O(n^1.5); about 1 kB an edge. Closed patches of more than 160,000 edges are solved
///                   on about 20,000 sets of edges, in O(n) beside those, and evened out on the edges.
/// @par Determinism  The same everywhere up to rounding; closed patches start from a fixed pseudo-random vector.
/// @par Source       The paper, equation (1), for planar domains. Knoeppel, Crane, Pinkall, Schroeder, ACM Trans.
///                   Graph. 32 (2013) for closed surfaces. Departs from both: unknowns on edges instead of vertices,
///                   because no tangent plane has to be invented at corners and sharp edges.
SurfaceCrossField compute_cross_field(const Surface& surface, const CrossFieldOptions& options = {});

}  // namespace framehex

#ifndef FRAMEHEX_COMPILED
#include "framehex/surface/detail/cross_field_impl.hpp"
#endif
