// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/detail/whole_mesh.hpp"
#include "framehex/field/frame_measures.hpp"
#include "framehex/observer.hpp"

#include <optional>

namespace framehex::detail {

/// The Laplacian of a mesh as a weighted graph, and the volume of each vertex; both along a space-filling curve, by
/// "rows". Lengths are in the mesh's own unit, or powers of them would leave single precision.
///
/// @tparam Holding  see WholeMesh; rows of the halo have a number, and nothing else.
template <class Holding = WholeMesh>
struct LaplaceSystem {
  std::vector<index_t> order;    ///< row -> vertex
  Csr<index_t> ring;             ///< neighbours of each row of one's own, as rows
  std::vector<float> weights;    ///< per directed edge, own unit; see dirichlet_weights
  std::vector<double> diagonal;  ///< sums of the rows
  std::vector<double> masses;    ///< per row, cubes of the own unit

  Holding holding;

  LaplaceSystem(const TetAdjacency& adjacency, std::span<const Vector3> host_points, const Holding& holder = {})
      : order(holder.rows(host_points)), holding(holder) {
    const double unit = holding.unit(host_points);
    std::vector<Vector3> points;
    points.reserve(host_points.size());
    for (const Vector3& p : host_points) points.push_back(unit * p);
    const Csr<index_t>& source = adjacency.vertices_of_vertex;
    const std::vector<double> by_vertex = dirichlet_weights(adjacency, points);
    std::vector<double> volume(points.size(), 0.0);
    for (const auto& t : adjacency.tets) {
      const Vector3& a = points[t[0]];
      const double quarter = std::abs((points[t[1]] - a).cross(points[t[2]] - a).dot(points[t[3]] - a)) / 24;
      for (const index_t v : t) volume[v] += quarter;
    }
    std::vector<index_t> row_of(points.size());
    for (index_t row = 0; row < order.size(); ++row) row_of[order[row]] = row;
    ring.offsets.reserve(source.offsets.size());
    ring.values.reserve(source.values.size());
    weights.reserve(source.values.size());
    for (const index_t v : std::span(order).first(holding.n_own(order.size()))) {
      double sum = 0;
      for (offset_t s = source.offsets[v]; s < source.offsets[v + 1]; ++s) {
        ring.values.push_back(row_of[source.values[s]]);
        weights.push_back(static_cast<float>(by_vertex[s]));
        sum += weights.back();
      }
      ring.end_row();
      diagonal.push_back(sum);
      masses.push_back(volume[v]);
    }
  }

  std::size_t n_own() const { return masses.size(); }
};

/// Eight rows in a row of the space-filling curve make an aggregate, eight of these a larger one, and so on: the spaces
/// of functions constant on them, in which conjugate gradients see the long waves.
///
/// An aggregate of level l holds the rows of equal row >> 3 (l + 1), counted over all holders. Those of the first
/// `n_local_levels` levels lie with one holder, who has them alone; the others, few, are known to all.
class RowAggregates {
public:
  struct Level {
    std::vector<double> stiffness, masses;  ///< Galerkin diagonal of the Laplacian, volume; per aggregate
  };
  static constexpr std::size_t n_local_levels = 3;
  static_assert(row_block % (std::size_t{1} << (3 * n_local_levels)) == 0);

  /// @param freedom  `freedom(row)`: the share of a value's components that the constraint leaves free, in [0, 1].
  /// @par Complexity O(edges log n).
  template <class Holding, class Freedom>
  RowAggregates(const LaplaceSystem<Holding>& system, const Freedom& freedom) {
    const std::size_t n = system.holding.n_rows(system.n_own());
    for (unsigned shift = 3;; shift += 3) {
      levels_.push_back(make_level(system, freedom, shift));
      if ((n + (std::size_t{1} << shift) - 1) >> shift <= 8) break;
    }
  }

