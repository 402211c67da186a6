// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/adjacency.hpp"
#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace framehex {

/// What a quadrilateral on the boundary must be.
enum class BoundaryRule : std::uint8_t {
  both_or_neither,  ///< its two outer triangles lie both on the boundary, and then on one patch, or both inside
  ignore            ///< it may lie on the boundary with one of them; patches are kept all the same
};

/// Whether the input is checked before the search.
enum class InputCheck : std::uint8_t {
  validate,  ///< everything that `validate(mesh)` checks
  skip       ///< the caller has called `validate`, or knows; nothing is promised of a mesh that fails it
};

/// What a potential cell must satisfy, for `find_potential_hexahedra`, `find_potential_prisms`,
/// `find_potential_pyramids` and `find_pattern_hexahedra`. Spans must outlive the call only.
struct FinderOptions {
  /// Least scaled Jacobian of a corner, 0 to 1; a cell must have a positive Jacobian everywhere in any case.
  double quality_floor = 0.2;
  BoundaryRule boundary_rule = BoundaryRule::both_or_neither;
  /// A region for each tetrahedron; a cell lies in one region, and the facets between regions count as boundary.
  /// Empty: one region.
  std::span<const index_t> regions{};
  /// Labels of the patches of facets, [tet][corner opposite the facet], `no_index` where there is none; see
  /// `facet_patches` and `facet_labels`. A labelled facet inside the mesh counts as boundary. Empty: one patch.
  std::span<const std::array<index_t, 4>> facet_patches{};
  /// Edges, as pairs of vertices in either order, that no cell may lose: they become edges of it or stay outside.
  std::span<const std::array<index_t, 2>> feature_edges{};
  /// For each tetrahedron, whether cells may use it (not 0); face slivers need not be free. Empty: all.
  std::span<const std::uint8_t> free_tets{};
  /// How many mesh vertices a cell may swallow.
  std::size_t max_interior_vertices = 0;
  InputCheck input_check = InputCheck::validate;
  /// The mesh's adjacency, where the caller has it already; built otherwise.
  const TetAdjacency* adjacency = nullptr;
  /// Stage "recombination".
  Observer observer{};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("FinderOptions::quality_floor", o.quality_floor, 0, 1);
    visit("FinderOptions::max_interior_vertices", o.max_interior_vertices, 0, unbounded);
  }
};

/// Options of `find_potential_hexahedra`.
using HexFinderOptions = FinderOptions;
/// Options of `find_potential_prisms`.
using PrismFinderOptions = FinderOptions;
/// Options of `find_potential_pyramids`.
using PyramidFinderOptions = FinderOptions;

/// Brings labels of boundary triangles into the form of `FinderOptions::facet_patches`.
///
/// @param labels  one for each boundary facet, in the order of `extract_boundary` (by tetrahedron, then by the corner
///                opposite).
/// @return labels of the facets opposite each corner, `no_index` inside.
/// @throws invalid_option  when the number of labels is not that of the boundary facets.
/// @par Complexity   O(n); 16 bytes a tetrahedron.
inline std::vector<std::array<index_t, 4>> facet_patches(const TetAdjacency& adjacency,
                                                         std::span<const index_t> labels) {
  std::vector<std::array<index_t, 4>> patches(adjacency.tets.size(), {no_index, no_index, no_index, no_index});
  std::size_t n = 0;
  for (std::size_t tet = 0; tet < patches.size(); ++tet)
    for (std::size_t i = 0; i < 4; ++i)
      if (adjacency.neighbours[tet][i] == no_index) {
        if (n < labels.size()) patches[tet][i] = labels[n];
        ++n;
      }
  if (n != labels.size())
    throw invalid_option(std::to_string(labels.size()) + " labels for " + std::to_string(n) + " boundary facets");
  return patches;
}

}  // namespace framehex
