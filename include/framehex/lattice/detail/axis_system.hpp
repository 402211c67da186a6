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
/// Off-diagonal entries are single: they only weigh the equations, whose values are double.
template <int K>
class AxisSystem {
public:
  using Value = Eigen::Matrix<double, 3, K>;
  using Values = std::vector<Value>;

  /// @param masses  n_vertices: M of `solve`.
  AxisSystem(const LatticeGraph& graph, std::span<const double> masses)
      : graph_(graph), order_(spatial_order(graph.points())) {
    const Csr<index_t>& ring = graph.adjacency().vertices_of_vertex;
    const std::size_t n = order_.size();
    row_of_.resize(n);
    for (index_t row = 0; row < n; ++row) row_of_[order_[row]] = row;
    couplings_.offsets.reserve(n + 1);
    couplings_.values.reserve(ring.values.size());
    for (const index_t v : order_) {
      for (offset_t s = ring.offsets[v]; s < ring.offsets[v + 1]; ++s) {
        const int g = graph.symmetry(graph.edge_of_slot(s));
        const int from_v = v < ring.values[s] ? g : CubeRotationGroup<>::inverse(g);
        couplings_.values.push_back({row_of_[ring.values[s]], static_cast<std::uint8_t>(from_v), {}});
      }
      couplings_.end_row();
    }
    diagonal_.assign(n, Vector3::Zero());
    fixed_.assign(n, 0);
    masses_.reserve(n);
    for (const index_t v : order_) masses_.push_back(masses[v]);
  }

  index_t row_of(index_t vertex) const { return row_of_[vertex]; }
  double mass(std::size_t row) const { return masses_[row]; }

