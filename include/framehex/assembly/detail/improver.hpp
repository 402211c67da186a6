// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/reconnector.hpp"
#include "framehex/assembly/detail/stubborn_cells.hpp"
#include "framehex/assembly/detail/vertex_smoother.hpp"
#include "framehex/observer.hpp"

namespace framehex::detail {

/// Alternates between moving vertices and reconnecting until the energy hardly falls. All loops have a fixed number of
/// rounds, and within a round each bad cell or vertex is worked on once.
class Improver {
public:
  Improver(CellComplex& complex, const QualityEnergy& energy, const VertexSmoother::Projection& projection,
           AssemblyStatistics& statistics, Pulse& pulse)
      : complex_(complex),
        energy_(energy),
        smoother_(complex, energy, projection),
        reconnector_(complex, energy),
        stubborn_(complex, energy, statistics),
        pulse_(pulse) {}

  /// First without the vertices of hexahedra, whose volume and quality are worth keeping, then with them.
  /// @param may_split  whether a hexahedron or prism may be split to free a bad cell next to it; that makes pyramids.
  void run(int max_rounds, bool may_split) {
    const double first = pulse_.fraction();
    for (const bool hexahedra_too : {false, true}) {
      double before = collect();
      for (int round = 0; round < max_rounds && !bad_.empty(); ++round) {
        fraction_ = first + (1 - first) * ((hexahedra_too ? 0.4 : 0) + 0.4 * round / max_rounds);
        smooth(2, hexahedra_too);
        reconnect();
        const double after = collect();
        if (after > 0.9 * before) break;
        before = after;
      }
    }
    fraction_ = first + (1 - first) * 0.8;
    smooth(5, true);
    widen();
    for (const double quality : {0.6, 0.4}) {
      if (!replace_stubborn(quality, false)) continue;
      smooth(3, true);
      reconnect();
    }
    if (may_split && replace_stubborn(0.3, true)) {
      smooth(3, true);
      reconnect();
      smooth(3, true);
    }
    widen();
    for (int round = 0; may_split && round < 3; ++round) {
      const bool replaced = replace_stubborn(least_other, true);
      if (!split_stuck_hexahedra() && !replaced) break;
      smooth(3, true);
      reconnect();
      widen();
    }
  }

  /// Works on all cells near the worst ones too: these are stuck because those have no room to give.
  void widen() {
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 4; ++round) {
      collect();
      double energy = 0;
      std::vector<index_t> vertices;
      for (const Bad& b : bad_) {
        if (b.worst >= stuck) break;
        energy += QualityEnergy::penalty(b.worst);
        for (const index_t v : complex_.corners(b.cell))
          complex_.for_each_cell_at(v, [&](index_t cell) {
            for (const index_t w : complex_.corners(cell)) vertices.push_back(w);
          });
      }
      if (vertices.empty() || energy > 0.9 * before) return;
      before = energy;
      std::sort(vertices.begin(), vertices.end());
      vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
      for (int sweep = 0; sweep < 3; ++sweep)
        for (const index_t v : vertices) {
          if (!pulse_.beat(fraction_)) return;
          smoother_.smooth(v, 0.0);
        }
      std::vector<index_t> cells;
      for (const index_t v : vertices) complex_.for_each_cell_at(v, [&](index_t cell) { cells.push_back(cell); });
      std::sort(cells.begin(), cells.end());
      cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
      for (const index_t cell : cells) {
        double worst = std::numeric_limits<double>::infinity();
        if (!pulse_.beat(fraction_)) return;
        if (complex_.cells[cell].alive && energy_.of(complex_, cell, worst) > 0) reconnector_.improve(cell);
      }
    }
  }

  /// @param quality  over the target, below which a cell is stubborn.
  bool replace_stubborn(double quality, bool hexahedra_too) {
    collect();
    const std::vector<Bad> bad = bad_;
    std::size_t n_replaced = 0;
    for (const Bad& b : bad) {
      if (b.worst >= quality || !pulse_.beat(fraction_)) break;
      if (!complex_.cells[b.cell].alive) continue;
      const bool may_split = hexahedra_too && !complex_.is_spared(b.cell);
      if (stubborn_.insert_vertex(b.cell) || (may_split && stubborn_.split_neighbour(b.cell))) ++n_replaced;
    }
    return n_replaced > 0;
  }

