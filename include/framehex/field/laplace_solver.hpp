// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/frame_measures.hpp"
#include "framehex/observer.hpp"

namespace framehex::detail {

/// The Laplacian of a mesh as a weighted graph, and the volume of each vertex.
struct LaplaceSystem {
  const Csr<index_t>* ring = nullptr;
  std::vector<double> weights;   ///< per directed edge, length; see dirichlet_weights
  std::vector<double> diagonal;  ///< sums of the rows
  std::vector<double> masses;    ///< per vertex, volume

  LaplaceSystem(const TetAdjacency& adjacency, std::span<const Vector3> points)
      : ring(&adjacency.vertices_of_vertex), weights(dirichlet_weights(adjacency, points)) {
    diagonal.assign(ring->size(), 0.0);
    masses.assign(ring->size(), 0.0);
    for (std::size_t v = 0; v < ring->size(); ++v)
      for (offset_t s = ring->offsets[v]; s < ring->offsets[v + 1]; ++s) diagonal[v] += weights[s];
    for (const auto& t : adjacency.tets) {
      const Vector3& a = points[t[0]];
      const double quarter = std::abs((points[t[1]] - a).cross(points[t[2]] - a).dot(points[t[3]] - a)) / 24;
      for (const index_t v : t) masses[v] += quarter;
    }
  }
};

enum class SolveStatus { converged, iteration_limit, cancelled };

struct SolveOptions {
  double mass_factor = 0;  ///< solves (L + mass_factor M) x = mass_factor M source (or its like, see `load`)
  double tolerance = 1e-4;
  int max_iterations = 2000;
};

/// Preconditioned conjugate gradients on a subspace given vertex by vertex.
///
/// Solves P ((L + f M) x - load) = 0 for x in x0 + range P, with P = diag(project). No matrix is stored. Sums are taken
/// block by block in a fixed order, so the result does not depend on the executor.
///
/// @tparam Value    Eigen column vector of fixed size.
/// @param load      `load(v)` -> Value.
/// @param project   `project(v, value)` orthogonal projection, in place (zero where the vertex is fixed).
/// @param proceed   asked now and then; false cancels.
/// @par Complexity  O(edges) an iteration; O(n^(1/3)) iterations for f = 0.
template <class Value, class Load, class Project, class Proceed, class E>
class ConjugateGradients {
public:
  ConjugateGradients(const LaplaceSystem& system, const Project& project, const Proceed& proceed, const E& executor)
      : system_(system), project_(project), proceed_(proceed), executor_(executor) {}

  SolveStatus solve(std::vector<Value>& x, const Load& load, const SolveOptions& options) {
    n_ = x.size();
    factor_ = options.mass_factor;
    residual_.resize(n_);
    direction_.resize(n_);
    image_.resize(n_);
    // The scale against which the residual is small: that of the load and of what the fixed values pull.
    double scale = 0;
    double rho = sum([&](std::size_t v) {
      Value r = load(v) - row(x, v);
      project_(v, r);
      residual_[v] = r;
      direction_[v] = r / preconditioner(v);
      return r.dot(direction_[v]);
    });
    scale = sum([&](std::size_t v) { return x[v].squaredNorm() * preconditioner(v); });
    const double target = options.tolerance * options.tolerance * scale;
    for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
      if (!(rho > target)) return SolveStatus::converged;
      if (iteration % 8 == 0 && !proceed_(iteration)) return SolveStatus::cancelled;
      const double curvature = sum([&](std::size_t v) {
        Value q = row(direction_, v);
        project_(v, q);
        image_[v] = q;
        return q.dot(direction_[v]);
      });
      if (!(curvature > 0)) return SolveStatus::converged;
      const double alpha = rho / curvature;
      const double next = sum([&](std::size_t v) {
        x[v] += alpha * direction_[v];
        residual_[v] -= alpha * image_[v];
        return residual_[v].squaredNorm() / preconditioner(v);
      });
      const double beta = next / rho;
      rho = next;
      for_blocks(executor_, n_, block_size, [&](std::size_t first, std::size_t last) {
        for (std::size_t v = first; v < last; ++v)
          direction_[v] = residual_[v] / preconditioner(v) + beta * direction_[v];
      });
    }
    return SolveStatus::iteration_limit;
  }

private:
  double preconditioner(std::size_t v) const {
    const double d = system_.diagonal[v] + factor_ * system_.masses[v];
    return d > 0 ? d : 1;
  }

  Value row(const std::vector<Value>& x, std::size_t v) const {
    const Csr<index_t>& ring = *system_.ring;
    Value sum = (system_.diagonal[v] + factor_ * system_.masses[v]) * x[v];
    for (offset_t s = ring.offsets[v]; s < ring.offsets[v + 1]; ++s) sum -= system_.weights[s] * x[ring.values[s]];
    return sum;
  }

  template <class Term>
  double sum(const Term& term) {
    partial_.assign((n_ + block_size - 1) / block_size, 0.0);
    for_blocks(executor_, n_, block_size, [&](std::size_t first, std::size_t last) {
      double total = 0;
      for (std::size_t v = first; v < last; ++v) total += term(v);
      partial_[first / block_size] = total;
    });
    double total = 0;
    for (const double p : partial_) total += p;
    return total;
  }

  const LaplaceSystem& system_;
  const Project& project_;
  const Proceed& proceed_;
  const E& executor_;
  std::size_t n_ = 0;
  double factor_ = 0;
  std::vector<Value> residual_, direction_, image_;
  std::vector<double> partial_;
};

/// See ConjugateGradients.
template <class Value, class Load, class Project, class Proceed, class E>
SolveStatus solve_laplace(const LaplaceSystem& system, std::vector<Value>& x, const Load& load, const Project& project,
                          const Proceed& proceed, const SolveOptions& options, const E& executor) {
  return ConjugateGradients<Value, Load, Project, Proceed, E>(system, project, proceed, executor)
      .solve(x, load, options);
}

/// Estimate of the first eigenvalue of the Laplacian that vanishes at the `pinned` vertices, 1 / length^2: the Rayleigh
/// quotient of the solution of -laplace u = 1, within a few per cent on round domains.
template <class E>
double first_eigenvalue(const LaplaceSystem& system, std::span<const FrameConstraint> constraints, const E& executor) {
  using Value = Eigen::Matrix<double, 1, 1>;
  std::vector<Value> u(constraints.size(), Value::Zero());
  double volume = 0, reach = 0;
  for (std::size_t v = 0; v < u.size(); ++v) {
    volume += system.masses[v];
    if (constraints[v] == FrameConstraint::none) u[v][0] = 1;
  }
  if (!(volume > 0)) return 1;
  // The shift keeps parts without a pinned vertex finite.
  const double size = std::cbrt(volume), shift = 1e-3 / (size * size);
  const auto load = [&](std::size_t v) { return Value(system.masses[v]); };
  const auto project = [&](std::size_t v, Value& value) {
    if (constraints[v] != FrameConstraint::none) value.setZero();
  };
  for (Value& value : u) value *= size * size / 10;
  solve_laplace(
      system, u, load, project, [](int) { return true; },
      {.mass_factor = shift, .tolerance = 1e-3, .max_iterations = 500}, executor);
  double moment = 0;
  for (std::size_t v = 0; v < u.size(); ++v) {
    reach += system.masses[v] * u[v][0];
    moment += system.masses[v] * u[v][0] * u[v][0];
  }
  return moment > 0 ? reach / moment : 100 / (size * size);
}

}  // namespace framehex::detail