  std::span<const Level> levels() const { return levels_; }

private:
  template <class Holding, class Freedom>
  static Level make_level(const LaplaceSystem<Holding>& system, const Freedom& freedom, unsigned shift) {
    // Larger aggregates are summed in two steps, the second after the holders' have come together.
    constexpr unsigned largest_local = 3 * n_local_levels;
    const unsigned step = std::min(shift, largest_local);
    const std::size_t first_row = system.holding.first_row();
    const std::size_t size = (system.n_own() + (std::size_t{1} << step) - 1) >> step;
    Level level{std::vector<double>(size, 0.0), std::vector<double>(size, 0.0)};
    for (std::size_t u = 0; u < system.n_own(); ++u) {
      if (freedom(u) == 0) continue;
      const std::size_t aggregate = (first_row + u) >> shift;
      level.masses[u >> step] += system.masses[u];
      for (offset_t s = system.ring.offsets[u]; s < system.ring.offsets[u + 1]; ++s) {
        const index_t v = system.ring.values[s];
        // Inside, a constant is bent only where the constraints of the ends differ; such an edge comes twice.
        const bool inside = system.holding.row_of_all(v) >> shift == aggregate && freedom(v) > 0;
        level.stiffness[u >> step] += system.weights[s] * (inside ? std::abs(freedom(u) - freedom(v)) / 2 : 1);
      }
    }
    if (shift == step) return level;
    for (std::vector<double>* values : {&level.stiffness, &level.masses}) {
      system.holding.gather(*values);
      std::vector<double> sums((values->size() + (std::size_t{1} << (shift - step)) - 1) >> (shift - step), 0.0);
      for (std::size_t i = 0; i < values->size(); ++i) sums[i >> (shift - step)] += (*values)[i];
      values->swap(sums);
    }
    return level;
  }

  std::vector<Level> levels_;
};

enum class SolveStatus { converged, iteration_limit, cancelled };

struct SolveOptions {
  double mass_factor = 0;  ///< solves (L + mass_factor M) x = mass_factor M source (or its like, see `load`)
  double tolerance = 1e-3;
  /// Square of the energy norm against which the error is small; 0: that of the error at the start.
  double energy = 0;
  int max_iterations = 2000;
};

/// Preconditioned conjugate gradients on a subspace given vertex by vertex.
///
/// Solves P ((L + f M) x - load) = 0 for x in x0 + range P, with P = diag(project). No matrix is stored. The
/// preconditioner adds the diagonal's corrections on the rows and on all levels of aggregates, so that its norm of the
/// residual, by which the solve ends, is that of the error within a small factor on any mesh. Sums are taken block by
/// block (see WholeMesh), so the result depends neither on the executor nor on who holds the rows.
///
/// @tparam Value    Eigen column vector of fixed size; float halves the memory traffic, and is enough for a tolerance
///                  of 1e-4.
/// Everything is numbered by the rows of the system.
/// @param load      `load(v)` -> Value.
/// @param project   `project(v, value)` orthogonal projection, in place (zero where the vertex is fixed).
/// @param proceed   asked now and then, and once by a solve that has nothing to do; false cancels.
/// @par Complexity  O(edges) an iteration; for f = 0 about n^(1/6) iterations: constants on aggregates bend sharply.
/// @par Source      Bramble, Pasciak, Xu, Math. Comp. 55 (1990), for the sum over levels; aggregates of a space-filling
///                  curve in place of nested meshes.
template <class Value, class Load, class Project, class Proceed, class E, class Holding>
class ConjugateGradients {
  using Scalar = typename Value::Scalar;

public:
  ConjugateGradients(const LaplaceSystem<Holding>& system, const RowAggregates& aggregates, const Project& project,
                     const Proceed& proceed, const E& executor)
      : system_(system), aggregates_(aggregates), project_(project), proceed_(proceed), executor_(executor) {}