  /// A hexahedron that nothing has brought near its target is worth less than the pyramids it makes.
  bool split_stuck_hexahedra() {
    collect();
    const std::vector<Bad> bad = bad_;
    std::size_t n_split = 0;
    for (const Bad& b : bad) {
      if (b.worst >= least_hexahedron || !pulse_.beat(fraction_)) break;
      const auto& cell = complex_.cells[b.cell];
      if (!cell.alive || cell.kind != CellKind::hexahedron || complex_.is_spared(b.cell)) continue;
      if (stubborn_.split_neighbour(b.cell, least_other)) ++n_split;
    }
    return n_split > 0;
  }

  /// Finds the cells clearly below their target, worst first. @return the energy of all that are to be worked on.
  double collect() {
    bad_.clear();
    double total = 0;
    for (index_t cell = 0; cell < complex_.cells.size(); ++cell) {
      if (!complex_.cells[cell].alive || complex_.is_settled(cell)) continue;
      double worst = std::numeric_limits<double>::infinity();
      const double energy = energy_.of(complex_, cell, worst);
      if (worst < QualityEnergy::good_enough) bad_.push_back({worst, cell});
      total += energy;
    }
    std::sort(bad_.begin(), bad_.end(),
              [](const Bad& x, const Bad& y) { return x.worst != y.worst ? x.worst < y.worst : x.cell < y.cell; });
    return total;
  }

  void smooth(int max_sweeps, bool hexahedra_too) {
    collect();
    std::vector<index_t> vertices;
    for (const Bad& bad : bad_)
      for (const index_t v : complex_.corners(bad.cell))
        if (hexahedra_too || !in_hexahedron(v)) vertices.push_back(v);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    smoothed_.resize(complex_.n_vertices(), 0);
    for (int sweep = 0; sweep < max_sweeps; ++sweep) {
      std::size_t n_moved = 0;
      for (const index_t v : vertices) {
        if (!complex_.changed_since(v, smoothed_[v])) continue;
        if (!pulse_.beat(fraction_)) return;
        smoothed_[v] = complex_.tick();
        if (smoother_.smooth(v)) ++n_moved;
      }
      if (n_moved == 0) break;
    }
  }

  void reconnect() {
    collect();
    const std::vector<Bad> bad = bad_;
    for (const Bad& b : bad) {
      if (!complex_.cells[b.cell].alive) continue;
      reconnected_.resize(complex_.cells.size(), 0);
      if (!complex_.cell_changed_since(b.cell, reconnected_[b.cell])) continue;
      if (!pulse_.beat(fraction_)) return;
      reconnected_[b.cell] = complex_.tick();
      reconnector_.improve(b.cell);
    }
  }

  struct Bad {
    double worst;
    index_t cell;
  };
  const std::vector<Bad>& bad() const { return bad_; }

private:
  bool in_hexahedron(index_t vertex) const {
    bool found = false;
    complex_.for_each_cell_at(vertex, [&](index_t cell) {
      found =
          found || complex_.cells[cell].kind == CellKind::hexahedron || complex_.cells[cell].kind == CellKind::prism;
    });
    return found;
  }

  // Over the target.
  static constexpr double stuck = 0.7;
  static constexpr double least_hexahedron = 0.81;  ///< 0.353 at the default target
  static constexpr double least_other = 0.56;       ///< 0.152 at the default target

  CellComplex& complex_;
  QualityEnergy energy_;
  VertexSmoother smoother_;
  Reconnector reconnector_;
  StubbornCells stubborn_;
  Pulse& pulse_;
  double fraction_ = 0;
  std::vector<Bad> bad_;
  std::vector<CellComplex::Time> smoothed_;     ///< by vertex: when it was tried last
  std::vector<CellComplex::Time> reconnected_;  ///< by cell
};

}  // namespace framehex::detail
