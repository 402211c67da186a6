// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/frame_measures.hpp"
#include "framehex/observer.hpp"

#include <limits>
#include <utility>

namespace framehex::detail {

/// Vertices along a space-filling curve (Morton's), so that neighbours in the mesh are near in memory.
inline std::vector<index_t> spatial_order(std::span<const Vector3> points) {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vector3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double extent = points.empty() ? 0 : (high - low).maxCoeff(), scale = extent > 0 ? 2097151 / extent : 0;
  std::vector<std::pair<std::uint64_t, index_t>> keys(points.size());
  for (std::size_t v = 0; v < points.size(); ++v) {
    std::uint64_t key = 0;
    for (int i = 0; i < 3; ++i) {
      auto x = static_cast<std::uint64_t>((points[v][i] - low[i]) * scale);  // 21 bits, spread to every third
      x = (x | x << 32) & 0x1f00000000ffff;
      x = (x | x << 16) & 0x1f0000ff0000ff;
      x = (x | x << 8) & 0x100f00f00f00f00f;
      x = (x | x << 4) & 0x10c30c30c30c30c3;
      x = (x | x << 2) & 0x1249249249249249;
      key |= x << i;
    }
    keys[v] = {key, static_cast<index_t>(v)};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<index_t> order(points.size());
  for (std::size_t i = 0; i < keys.size(); ++i) order[i] = keys[i].second;
  return order;
}

/// The points in a unit that brings their extent near 1: a power of two, which changes no digit.
inline std::vector<Vector3> in_own_unit(std::span<const Vector3> points) {
  double largest = 0;
  for (const Vector3& p : points) largest = std::max(largest, (p - points[0]).cwiseAbs().maxCoeff());
  const double unit = largest > 0 ? std::ldexp(1.0, -std::ilogb(largest)) : 1;
  std::vector<Vector3> scaled;
  scaled.reserve(points.size());
  for (const Vector3& p : points) scaled.push_back(unit * p);
  return scaled;
}

/// The Laplacian of a mesh as a weighted graph, and the volume of each vertex; both along a space-filling curve, by
/// "rows". Lengths are in the mesh's own unit, or powers of them would leave single precision.
struct LaplaceSystem {
  std::vector<index_t> order;    ///< row -> vertex
  Csr<index_t> ring;             ///< neighbours of each row, as rows
  std::vector<float> weights;    ///< per directed edge, own unit; see dirichlet_weights
  std::vector<double> diagonal;  ///< sums of the rows
  std::vector<double> masses;    ///< per row, cubes of the own unit

  LaplaceSystem(const TetAdjacency& adjacency, std::span<const Vector3> host_points)
      : order(spatial_order(host_points)) {
    const std::vector<Vector3> points = in_own_unit(host_points);
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
    for (const index_t v : order) {
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
};

/// Eight rows in a row of the space-filling curve make an aggregate, eight of these a larger one, and so on: the spaces
/// of functions constant on them, in which conjugate gradients see the long waves.
///
/// An aggregate of level l holds the rows of equal row >> 3 (l + 1).
class RowAggregates {
public:
  struct Level {
    std::vector<double> stiffness, masses;  ///< Galerkin diagonal of the Laplacian, volume; per aggregate
  };

  /// @param freedom  `freedom(row)`: the share of a value's components that the constraint leaves free, in [0, 1].
  /// @par Complexity O(edges log n).
  template <class Freedom>
  RowAggregates(const LaplaceSystem& system, const Freedom& freedom) {
    const std::size_t n = system.masses.size();
    for (unsigned shift = 3; levels_.empty() || levels_.back().masses.size() > 8; shift += 3) {
      const std::size_t size = (n + (std::size_t{1} << shift) - 1) >> shift;
      Level level{std::vector<double>(size, 0.0), std::vector<double>(size, 0.0)};
      for (std::size_t u = 0; u < n; ++u) {
        if (freedom(u) == 0) continue;
        const std::size_t aggregate = u >> shift;
        level.masses[aggregate] += system.masses[u];
        for (offset_t s = system.ring.offsets[u]; s < system.ring.offsets[u + 1]; ++s) {
          const index_t v = system.ring.values[s];
          // Inside, a constant is bent only where the constraints of the ends differ; such an edge comes twice.
          const bool inside = v >> shift == aggregate && freedom(v) > 0;
          level.stiffness[aggregate] += system.weights[s] * (inside ? std::abs(freedom(u) - freedom(v)) / 2 : 1);
        }
      }
      levels_.push_back(std::move(level));
    }
  }

  std::span<const Level> levels() const { return levels_; }

private:
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
/// block in a fixed order, so the result does not depend on the executor.
///
/// @tparam Value    Eigen column vector of fixed size; float halves the memory traffic, and is enough for a tolerance
///                  of 1e-4.
/// Everything is numbered by the rows of the system.
/// @param load      `load(v)` -> Value.
/// @param project   `project(v, value)` orthogonal projection, in place (zero where the vertex is fixed).
/// @param proceed   asked now and then; false cancels.
/// @par Complexity  O(edges) an iteration; for f = 0 about n^(1/6) iterations: constants on aggregates bend sharply.
/// @par Source      Bramble, Pasciak, Xu, Math. Comp. 55 (1990), for the sum over levels; aggregates of a space-filling
///                  curve in place of nested meshes.
template <class Value, class Load, class Project, class Proceed, class E>
class ConjugateGradients {
  using Scalar = typename Value::Scalar;

public:
  ConjugateGradients(const LaplaceSystem& system, const RowAggregates& aggregates, const Project& project,
                     const Proceed& proceed, const E& executor)
      : system_(system), aggregates_(aggregates), project_(project), proceed_(proceed), executor_(executor) {}

  SolveStatus solve(std::vector<Value>& x, const Load& load, const SolveOptions& options) {
    n_ = x.size();
    factor_ = options.mass_factor;
    residual_.resize(n_);
    direction_.resize(n_);
    image_.resize(n_);
    for (const auto& level : aggregates_.levels()) corrections_.emplace_back(level.masses.size());
    double rho = sum(n_, [&](std::size_t v) {
      Value r = load(v) - row(x, v);
      project_(v, r);
      residual_[v] = r;
      return static_cast<double>(r.squaredNorm()) / diagonal(v);
    });
    rho += correct_aggregates();
    turn(0);
    const double target = options.tolerance * options.tolerance * (options.energy > 0 ? options.energy : rho);
    for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
      if (!(rho > target)) return SolveStatus::converged;
      if (iteration % 8 == 0 && !proceed_(iteration)) return SolveStatus::cancelled;
      const double curvature = sum(n_, [&](std::size_t v) {
        Value q = row(direction_, v);
        project_(v, q);
        image_[v] = q;
        return static_cast<double>(q.dot(direction_[v]));
      });
      if (!(curvature > 0)) return SolveStatus::converged;
      const double alpha = rho / curvature;
      double next = sum(n_, [&](std::size_t v) {
        x[v] += static_cast<Scalar>(alpha) * direction_[v];
        residual_[v] -= static_cast<Scalar>(alpha) * image_[v];
        return static_cast<double>(residual_[v].squaredNorm()) / diagonal(v);
      });
      next += correct_aggregates();
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
  /// @return the product of residual and correction.
  double correct_aggregates() {
    const auto eight = [](const std::vector<Value>& fine, std::size_t aggregate) {
      Value total = Value::Zero();
      for (std::size_t i = 8 * aggregate, end = std::min(i + 8, fine.size()); i < end; ++i) total += fine[i];
      return total;
    };
    for (std::size_t level = 0; level < corrections_.size(); ++level) {
      const std::vector<Value>& fine = level == 0 ? residual_ : corrections_[level - 1];
      std::vector<Value>& coarse = corrections_[level];
      for_blocks(executor_, coarse.size(), block_size, [&](std::size_t first, std::size_t last) {
        for (std::size_t a = first; a < last; ++a) coarse[a] = eight(fine, a);
      });
    }
    double product = 0;
    for (std::size_t level = corrections_.size(); level-- > 0;) {
      const RowAggregates::Level& diagonal = aggregates_.levels()[level];
      std::vector<Value>& values = corrections_[level];
      product += sum(values.size(), [&](std::size_t a) {
        const double d = diagonal.stiffness[a] + factor_ * diagonal.masses[a];
        const Value restricted = values[a];
        values[a] = d > 0 ? Value(restricted / static_cast<Scalar>(d)) : Value::Zero();
        const double term = static_cast<double>(restricted.dot(values[a]));
        if (level + 1 < corrections_.size()) values[a] += corrections_[level + 1][a >> 3];
        return term;
      });
    }
    return product;
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
  }

  template <class Term>
  double sum(std::size_t n, const Term& term) {
    return sum_by_blocks(executor_, n, block_size, partial_, term);
  }

  const LaplaceSystem& system_;
  const RowAggregates& aggregates_;
  const Project& project_;
  const Proceed& proceed_;
  const E& executor_;
  std::size_t n_ = 0;
  double factor_ = 0;
  std::vector<Value> residual_, direction_, image_;
  std::vector<std::vector<Value>> corrections_;  ///< per level of aggregates
  std::vector<double> partial_;
};

/// See ConjugateGradients.
template <class Value, class Load, class Project, class Proceed, class E>
SolveStatus solve_laplace(const LaplaceSystem& system, const RowAggregates& aggregates, std::vector<Value>& x,
                          const Load& load, const Project& project, const Proceed& proceed, const SolveOptions& options,
                          const E& executor) {
  return ConjugateGradients<Value, Load, Project, Proceed, E>(system, aggregates, project, proceed, executor)
      .solve(x, load, options);
}

/// Estimate of the first eigenvalue of the Laplacian that vanishes at the `pinned` vertices, own unit^-2: the Rayleigh
/// quotient of the solution of -laplace u = 1, within a few per cent on round domains.
template <class E>
double first_eigenvalue(const LaplaceSystem& system, std::span<const FrameConstraint> constraints, const E& executor) {
  using Value = Eigen::Matrix<double, 1, 1>;
  std::vector<Value> u(constraints.size(), Value::Zero());
  double volume = 0, reach = 0;
  for (const double mass : system.masses) volume += mass;
  if (!(volume > 0)) return 1;
  // The shift keeps parts without a pinned vertex finite.
  const double size = std::cbrt(volume), shift = 1e-3 / (size * size);
  const auto load = [&](std::size_t v) { return Value(system.masses[v]); };
  const auto project = [&](std::size_t v, Value& value) {
    if (constraints[system.order[v]] != FrameConstraint::none) value.setZero();
  };
  const RowAggregates aggregates(
      system, [&](std::size_t v) { return constraints[system.order[v]] == FrameConstraint::none ? 1. : 0.; });
  solve_laplace(
      system, aggregates, u, load, project, [](int) { return true; },
      {.mass_factor = shift, .tolerance = 1e-2, .max_iterations = 500}, executor);
  double moment = 0;
  for (std::size_t v = 0; v < u.size(); ++v) {
    reach += system.masses[v] * u[v][0];
    moment += system.masses[v] * u[v][0] * u[v][0];
  }
  return moment > 0 ? reach / moment : 100 / (size * size);
}

}  // namespace framehex::detail
