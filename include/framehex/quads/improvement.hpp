// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/quads/detail/quad_cleaner.hpp"

namespace framehex {

struct QuadImprovementOptions {
  int rounds = 4;  ///< 0 to 1000; of changes of the connectivity, each with smoothing after it
  int sweeps = 30;       ///< 0 to 10000; most sweeps of a smoothing
  double bad = 0.4;      ///< 0 to 1; cells of a lower scaled Jacobian are mended by any change that makes them better
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("QuadImprovementOptions::rounds", o.rounds, 0, 1000);
    visit("QuadImprovementOptions::sweeps", o.sweeps, 0, 10'000);
    visit("QuadImprovementOptions::bad", o.bad, 0, 1);
  }
};

/// What an improvement has done.
struct QuadImprovement {
  QuadMesh mesh;
  std::vector<index_t> vertex_of;  ///< for each vertex: that of the mesh given, or `no_index` for a new one
  std::size_t n_changes = 0;       ///< of the connectivity
  Status status = Status::complete;
};

namespace detail {

/// Sweeps over all vertices, but those about which nothing moves any more.
class QuadSmoothing {
public:
  QuadSmoothing(const EditableQuads& quads, QuadSmoother& smoother) : quads_(quads), smoother_(smoother) {}

  bool run(int sweeps, const Observer& observer) {
    std::vector<char> active(quads_.points.size(), 1), next;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      if (!keep_going(observer, "smoothing", static_cast<double>(sweep) / sweeps)) return false;
      next.assign(active.size(), 0);
      bool moved = false;
      for (index_t v = 0; v < active.size(); ++v) {
        if (!active[v] || quads_.name[v] != v || smoother_.relax(v) < least_move) continue;
        moved = true;
        next[v] = 1;
        quads_.for_each_copy(v, [&](index_t copy) {
          quads_.for_each_outgoing(copy, [&](index_t h) {
            for (const index_t w : quads_.corners[h / 4])
              if (w != no_index) next[first_copy(w)] = 1;
          });
        });
      }
      if (!moved) break;
      active.swap(next);
    }
    return true;
  }

private:
  static constexpr double least_move = 2e-3;

  index_t first_copy(index_t v) const {
    index_t first = v;
    quads_.for_each_copy(v, [&](index_t copy) { first = std::min(first, copy); });
    return first;
  }

  const EditableQuads& quads_;
  QuadSmoother& smoother_;
};

}  // namespace detail

inline QuadImprovement improve_quads(const QuadMesh& mesh, const FeatureCarriers& carriers,
                                     const QuadImprovementOptions& options = {}) {
  check_options(options);
  QuadImprovement result;
  detail::EditableQuads quads(mesh);
  detail::QuadSmoother smoother(quads, carriers);
  smoother.settle();
  detail::QuadCleaner cleaner(quads, smoother);
  detail::QuadSmoothing smoothing(quads, smoother);
  cleaner.remove_doublets();
  smoothing.run(options.sweeps, options.observer);
  for (int round = 0; round < options.rounds; ++round) {
    const std::size_t before = cleaner.n_changes();
    cleaner.reduce_irregular();
    smoothing.run(options.sweeps, options.observer);
    cleaner.mend(options.bad);
    if (cleaner.n_changes() == before) break;
    smoothing.run(options.sweeps, options.observer);
  }
  result.n_changes = cleaner.n_changes();
  std::vector<index_t> number(quads.points.size(), no_index);
  const auto out = [&](index_t v) {
    index_t first = v;
    quads.for_each_copy(v, [&](index_t copy) { first = std::min(first, copy); });
    return first;
  };
  std::vector<char> used(quads.points.size(), 0);
  for (index_t q = 0; q < quads.corners.size(); ++q)
    if (quads.alive(q))
      for (index_t i = 0; i < quads.size(q); ++i) used[out(quads.corners[q][i])] = 1;
  for (index_t v = 0; v < used.size(); ++v)
    if (used[v]) {
      number[v] = static_cast<index_t>(result.mesh.points.size());
      result.mesh.points.push_back(quads.points[v]);
      result.vertex_of.push_back(v < mesh.points.size() ? v : no_index);
    }
  for (index_t q = 0; q < quads.corners.size(); ++q) {
    if (!quads.alive(q)) continue;
    QuadMesh::Cell cell = quads.corners[q];
    for (index_t i = 0; i < quads.size(q); ++i) cell[i] = number[out(cell[i])];
    result.mesh.cells.push_back(cell);
    result.mesh.patches.push_back(quads.patch[q]);
  }
  for (const LabelledEdge& edge : mesh.edges)
    result.mesh.edges.push_back({{number[edge.vertices[0]], number[edge.vertices[1]]}, edge.label});
  for (const index_t v : mesh.corners)
    if (number[v] != no_index) result.mesh.corners.push_back(number[v]);
  return result;
}

}  // namespace framehex
