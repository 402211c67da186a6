// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/surface/surface.hpp"
#include "framehex/surface/surface_sample.hpp"

#include <array>
#include <numbers>
#include <span>
#include <vector>

namespace framehex {

/// A surface whose vertices are chosen samples.
struct Retriangulation {
  Surface surface;              ///< vertices: the samples in their order, then others; with the input's corners, curves
                                ///< and patches
  std::size_t n_unremoved = 0;  ///< input vertices that are no samples and had to stay
  std::size_t n_added = 0;      ///< new vertices, after those, that keep the surface near the input and from crossing
                                ///< itself
  std::vector<std::array<index_t, 2>> crossings;  ///< pairs of triangles that cross all the same
  Status status = Status::complete;               ///< or cancelled: then there is no surface
};

/// What a retriangulation may do.
struct RetriangulationOptions {
  double max_bend = 60 * std::numbers::pi / 180;  ///< rad, > 0 to pi; a new triangle's normal from the input's nearby
  /// In diagonals of the input's bounding box, > 0: vertices of the input that would lie farther from the result come
  /// back, unless that is less than 0.4 of the edges there. Infinite: none does.
  double max_deviation = 0.0075;
  /// > 0 to 1e-4: area over squared edges, 1 for an equilateral triangle, of the worst triangle that is made to be rid of
  /// a vertex of the input. In a plane, where no triangle is too thin to have a normal, much less does no harm.
  double least_shape = 1e-4;
  int repair_rounds = 12;  ///< >= -1; cuts against self-intersections; -1: do not even look for them
  Observer observer{};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("RetriangulationOptions::max_bend", o.max_bend, least_positive, std::numbers::pi);
    visit("RetriangulationOptions::max_deviation", o.max_deviation, least_positive, unbounded);
    visit("RetriangulationOptions::least_shape", o.least_shape, least_positive, 1e-4);
    visit("RetriangulationOptions::repair_rounds", o.repair_rounds, -1, 1e9);
  }
};

/// Triangulates a surface anew through exactly the given samples.
///
/// The samples are inserted into the input triangulation, edges are flipped until it is Delaunay, and every vertex that
/// is not a sample is collapsed into a neighbour, with flips in between. Features are never crossed, triangles never
/// bent away from the input's normals by more than `options.max_bend` unless nothing else removes a vertex.
///
/// Where walls are thin for the spacing of the samples the result may cross itself. Triangles that do are cut at their
/// longest edges, at points of the input, until they do not.
///
/// @param surface  closed (or with rims), oriented outward. Every corner should be a sample; one that is not stays as an
///                 unremoved vertex.
/// @param samples  in any order, no two the same point; each closed curve needs three, each corner itself.
/// @return samples as vertices 0 to n-1 at their exact positions, then the input vertices that could not be removed,
///         then those added by the repair. When the observer stops it: nothing, and the status says so.
/// @throws invalid_coordinate, invalid_connectivity  with the index of a sample that is not finite or refers to no
///         entity; invalid_option with two samples in one place.
/// @par Complexity   O(n log n) for n vertices and samples evenly spread; about 1 kB each.
/// @par Determinism  The same everywhere up to rounding.
Retriangulation retriangulate(const Surface& surface, std::span<const SurfaceSample> samples,
                              const RetriangulationOptions& options = {});

}  // namespace framehex

#ifndef FRAMEHEX_COMPILED
#include "framehex/surface/detail/retriangulation_impl.hpp"
#endif
