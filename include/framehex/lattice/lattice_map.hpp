// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/lattice_graph.hpp"

#include <cmath>
#include <optional>

namespace framehex {

/// A map of a tetrahedral mesh to the integer lattice, known by the coordinates of its vertices up to whole numbers and
/// by the steps along its edges. References are kept to all three.
class LatticeMap {
public:
  LatticeMap(const LatticeGraph& graph, const std::vector<Vector3>& steps, const std::vector<Vector3>& phases)
      : graph_(graph), steps_(steps), phases_(phases) {}

  const LatticeGraph& graph() const { return graph_; }
  /// Coordinates of a vertex along the axes of its frame, up to whole numbers.
  const Vector3& phase(index_t vertex) const { return phases_[vertex]; }

  /// Difference of the coordinates from v to its neighbour w, in the frame of v: the one nearest to the step.
  Vector3 difference(index_t v, index_t w) const {
    const Vector3 step = graph_.along(steps_, v, w);
    const Vector3 gap = graph_.matching(v, w).to_first(phases_[w]) - phases_[v] - step;
    return step + (gap.array() - gap.array().round()).matrix();
  }

  /// Coordinates of the corners of a simplex in one lattice, along the axes of its first corner; nothing when the
  /// differences do not close: a dislocation passes through it. @pre no singular line passes through the simplex.
  template <std::size_t N>
  std::optional<std::array<Vector3, N>> unwrapped(const std::array<index_t, N>& corners) const {
    std::array<Vector3, N> result;
    result[0] = phases_[corners[0]];
    for (std::size_t i = 1; i < N; ++i) result[i] = result[0] + difference(corners[0], corners[i]);
    for (std::size_t i = 1; i < N; ++i) {
      const AxisMatching& m = graph_.matching(corners[0], corners[i]);
      for (std::size_t j = i + 1; j < N; ++j) {
        const Vector3 miss = result[j] - result[i] - m.to_first(difference(corners[i], corners[j]));
        if (miss.cwiseAbs().maxCoeff() > 0.5) return std::nullopt;
      }
    }
    return result;
  }

private:
  const LatticeGraph& graph_;
  const std::vector<Vector3>& steps_;
  const std::vector<Vector3>& phases_;
};

}  // namespace framehex
