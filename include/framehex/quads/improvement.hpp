// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/quads/detail/quad_cleaner.hpp"

namespace framehex {

/// What an improvement may change.
enum class QuadImprovementScope {
  everywhere,
  folded,  ///< no more than it takes to unfold cells, and those below a scaled Jacobian of 0.05 with them
  sound    ///< everywhere, but cells are never folded on the way: without folded cells given, none comes out
};

/// Options of `improve_quads`.
struct QuadImprovementOptions {
  QuadImprovementScope scope = QuadImprovementScope::everywhere;
  int rounds = 4;    ///< 0 to 1000; of changes of the connectivity, each with smoothing after it
  int sweeps = 30;   ///< 0 to 10000; most sweeps of a smoothing
  double bad = 0.4;  ///< 0 to 1; cells of a lower scaled Jacobian are mended by any change that makes them better
  /// In diagonals of the box round the surface, > 0: how far a side along a curve may come to be from it when its ends
  /// slide, yet no farther than a twentieth of the side; or as far as the worst side given of that curve. Infinite: the
  /// twentieth alone counts.
  double max_deviation = 0.0075;
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("QuadImprovementOptions::rounds", o.rounds, 0, 1000);
    visit("QuadImprovementOptions::sweeps", o.sweeps, 0, 10'000);
    visit("QuadImprovementOptions::bad", o.bad, 0, 1);
    visit("QuadImprovementOptions::max_deviation", o.max_deviation, least_positive, unbounded);
  }
};

/// What an improvement has made of a mesh.
struct QuadImprovement {
  QuadMesh mesh;
  std::vector<index_t> vertex_of;  ///< for each vertex: that of the mesh given, or `no_index` for a new one
  /// Cells of `mesh` that are not convex, seen against the mean normal at their corners, and quadrilaterals that have a
  /// corner that is flat (a scaled Jacobian below 1e-6).
  std::vector<index_t> folded;
  std::size_t n_folded_given = 0;  ///< such cells of the mesh given, once its vertices lie on their patches and curves
  std::size_t n_changes = 0;       ///< of the connectivity
  std::size_t n_tried = 0;         ///< the same, with those that were taken back
  Status status = Status::complete;
};

namespace detail {

class QuadImprover {
public:
  QuadImprover(const QuadMesh& mesh, const FeatureCarriers& carriers, const QuadImprovementOptions& options)
      : mesh_(mesh),
        options_(options),
        quads_(mesh),
        smoother_(settled(quads_, carriers, options.max_deviation)),
        cleaner_(quads_, smoother_) {}

  QuadImprovement run() {
    QuadImprovement result;
    result.n_folded_given = folded_cells().size();
    smoother_.keep_sound(options_.scope == QuadImprovementScope::sound);
    const bool done = options_.scope == QuadImprovementScope::folded ? unfold() : improve();
    if (!done) result.status = Status::cancelled;
    write(result);
    result.n_changes = cleaner_.n_changes();
    result.n_tried = cleaner_.n_tried();
    return result;
  }

private:
  static constexpr double least_move = 5e-3;     ///< of a mean edge; what moves less is at rest
  static constexpr double nearly_folded = 0.05;  ///< scaled Jacobian

  static QuadSmoother settled(EditableQuads& quads, const FeatureCarriers& carriers, double max_deviation) {
    QuadSmoother smoother(quads, carriers, max_deviation);
    smoother.settle();
    return smoother;
  }

  bool improve() {
    if (options_.rounds > 0 && options_.scope == QuadImprovementScope::everywhere) cleaner_.remove_doublets();
    if (!smooth()) return false;
    for (int round = 0; round < options_.rounds; ++round) {
      const std::size_t before = cleaner_.n_changes();
      if (!cleaner_.reduce_irregular(options_.observer) || !smooth()) return false;
      if (!cleaner_.mend(options_.bad, options_.observer)) return false;
      if (cleaner_.n_changes() == before) break;
      if (!smooth()) return false;
    }
    return true;
  }

  /// Moves the corners of folded cells and of those beside them, then changes the connectivity there, until none is left.
  bool unfold() {
    if (options_.rounds > 0) cleaner_.remove_doublets();
    std::vector<index_t> folded = folded_cells();
    for (int round = 0; round < options_.rounds && !folded.empty(); ++round) {
      const std::vector<index_t> region = corners_about(folded);
      for (int sweep = 0; sweep < options_.sweeps; ++sweep) {
        if (!keep_going(options_.observer, "improvement", 0)) return false;
        for (const index_t v : region) smoother_.relax(v);
      }
      if (!cleaner_.mend(nearly_folded, options_.observer)) return false;
      folded = folded_cells();
    }
    return true;
  }

  std::vector<index_t> folded_cells() const {
    std::vector<index_t> folded;
    for (index_t q = 0; q < quads_.corners.size(); ++q)
      if (quads_.alive(q) && !smoother_.is_sound(q)) folded.push_back(q);
    return folded;
  }

