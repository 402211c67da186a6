// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/boundary_axes.hpp"

namespace framehex::detail {

/// A symmetric positive system whose unknowns are a number per vertex and axis, coupled along edges with the matched
/// axis of the neighbour, and its solver.
///
/// K = 1: real numbers. K = 2: complex ones (columns: real and imaginary part), which an edge may turn, and conjugates
/// where the matched axis has the opposite sense. Rows are vertices along a space-filling curve; a row of eight, of 64,
/// and so on makes an aggregate, on whose constants the preconditioner acts beside the diagonal (see RowAggregates).
/// Numbers are single, in lanes of four of which the last is padding, so that one instruction does a vertex: who needs
/// more digits solves for a correction. Sums are double.
template <int K>
class AxisSystem {
public:
  using Lanes = Eigen::Array<float, 4, 1>;  ///< the three axes, and nothing
  using Value = Eigen::Array<float, 4, K>;
  using Values = std::vector<Value>;
  using Entry = Eigen::Matrix<double, 3, K>;

  /// @param masses  n_vertices: M of `solve`.
  AxisSystem(const LatticeGraph& graph, std::span<const double> masses)
      : graph_(graph), order_(spatial_order(graph.points())) {
    const Csr<index_t>& ring = graph.adjacency().vertices_of_vertex;
    const std::size_t n = order_.size();
    row_of_.resize(n);
    for (index_t row = 0; row < n; ++row) row_of_[order_[row]] = row;
    links_.offsets.reserve(n + 1);
    links_.values.reserve(ring.values.size());
    for (const index_t v : order_) {
      for (offset_t s = ring.offsets[v]; s < ring.offsets[v + 1]; ++s) {
        const int g = graph.symmetry(graph.edge_of_slot(s));
        const int from_v = v < ring.values[s] ? g : CubeRotationGroup<>::inverse(g);
        links_.values.push_back({row_of_[ring.values[s]], static_cast<std::uint8_t>(from_v)});
      }
      links_.end_row();
    }
    entries_.assign(ring.values.size(), Value::Zero());
    diagonal_.assign(n, Lanes::Zero());
    free_.assign(n, Lanes(1, 1, 1, 0));
    masses_.reserve(n);
    for (const index_t v : order_) masses_.push_back(static_cast<float>(masses[v]));
  }

  static Lanes lanes(const Vector3& value) {
    return {static_cast<float>(value[0]), static_cast<float>(value[1]), static_cast<float>(value[2]), 0};
  }
  static Vector3 vector(const Lanes& lanes) { return {lanes[0], lanes[1], lanes[2]}; }

  index_t row_of(index_t vertex) const { return row_of_[vertex]; }
  float mass(std::size_t row) const { return masses_[row]; }

  /// Couplings of all edges: `entry(e)` gives for each axis of the lower vertex of edge e the entry with the matched
  /// axis of the higher one: with K = 1 a number c, the term being c z, with K = 2 a complex one, for c z or c conj(z).
  template <class EntryOf>
  void set_couplings(const EntryOf& entry) {
    const Csr<index_t>& ring = graph_.adjacency().vertices_of_vertex;
    for (std::size_t row = 0; row < order_.size(); ++row) {
      const index_t v = order_[row];
      auto at = links_.offsets[row];
      for (offset_t s = ring.offsets[v]; s < ring.offsets[v + 1]; ++s, ++at) {
        const index_t e = graph_.edge_of_slot(s);
        const bool from_lower = v < ring.values[s];
        const Entry value = entry(e);
        const AxisMatching& m = graph_.matching(e);
        for (std::size_t a = 0; a < 3; ++a) {
          const auto i = static_cast<Eigen::Index>(a);
          const auto to = static_cast<Eigen::Index>(from_lower ? a : m.axis[a]);
          entries_[at](to, 0) = static_cast<float>(value(i, 0));
          // Seen from the higher vertex the turn is the inverse, unless it is conjugated.
          if constexpr (K == 2)
            entries_[at](to, 1) = static_cast<float>(from_lower || m.sign[a] < 0 ? value(i, 1) : -value(i, 1));
        }
      }
    }
  }
  void set_diagonal(index_t vertex, const Vector3& entry) { diagonal_[row_of_[vertex]] = lanes(entry); }
  /// @param axes  whose values keep what the start gives them.
  void set_fixed(index_t vertex, AxisMask axes) {
    for (int a = 0; a < 3; ++a) free_[row_of_[vertex]][a] = axes >> a & 1 ? 0.f : 1.f;
  }