  /// @param x  by row, the halo's too.
  SolveStatus solve(std::vector<Value>& x, const Load& load, const SolveOptions& options) {
    n_ = system_.n_own();
    factor_ = options.mass_factor;
    residual_.resize(n_);
    direction_.resize(x.size());
    image_.resize(n_);
    for (const auto& level : aggregates_.levels()) corrections_.emplace_back(level.masses.size());
    system_.holding.refresh_rows(x);
    sum_ = {};
    add(n_, row_block, [&](std::size_t v) {
      Value r = load(v) - row(x, v);
      project_(v, r);
      residual_[v] = r;
      return static_cast<double>(r.squaredNorm()) / diagonal(v);
    });
    double rho = correct_aggregates();
    turn(0);
    const double target = options.tolerance * options.tolerance * (options.energy > 0 ? options.energy : rho);
    for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
      if (iteration % 8 == 0 && !proceed_(iteration)) return SolveStatus::cancelled;
      if (!(rho > target)) return SolveStatus::converged;
      sum_ = {};
      add(n_, row_block, [&](std::size_t v) {
        Value q = row(direction_, v);
        project_(v, q);
        image_[v] = q;
        return static_cast<double>(q.dot(direction_[v]));
      });
      const double curvature = system_.holding.total(sum_);
      if (!(curvature > 0)) return SolveStatus::converged;
      const double alpha = rho / curvature;
      sum_ = {};
      add(n_, row_block, [&](std::size_t v) {
        x[v] += static_cast<Scalar>(alpha) * direction_[v];
        residual_[v] -= static_cast<Scalar>(alpha) * image_[v];
        return static_cast<double>(residual_[v].squaredNorm()) / diagonal(v);
      });
      const double next = correct_aggregates();
      turn(next / rho);
      rho = next;
    }
    return SolveStatus::iteration_limit;
  }

private:
  double diagonal(std::size_t v) const {
    const double d = system_.diagonal[v] + factor_ * system_.masses[v];
    return d > 0 ? d : 1;
  }

  Value row(const std::vector<Value>& x, std::size_t v) const {
    const Csr<index_t>& ring = system_.ring;
    Value sum = static_cast<Scalar>(system_.diagonal[v] + factor_ * system_.masses[v]) * x[v];
    for (offset_t s = ring.offsets[v]; s < ring.offsets[v + 1]; ++s) sum -= system_.weights[s] * x[ring.values[s]];
    return sum;
  }

  /// Sets the corrections to those of the residual, each with those of the larger aggregates around it.
  /// @return the product of residual and correction, with the rows' own that stands in `sum_`.
  double correct_aggregates() {
    constexpr std::size_t n_local = RowAggregates::n_local_levels;
    restrict_residual();
    double of_all = 0;
    for (std::size_t level = corrections_.size(); level-- > 0;) {
      const RowAggregates::Level& diagonal = aggregates_.levels()[level];
      std::vector<Value>& values = corrections_[level];
      // The parents of the last level that each holder has alone are known to all.
      const std::size_t first = level + 1 == n_local ? system_.holding.first_row() >> (3 * n_local) : 0;
      const auto correct = [&](std::size_t a) {
        const double d = diagonal.stiffness[a] + factor_ * diagonal.masses[a];
        const Value restricted = values[a];
        values[a] = d > 0 ? Value(restricted / static_cast<Scalar>(d)) : Value::Zero();
        const double term = static_cast<double>(restricted.dot(values[a]));
        if (level + 1 < corrections_.size()) values[a] += corrections_[level + 1][(first + a) >> 3];
        return term;
      };
      if (level < n_local)
        add(values.size(), row_block >> (3 * (level + 1)), correct);
      else
        of_all += sum_by_blocks(executor_, values.size(), row_block, partial_, correct);
    }
    return system_.holding.total(sum_) + of_all;
  }

  void restrict_residual() {
    const auto eight = [](const std::vector<Value>& fine, std::size_t aggregate) {
      Value total = Value::Zero();
      for (std::size_t i = 8 * aggregate, end = std::min(i + 8, fine.size()); i < end; ++i) total += fine[i];
      return total;
    };
    for (std::size_t level = 0; level < corrections_.size(); ++level) {
      const std::vector<Value>* fine = level == 0 ? &residual_ : &corrections_[level - 1];
      if (level == RowAggregates::n_local_levels && !Holding::is_whole) {
        gathered_ = *fine;
        system_.holding.gather(gathered_);
        fine = &gathered_;
      }
      std::vector<Value>& coarse = corrections_[level];
      for_blocks(executor_, coarse.size(), block_size, [&](std::size_t first, std::size_t last) {
        for (std::size_t a = first; a < last; ++a) coarse[a] = eight(*fine, a);
      });
    }
  }