  std::vector<index_t> corners_about(const std::vector<index_t>& cells) const {
    std::vector<index_t> region;
    for (const index_t q : cells)
      for (index_t i = 0; i < quads_.size(q); ++i)
        quads_.for_each_corner_about(quads_.corners[q][i], [&](index_t v) { region.push_back(v); });
    std::sort(region.begin(), region.end());
    region.erase(std::unique(region.begin(), region.end()), region.end());
    return region;
  }

  /// Sweeps over the vertices that have not come to rest, those about changes and new ones.
  bool smooth() {
    active_.resize(quads_.points.size(), 1);
    for (const index_t v : cleaner_.take_changed()) active_[v] = 1;
    std::vector<char> next;
    bool moved = true;
    for (int sweep = 0; sweep < options_.sweeps && std::exchange(moved, false); ++sweep) {
      next.assign(active_.size(), 0);
      for (index_t v = 0; v < active_.size(); ++v) {
        if (v % 4096 == 0 && !keep_going(options_.observer, "improvement", 0)) return false;
        if (!active_[v] || smoother_.relax(v) < least_move) continue;
        moved = true;
        quads_.for_each_corner_about(v, [&](index_t w) { next[w] = 1; });
      }
      active_.swap(next);
    }
    return true;
  }

  /// Vertices of the mesh given in their order, then new ones; those without cells are left out.
  void write(QuadImprovement& result) const {
    index_t n_names = 0;
    for (const index_t name : quads_.name) n_names = std::max(n_names, name + 1);
    std::vector<index_t> copy_of(n_names, no_index), number(n_names, no_index);
    for (index_t v = 0; v < quads_.points.size(); ++v)
      if (quads_.half_edge_of[v] != no_index) copy_of[quads_.name[v]] = v;
    for (index_t name = 0; name < n_names; ++name) {
      if (copy_of[name] == no_index) continue;
      number[name] = static_cast<index_t>(result.mesh.points.size());
      result.mesh.points.push_back(quads_.points[copy_of[name]]);
      result.vertex_of.push_back(name < mesh_.points.size() ? name : no_index);
    }
    for (index_t q = 0; q < quads_.corners.size(); ++q) {
      if (!quads_.alive(q)) continue;
      QuadMesh::Cell cell = quads_.corners[q];
      for (index_t i = 0; i < quads_.size(q); ++i) cell[i] = number[quads_.name[cell[i]]];
      if (!smoother_.is_sound(q)) result.folded.push_back(static_cast<index_t>(result.mesh.cells.size()));
      result.mesh.cells.push_back(cell);
      result.mesh.patches.push_back(quads_.patch[q]);
    }
    for (const LabelledEdge& edge : mesh_.edges)
      result.mesh.edges.push_back({{number[edge.vertices[0]], number[edge.vertices[1]]}, edge.label});
    for (const index_t v : mesh_.corners)
      if (number[v] != no_index) result.mesh.corners.push_back(number[v]);
  }

  const QuadMesh& mesh_;
  const QuadImprovementOptions& options_;
  EditableQuads quads_;
  QuadSmoother smoother_;
  QuadCleaner cleaner_;
  std::vector<char> active_;  ///< by copy of a vertex: has moved in the last sweep, or beside one that has
};

}  // namespace detail

/// Makes quadrilaterals better: vertices move, those of curves along them, corners not; connectivity is changed where
/// more vertices have as many cells as fit round them after it, or where a bad cell becomes better.
///
/// Vertices of two cells inside go. Every change is tried with the vertices about it smoothed, and taken back unless the
/// worst cell there stays good enough. Curves keep their vertices, so that meshes beside each other still fit.
///
/// @param mesh      its `edges` are kept; rim vertices without one stay where they are.
/// @param carriers  of the surface whose patches and curves the labels of `mesh` number.
/// @return with `Status::cancelled` the mesh as far as it has come.
/// @throws invalid_option; invalid_connectivity for labels that no patch or curve has (the cell or the edge);
///         nonmanifold  with an edge of more than two cells that is on no curve.
/// @par Complexity   about O(n); 600 bytes a cell.
/// @par Source       Changes of connectivity as Kinney, Proc. 6th Int. Meshing Roundtable (1997) 449-461. Departs: tried
///                   with smoothing, and journaled.
inline QuadImprovement improve_quads(const QuadMesh& mesh, const FeatureCarriers& carriers,
                                     const QuadImprovementOptions& options = {}) {
  check_options(options);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.patches[c] >= carriers.n_patches())
      throw invalid_connectivity("cell " + std::to_string(c) + " is of patch " + std::to_string(mesh.patches[c]) +
                                     " of " + std::to_string(carriers.n_patches()),
                                 Entity::cell, {c});
  for (const LabelledEdge& edge : mesh.edges)
    if (edge.label >= carriers.n_curves())
      throw invalid_connectivity(
          "an edge is of curve " + std::to_string(edge.label) + " of " + std::to_string(carriers.n_curves()),
          Entity::edge, {edge.vertices[0], edge.vertices[1]});
  return detail::QuadImprover(mesh, carriers, options).run();
}

}  // namespace framehex