  /// Couplings of all edges: `entry(e)` gives for each axis of the lower vertex of edge e the entry with the matched
  /// axis of the higher one: with K = 1 a Vector3, with K = 2 a complex number c, the term being -c z or -c conj(z).
  template <class Entry>
  void set_couplings(const Entry& entry) {
    const Csr<index_t>& ring = graph_.adjacency().vertices_of_vertex;
    for (std::size_t row = 0; row < order_.size(); ++row) {
      const index_t v = order_[row];
      auto at = couplings_.offsets[row];
      for (offset_t s = ring.offsets[v]; s < ring.offsets[v + 1]; ++s, ++at) {
        const index_t e = graph_.edge_of_slot(s);
        const Value value = entry(e);
        const AxisMatching& m = graph_.matching(e);
        auto& out = couplings_.values[at].entry;
        for (std::size_t a = 0; a < 3; ++a) {
          const auto i = static_cast<Eigen::Index>(a);
          const std::size_t to = v < ring.values[s] ? a : m.axis[a];
          out[std::size_t{K} * to] = static_cast<float>(value(i, 0));
          // Seen from the higher vertex the turn is the inverse, unless it is conjugated.
          if constexpr (K == 2)
            out[std::size_t{K} * to + 1] =
                static_cast<float>(v < ring.values[s] || m.sign[a] < 0 ? value(i, 1) : -value(i, 1));
        }
      }
    }
  }
  void set_diagonal(index_t vertex, const Vector3& entry) { diagonal_[row_of_[vertex]] = entry; }
  /// @param axes  whose values keep what the start gives them.
  void set_fixed(index_t vertex, AxisMask axes) { fixed_[row_of_[vertex]] = axes; }
  AxisMask fixed(std::size_t row) const { return fixed_[row]; }

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
  /// @param tolerance  of the residual in the preconditioner's norm, of that at the start or, if given, of `scale`.
  /// @param proceed    asked now and then; false cancels.
  /// @return false when cancelled.
  /// @par Complexity   O(edges) an iteration. Results do not depend on the executor.
  template <class Proceed, class E>
  bool solve(Values& x, const Values& load, double factor, double tolerance, int max_iterations, const Proceed& proceed,
             const E& executor, double scale = 0) {
    const std::size_t n = x.size();
    factor_ = factor;
    residual_.resize(n);
    direction_.resize(n);
    image_.resize(n);
    corrections_.resize(levels_.size());
    for (std::size_t l = 0; l < levels_.size(); ++l) corrections_[l].resize(levels_[l].masses.size());
    double rho = sum(n, executor, [&](std::size_t row) {
      residual_[row] = freed(row, load[row] - product(x, row));
      return local(row, residual_[row]).cwiseProduct(residual_[row]).sum();
    });
    rho += correct(executor);
    start_ = rho;
    turn(0, executor);
    const double target = tolerance * tolerance * (scale > 0 ? scale : rho);
    for (int iteration = 0; iteration < max_iterations && rho > target; ++iteration) {
      if (iteration % 8 == 0 && !proceed()) return false;
      const double curvature = sum(n, executor, [&](std::size_t row) {
        image_[row] = freed(row, product(direction_, row));
        return image_[row].cwiseProduct(direction_[row]).sum();
      });
      if (!(curvature > 0)) break;
      const double alpha = rho / curvature;
      double next = sum(n, executor, [&](std::size_t row) {
        x[row] += alpha * direction_[row];
        residual_[row] -= alpha * image_[row];
        return local(row, residual_[row]).cwiseProduct(residual_[row]).sum();
      });
      next += correct(executor);
      turn(next / rho, executor);
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
  struct Coupling {
    index_t row;
    std::uint8_t symmetry;  // from this row's frame
    std::array<float, std::size_t{3} * K> entry;
  };
  struct Level {
    std::vector<Vector3> stiffness, masses;  // per aggregate and axis, of free unknowns
  };

  void add_to(Level& level, std::size_t row, unsigned shift) const {
    const std::size_t aggregate = row >> shift;
    for (std::size_t a = 0; a < 3; ++a) {
      if (fixed_[row] >> a & 1) continue;
      const auto i = static_cast<Eigen::Index>(a);
      double& stiffness = level.stiffness[aggregate][i];
      stiffness += diagonal_[row][i];
      level.masses[aggregate][i] += masses_[row];
      for (const Coupling& c : couplings_[row]) {
        const AxisMatching& m = axis_matching(c.symmetry);
        if (c.row >> shift != aggregate || m.axis[a] != a || (fixed_[c.row] >> a & 1)) continue;
        if constexpr (K == 1)
          stiffness += c.entry[a];
        else if (m.sign[a] > 0)
          stiffness -= c.entry[2 * a];
      }
    }
  }

  Value freed(std::size_t row, Value value) const {
    for (int a = 0; a < 3; ++a)
      if (fixed_[row] >> a & 1) value.row(a).setZero();
    return value;
  }

  Value product(const Values& x, std::size_t row) const {
    const Vector3 diagonal = diagonal_[row].array() + factor_ * masses_[row];
    Value y = x[row];
    for (int k = 0; k < K; ++k) y.col(k).array() *= diagonal.array();
    for (const Coupling& c : couplings_[row]) {
      const Value& z = x[c.row];
      if (c.symmetry == 0) {
        add_matched(c, z, y);
        continue;
      }
      const AxisMatching& m = axis_matching(c.symmetry);
      for (std::size_t a = 0; a < 3; ++a) {
        const auto i = static_cast<Eigen::Index>(a);
        const auto b = static_cast<Eigen::Index>(m.axis[a]);
        if constexpr (K == 1) {
          y(i, 0) += c.entry[a] * z(b, 0);
        } else {
          const double imaginary = m.sign[a] * z(b, 1);
          y(i, 0) -= c.entry[2 * a] * z(b, 0) - c.entry[2 * a + 1] * imaginary;
          y(i, 1) -= c.entry[2 * a + 1] * z(b, 0) + c.entry[2 * a] * imaginary;
        }
      }
    }
    return y;
  }

  /// The term of a neighbour whose axes have the same numbers, as most have.
  static void add_matched(const Coupling& c, const Value& z, Value& y) {
    for (int a = 0; a < 3; ++a) {
      if constexpr (K == 1) {
        y(a, 0) += c.entry[static_cast<std::size_t>(a)] * z(a, 0);
      } else {
        const double real = c.entry[static_cast<std::size_t>(2 * a)],
                     imaginary = c.entry[static_cast<std::size_t>(2 * a + 1)];
        y(a, 0) -= real * z(a, 0) - imaginary * z(a, 1);
        y(a, 1) -= imaginary * z(a, 0) + real * z(a, 1);
      }
    }
  }

  /// The residual over the diagonal.
  Value local(std::size_t row, const Value& residual) const {
    const Vector3 diagonal = diagonal_[row].array() + factor_ * masses_[row];
    return divided(residual, diagonal);
  }

  static Value divided(Value value, const Vector3& by) {
    for (int a = 0; a < 3; ++a) {
      if (by[a] > 0)
        value.row(a) /= by[a];
      else
        value.row(a).setZero();
    }
    return value;
  }

  /// Corrections of the aggregates: the sum over all levels ends in those of the lowest. @return their part of the
  /// preconditioner's norm.
  template <class E>
  double correct(const E& executor) {
    for (std::size_t level = 0; level < levels_.size(); ++level) {
      const Values& fine = level == 0 ? residual_ : corrections_[level - 1];
      Values& coarse = corrections_[level];
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
      Values& values = corrections_[level];
      product += sum(values.size(), executor, [&](std::size_t a) {
        const Value restricted = values[a];
        const Vector3 by = levels_[level].stiffness[a] + factor_ * levels_[level].masses[a];
        values[a] = divided(restricted, by);
        const double term = restricted.cwiseProduct(values[a]).sum();
        if (level + 1 < levels_.size()) values[a] += corrections_[level + 1][a >> 3];
        return term;
      });
    }
    return product;
  }

  /// The next direction: the preconditioned residual and a share of the last.
  template <class E>
  void turn(double share, const E& executor) {
    for_blocks(executor, residual_.size(), block_size, [&](std::size_t first, std::size_t last) {
      for (std::size_t row = first; row < last; ++row) {
        const Value step = freed(row, corrections_[0][row >> 3]) + local(row, residual_[row]);
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
  Csr<Coupling> couplings_;
  std::vector<Vector3> diagonal_;
  std::vector<double> masses_;
  std::vector<AxisMask> fixed_;
  std::vector<Level> levels_;
  double factor_ = 0, start_ = 0;
  std::size_t n_iterations_ = 0;
  Values residual_, direction_, image_;
  std::vector<Values> corrections_;
  std::vector<double> partial_;
};

}  // namespace framehex::detail