  /// The next direction: the preconditioned residual and a share of the last.
  void turn(double share) {
    const auto beta = static_cast<Scalar>(share);
    for_blocks(executor_, n_, block_size, [&](std::size_t first, std::size_t last) {
      for (std::size_t v = first; v < last; ++v) {
        Value step = corrections_[0][v >> 3];
        project_(v, step);
        step += residual_[v] / static_cast<Scalar>(diagonal(v));
        direction_[v] = beta == 0 ? step : Value(step + beta * direction_[v]);
      }
    });
    system_.holding.refresh_rows(direction_);
  }

  /// Adds the terms of [0, n) to `sum_`, block by block.
  template <class Term>
  void add(std::size_t n, std::size_t block, const Term& term) {
    sum_by_blocks(executor_, n, block, partial_, term);
    for (const double p : partial_) sum_.add(p);
  }

  const LaplaceSystem<Holding>& system_;
  const RowAggregates& aggregates_;
  const Project& project_;
  const Proceed& proceed_;
  const E& executor_;
  std::size_t n_ = 0;
  double factor_ = 0;
  ExactSum sum_;
  std::vector<Value> residual_, direction_, image_;
  std::vector<std::vector<Value>> corrections_;  ///< per level of aggregates
  std::vector<Value> gathered_;                  ///< the last level that each holder has alone, everybody's
  std::vector<double> partial_;
};

/// See ConjugateGradients.
template <class Value, class Load, class Project, class Proceed, class E, class Holding>
SolveStatus solve_laplace(const LaplaceSystem<Holding>& system, const RowAggregates& aggregates, std::vector<Value>& x,
                          const Load& load, const Project& project, const Proceed& proceed, const SolveOptions& options,
                          const E& executor) {
  return ConjugateGradients<Value, Load, Project, Proceed, E, Holding>(system, aggregates, project, proceed, executor)
      .solve(x, load, options);
}

/// Sum of `term(row)` over all holders' rows.
template <class Holding, class E, class Term>
double sum_of_rows(const LaplaceSystem<Holding>& system, const E& executor, const Term& term) {
  std::vector<double> partial;
  sum_by_blocks(executor, system.n_own(), row_block, partial, term);
  ExactSum sum;
  for (const double p : partial) sum.add(p);
  return system.holding.total(sum);
}

/// Estimate of the first eigenvalue of the Laplacian that vanishes at the `pinned` vertices, own unit^-2: the Rayleigh
/// quotient of the solution of -laplace u = 1, within a few per cent on round domains.
///
/// @param proceed  as for `ConjugateGradients`.
/// @return nothing when cancelled.
template <class Holding, class Proceed, class E>
std::optional<double> first_eigenvalue(const LaplaceSystem<Holding>& system,
                                       std::span<const FrameConstraint> constraints, const Proceed& proceed,
                                       const E& executor) {
  using Value = Eigen::Matrix<double, 1, 1>;
  std::vector<Value> u(constraints.size(), Value::Zero());
  const double volume = sum_of_rows(system, executor, [&](std::size_t v) { return system.masses[v]; });
  if (!(volume > 0)) return 1;
  // The shift keeps parts without a pinned vertex finite.
  const double size = std::cbrt(volume), shift = 1e-3 / (size * size);
  const auto load = [&](std::size_t v) { return Value(system.masses[v]); };
  const auto project = [&](std::size_t v, Value& value) {
    if (constraints[system.order[v]] != FrameConstraint::none) value.setZero();
  };
  const RowAggregates aggregates(
      system, [&](std::size_t v) { return constraints[system.order[v]] == FrameConstraint::none ? 1. : 0.; });
  const SolveOptions solve{.mass_factor = shift, .tolerance = 1e-2, .max_iterations = 500};
  if (solve_laplace(system, aggregates, u, load, project, proceed, solve, executor) == SolveStatus::cancelled)
    return std::nullopt;
  const double reach = sum_of_rows(system, executor, [&](std::size_t v) { return system.masses[v] * u[v][0]; });
  const double moment =
      sum_of_rows(system, executor, [&](std::size_t v) { return system.masses[v] * u[v][0] * u[v][0]; });
  return moment > 0 ? reach / moment : 100 / (size * size);
}

}  // namespace framehex::detail