  /// To be called after all entries are set, before solving.
  void prepare() {
    levels_.clear();
    for (unsigned shift = 3; levels_.empty() || levels_.back().masses.size() > 8; shift += 3) {
      Level level;
      const std::size_t size = (order_.size() + (std::size_t{1} << shift) - 1) >> shift;
      level.stiffness.assign(size, Vector3::Zero());
      level.masses.assign(size, Vector3::Zero());
      for (std::size_t row = 0; row < order_.size(); ++row) add_to(level, row, shift);
      levels_.push_back(std::move(level));
    }
  }

  /// Solves (A + factor M) x = load on the free unknowns by conjugate gradients.
  ///
  /// @param x, load    by rows.
  /// @param tolerance  of the residual in the preconditioner's norm, of that at the start or, if larger, of `scale`.
  /// @param proceed    asked now and then; false cancels.
  /// @return false when cancelled.
  /// @par Complexity   O(edges) an iteration. Results do not depend on the executor.
  template <class Proceed, class E>
  bool solve(Values& x, const Values& load, double factor, double tolerance, int max_iterations, const Proceed& proceed,
             const E& executor, double scale = 0) {
    const std::size_t n = x.size();
    residual_.resize(n);
    direction_.resize(n);
    image_.resize(n);
    set_factor(factor);
    double rho = sum(n, executor, [&](std::size_t row) {
      residual_[row] = scaled(load[row] - product(x, row), free_[row]);
      return dot(scaled(residual_[row], inverse_[row]), residual_[row]);
    });
    rho += correct(executor);
    start_ = rho;
    turn(0, executor);
    const double target = tolerance * tolerance * std::max(scale, rho);
    for (int iteration = 0; iteration < max_iterations && rho > target; ++iteration) {
      if (iteration % 8 == 0 && !proceed()) return false;
      const double curvature = sum(n, executor, [&](std::size_t row) {
        image_[row] = scaled(product(direction_, row), free_[row]);
        return dot(image_[row], direction_[row]);
      });
      if (!(curvature > 0)) break;
      const auto alpha = static_cast<float>(rho / curvature);
      double next = sum(n, executor, [&](std::size_t row) {
        x[row] += alpha * direction_[row];
        residual_[row] -= alpha * image_[row];
        return dot(scaled(residual_[row], inverse_[row]), residual_[row]);
      });
      next += correct(executor);
      turn(static_cast<float>(next / rho), executor);
      rho = next;
      ++n_iterations_;
    }
    return true;
  }

  /// Square of the residual's norm at the start of the last solve: a `scale` for later ones.
  double start() const { return start_; }
  /// Of all solves so far.
  std::size_t n_iterations() const { return n_iterations_; }

private:
  struct Link {
    index_t row;
    std::uint8_t symmetry;  // from this row's frame
  };
  struct Level {
    std::vector<Vector3> stiffness, masses;  // per aggregate and axis, of free unknowns
    std::vector<Lanes> inverse = {};         // of both, with the factor of the solution
    Values correction = {};
  };

  void add_to(Level& level, std::size_t row, unsigned shift) const {
    const std::size_t aggregate = row >> shift;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto i = static_cast<Eigen::Index>(a);
      if (free_[row][i] == 0) continue;
      double& stiffness = level.stiffness[aggregate][i];
      stiffness += diagonal_[row][i];
      level.masses[aggregate][i] += masses_[row];
      for (offset_t s = links_.offsets[row]; s < links_.offsets[row + 1]; ++s) {
        const Link& link = links_.values[s];
        const AxisMatching& m = axis_matching(link.symmetry);
        if (link.row >> shift != aggregate || m.axis[a] != a || free_[link.row][i] == 0) continue;
        if (K == 1 || m.sign[a] > 0) stiffness += entries_[s](i, 0);
      }
    }
  }

  static Value scaled(Value value, const Lanes& by) {
    for (int k = 0; k < K; ++k) value.col(k) *= by;
    return value;
  }
  static double dot(const Value& x, const Value& y) { return static_cast<double>((x * y).sum()); }

  static Lanes inverse_of(const Lanes& value) {
    Lanes result;
    for (int a = 0; a < 4; ++a) result[a] = value[a] > 0 ? 1 / value[a] : 0;
    return result;
  }

