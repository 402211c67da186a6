// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/quads/detail/pair_joiner.hpp"

namespace framehex {

/// What is asked of a quadrangulation.
enum class QuadGoal {
  all_quads,  ///< triangles that meet in a vertex may be joined too, so that an even number leaves none alone
  pairs,      ///< triangles that share an edge only: some stay triangles
};

/// Options of `quadrangulate`.
struct QuadrangulationOptions {
  QuadGoal goal = QuadGoal::all_quads;
  std::span<const Quaternion> frames = {};  ///< a cross in each triangle (z its normal), or empty
  double alignment = 0.3;  ///< 0 to 1; what the cross counts in a pair's cost, beside the deviation from right angles
  double opening_cost =
      3;  ///< 0 to 100; of a pair that meets in a vertex; 0 a rectangle, 1 an angle of 0 or 180 degrees
  double curve_opening_cost = 2;  ///< 0 to 100; the same for neighbours along a rim or curve

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("QuadrangulationOptions::alignment", o.alignment, 0, 1);
    visit("QuadrangulationOptions::opening_cost", o.opening_cost, 0, 100);
    visit("QuadrangulationOptions::curve_opening_cost", o.curve_opening_cost, 0, 100);
  }
};

/// Quadrilaterals made of a triangulation's triangles.
struct Quadrangulation {
  QuadMesh mesh;  ///< vertices: those of the surface under their numbers, then copies of vertices that were opened
  std::vector<index_t> copied;       ///< for each vertex added: that of which it is a copy, and near which it lies
  std::int64_t cost = 0;             ///< total of the pairs, as the matcher was told them, in ten thousandths
  std::size_t n_openings_tried = 0;  ///< pairs offered that share a vertex only
};

/// Joins the triangles of a surface in pairs, at the least total cost that the matcher finds.
///
/// A pair costs what its worst angle is off the right angle and how far its sides are from the cross field. Features
/// and rims are kept: their edges are edges of the result. Where a matching cannot be perfect by pairs that share an
/// edge, neighbours along a rim or curve are joined through the vertex between them, and where that is not enough any
/// two neighbours of a triangle; then one triangle a patch is left at most, where it has an odd number.
///
/// @param surface  indices in range; a patch (connected, without features inside) falls into pairs for itself.
/// @param matcher  exact, or `GreedyMatcher` for `QuadGoal::pairs`.
/// @throws invalid_option  for an option outside its range, and frames that are not one a triangle.
/// @par Complexity   the matcher's, on 3/2 edges a triangle, or up to 9/2 where that is not enough; about 400 bytes a
///                   triangle.
/// @par Source       Remacle et al., Blossom-Quad, Int. J. Numer. Methods Eng. 89 (2012) 1102-1119, the paper's
///                   reference [4]. Departs: the cross field in the cost; openings inside, which make it certain.
template <Matcher Match>
Quadrangulation quadrangulate(const Surface& surface, const Match& matcher,
                              const QuadrangulationOptions& options = {}) {
  check_options(options);
  const std::size_t n = surface.triangles().size();
  if (!options.frames.empty() && options.frames.size() != n)
    throw invalid_option("there are " + std::to_string(options.frames.size()) + " frames for " + std::to_string(n) +
                         " triangles");
  const detail::PatchSides sides(surface);
  detail::PairingGraph graph(surface, sides, options.frames, options.alignment);
  std::vector<index_t> mate;
  const auto join = [&] {
    mate = matcher(n, graph.edges());
    return std::find(mate.begin(), mate.end(), no_index) == mate.end();
  };
  if (options.goal == QuadGoal::all_quads) {
    graph.add_openings_on_curves(options.curve_opening_cost);
    if (!join()) {
      graph.add_openings_everywhere(options.opening_cost);
      join();
    }
  } else {
    join();
  }
  Quadrangulation result;
  for (const MatchingEdge& edge : graph.edges())
    if (mate[edge.a] == edge.b) result.cost += edge.cost;
  result.n_openings_tried = graph.n_openings();
  detail::PairJoiner joiner(surface, sides, graph, std::move(mate));
  result.mesh = joiner.run();
  result.copied = joiner.copied();
  return result;
}

/// The same for a host's mesh, whose features are found by the default options.
template <TriangleMesh M, Matcher Match>
requires(!std::same_as<M, Surface>) Quadrangulation
    quadrangulate(const M& mesh, const Match& matcher, const QuadrangulationOptions& options = {}) {
  return quadrangulate(Surface(mesh), matcher, options);
}

}  // namespace framehex