  void set_factor(double factor) {
    const auto f = static_cast<float>(factor);
    total_.resize(diagonal_.size());
    inverse_.resize(diagonal_.size());
    for (std::size_t row = 0; row < diagonal_.size(); ++row) {
      total_[row] = diagonal_[row] + f * masses_[row];
      inverse_[row] = inverse_of(total_[row] * free_[row]);
    }
    for (Level& level : levels_) {
      level.inverse.clear();
      for (std::size_t i = 0; i < level.masses.size(); ++i)
        level.inverse.push_back(inverse_of(lanes(level.stiffness[i] + factor * level.masses[i])));
      level.correction.resize(level.masses.size());
    }
  }

  Value product(const Values& x, std::size_t row) const {
    Value y = scaled(x[row], total_[row]);
    for (offset_t s = links_.offsets[row]; s < links_.offsets[row + 1]; ++s) {
      const Link& link = links_.values[s];
      if (link.symmetry == 0)
        add(entries_[s], x[link.row], y);
      else
        add(entries_[s], matched(link.symmetry, x[link.row]), y);
    }
    return y;
  }

  static void add(const Value& c, const Value& z, Value& y) {
    if constexpr (K == 1) {
      y += c * z;
    } else {
      y.col(0) += c.col(0) * z.col(0) - c.col(1) * z.col(1);
      y.col(1) += c.col(1) * z.col(0) + c.col(0) * z.col(1);
    }
  }

  /// A neighbour's values along the axes of this row's frame; senses of real ones are the entries' business.
  static Value matched(int symmetry, const Value& z) {
    const AxisMatching& m = axis_matching(symmetry);
    Value result = Value::Zero();
    for (std::size_t a = 0; a < 3; ++a) {
      const auto i = static_cast<Eigen::Index>(a);
      const auto b = static_cast<Eigen::Index>(m.axis[a]);
      result(i, 0) = z(b, 0);
      if constexpr (K == 2) result(i, 1) = static_cast<float>(m.sign[a]) * z(b, 1);
    }
    return result;
  }

  /// Corrections of the aggregates: the sum over all levels ends in those of the lowest. @return their part of the
  /// preconditioner's norm.
  template <class E>
  double correct(const E& executor) {
    for (std::size_t level = 0; level < levels_.size(); ++level) {
      const Values& fine = level == 0 ? residual_ : levels_[level - 1].correction;
      Values& coarse = levels_[level].correction;
      for_blocks(executor, coarse.size(), block_size, [&](std::size_t first, std::size_t last) {
        for (std::size_t a = first; a < last; ++a) {
          Value total = Value::Zero();
          for (std::size_t i = 8 * a, end = std::min(i + 8, fine.size()); i < end; ++i) total += fine[i];
          coarse[a] = total;
        }
      });
    }
    double product = 0;
    for (std::size_t level = levels_.size(); level-- > 0;) {
      Values& values = levels_[level].correction;
      product += sum(values.size(), executor, [&](std::size_t a) {
        const Value restricted = values[a];
        values[a] = scaled(restricted, levels_[level].inverse[a]);
        const double term = dot(restricted, values[a]);
        if (level + 1 < levels_.size()) values[a] += levels_[level + 1].correction[a >> 3];
        return term;
      });
    }
    return product;
  }

  /// The next direction: the preconditioned residual and a share of the last.
  template <class E>
  void turn(float share, const E& executor) {
    for_blocks(executor, residual_.size(), block_size, [&](std::size_t first, std::size_t last) {
      for (std::size_t row = first; row < last; ++row) {
        const Value step = scaled(levels_[0].correction[row >> 3], free_[row]) + scaled(residual_[row], inverse_[row]);
        direction_[row] = share == 0 ? step : Value(step + share * direction_[row]);
      }
    });
  }

  template <class E, class Term>
  double sum(std::size_t n, const E& executor, const Term& term) {
    return sum_by_blocks(executor, n, block_size, partial_, term);
  }

  const LatticeGraph& graph_;
  std::vector<index_t> order_, row_of_;
  Csr<Link> links_;
  Values entries_;  // one a link
  std::vector<Lanes> diagonal_, free_;
  std::vector<float> masses_;
  std::vector<Level> levels_;
  std::vector<Lanes> total_, inverse_;  // with the factor of the solution
  double start_ = 0;
  std::size_t n_iterations_ = 0;
  Values residual_, direction_, image_;
  std::vector<double> partial_;
};

}  // namespace framehex::detail
