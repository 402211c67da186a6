// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/option_ranges.hpp"
#include "framehex/surface/detail/edge_clusters.hpp"
#include "framehex/surface/feature_graph.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <functional>
#include <random>
#include <span>
#include <utility>

namespace framehex::detail {

/// Principal directions as crosses, one number an edge, of about unit size where bending is decided and 0 where not.
///
/// The curvature of the edges of two triangles, each bending about itself, adds up to a quadratic form; its deviatoric
/// part is a number with the double angle, whose square is the cross.
inline std::vector<Complex> curvature_crosses(const std::vector<Vector3>& points, const TriangleAdjacency& adjacency,
                                              const EdgeConnection& connection, const std::vector<Vector3>& normals) {
  const std::size_t n = connection.n_edges();
  std::vector<double> bend(n, 0);
  for (std::size_t e = 0; e < n; ++e) {
    const index_t h = connection.half_edge_of[e], g = adjacency.opposite[h];
    if (g == no_index) continue;
    const Vector3 edge = points[adjacency.to(h)] - points[adjacency.from(h)];
    bend[e] =
        std::atan2(normals[h / 3].cross(normals[g / 3]).dot(edge.normalized()), normals[h / 3].dot(normals[g / 3])) *
        edge.norm();
    if (!std::isfinite(bend[e])) bend[e] = 0;
  }
  std::vector<Complex> result(n);
  for (std::size_t e = 0; e < n; ++e) {
    const index_t h = connection.half_edge_of[e], g = adjacency.opposite[h];
    Complex sum = bend[e];
    double total = std::abs(bend[e]);
    for (const index_t side : {h, g}) {
      if (side == no_index) continue;
      for (index_t o = 3 * (side / 3); o < 3 * (side / 3) + 3; ++o) {
        if (o == side) continue;
        const double b = bend[connection.edge_of[o]];
        sum += b * std::polar(1.0, 2 * (connection.direction[o] - connection.direction[side]));
        total += std::abs(b);
      }
    }
    result[e] = total > 0 ? sum * sum / (total * total) : Complex(0);
  }
  return result;
}

/// Finds the smoothest numbers on edges; see compute_cross_field.
class CrossSolver {
public:
  struct ClosedOptions {
    double curvature;
    int max_iterations;
    double tolerance;
    int diffusion_steps;
  };

  /// @param proceed  `bool proceed(fraction)`, asked between the steps of the solution; false ends it.
  CrossSolver(const TriangleAdjacency& adjacency, const FeatureGraph& features, const EdgeConnection& connection,
              std::function<bool(double)> proceed)
      : adjacency_(adjacency),
        features_(features),
        connection_(connection),
        cross_(connection.n_edges(), Complex(1)),
        unknown_(connection.n_edges(), no_index),
        proceed_(std::move(proceed)) {
    constrained_patch_.assign(features.n_patches, 0);
    for (index_t h = 0; h < adjacency.opposite.size(); ++h)
      if (fixed(connection.edge_of[h])) constrained_patch_[features.triangle_patch[h / 3]] = 1;
  }

  /// Laplace's equation with the features' directions as boundary values.
  /// @return false when told to stop.
  bool solve_patches_with_features() {
    std::vector<index_t> triangles;
    for (index_t t = 0; t < adjacency_.triangles.size(); ++t)
      if (constrained_patch_[features_.triangle_patch[t]]) triangles.push_back(t);
    const Unknowns unknowns = number(triangles);
    if (unknowns.edges.empty()) return going();
    Vector right = Vector::Zero(static_cast<Eigen::Index>(unknowns.edges.size()));
    const Matrix stiffness = assemble(unknowns, 0, &right);
    Factor factor;
    factor.analyzePattern(stiffness);
    if (!going()) return false;
    factor.factorize(stiffness);
    if (!going()) return false;
    const Vector x = factor.solve(right);
    store(unknowns, x);
    return going();
  }

  /// The least eigenvector, or a compromise with given crosses.
  /// @return false when told to stop.
  bool solve_closed_patches(const std::vector<Complex>& guide, const ClosedOptions& options) {
    const Csr<index_t> triangles_of_patch = make_csr(constrained_patch_.size(), [&](auto&& put) {
      for (index_t t = 0; t < adjacency_.triangles.size(); ++t)
        if (!constrained_patch_[features_.triangle_patch[t]]) put(features_.triangle_patch[t], t);
    });
    for (std::size_t patch = 0; patch < constrained_patch_.size(); ++patch)
      if (!triangles_of_patch[patch].empty() && !solve_closed(triangles_of_patch[patch], guide, options)) return false;
    return true;
  }

  /// Angle of the cross in each triangle: that of the mean of its three numbers, which is the value at the centroid.
  std::vector<double> triangle_crosses() const {
    std::vector<double> angles(adjacency_.triangles.size(), 0);
    for (index_t t = 0; t < angles.size(); ++t) {
      Complex sum = 0;
      for (index_t h = 3 * t; h < 3 * t + 3; ++h) sum += cross_[connection_.edge_of[h]] * connection_.turn(h);
      if (std::abs(sum) > 0 && std::isfinite(std::abs(sum))) angles[t] = std::arg(sum) / 4;
    }
    return angles;
  }

private:
  static constexpr std::size_t most_factorised = 160'000, n_clusters = 20'000;
  static constexpr int guide_steps = 4;
  static constexpr double nearly_smoothest = 1.5;  ///< eigenvalues; those of clusters are inexact
  using Vector = Eigen::VectorXcd;
  using Matrix = Eigen::SparseMatrix<Complex>;
  using Factor = Eigen::SimplicialLDLT<Matrix>;

  struct Unknowns {
    std::span<const index_t> triangles;  ///< that take part
    std::vector<index_t> edges;          ///< unknown -> edge
  };

  bool fixed(index_t edge) const {
    const index_t h = connection_.half_edge_of[edge];
    return features_.is_feature[h] || adjacency_.opposite[h] == no_index;
  }

  /// Numbers the free edges of some triangles, until `store`.
  Unknowns number(std::span<const index_t> triangles) {
    Unknowns u{triangles, {}};
    for (const index_t t : triangles)
      for (index_t h = 3 * t; h < 3 * t + 3; ++h) {
        const index_t e = connection_.edge_of[h];
        if (unknown_[e] != no_index || fixed(e)) continue;
        unknown_[e] = static_cast<index_t>(u.edges.size());
        u.edges.push_back(e);
      }
    return u;
  }

  /// Stiffness plus `shift` times mass; the known values go to `right`.
  Matrix assemble(const Unknowns& u, double shift, Vector* right) const {
    std::vector<Eigen::Triplet<Complex>> entries;
    entries.reserve(9 * u.triangles.size());
    const auto add = [&](index_t e, index_t f, const Complex& value) {
      const index_t i = unknown_[e], j = unknown_[f];
      if (i == no_index) return;
      if (j != no_index)
        entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
      else if (right)
        (*right)[static_cast<Eigen::Index>(i)] -= value * cross_[f];
    };
    for (const index_t t : u.triangles)
      for (index_t i = 0; i < 3; ++i) {
        // Corner i lies between half edges i-1 and i: with its cotangent c, c |U_i - U_{i-1}|^2 is its share of the
        // energy.
        const index_t h = 3 * t + i, g = TriangleAdjacency::previous(h);
        const index_t e = connection_.edge_of[h], f = connection_.edge_of[g];
        const double weight = 2 * connection_.cotangent[t][i];
        const Complex turn = std::conj(connection_.turn(h)) * connection_.turn(g);
        add(e, e, weight + shift * connection_.area[t] / 3);
        add(f, f, weight);
        add(e, f, -weight * turn);
        add(f, e, -weight * std::conj(turn));
      }
    const auto n = static_cast<Eigen::Index>(u.edges.size());
    Matrix matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }

  Eigen::VectorXd mass(const Unknowns& u) const {
    Eigen::VectorXd m = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(u.edges.size()));
    for (const index_t t : u.triangles)
      for (index_t h = 3 * t; h < 3 * t + 3; ++h)
        m[static_cast<Eigen::Index>(unknown_[connection_.edge_of[h]])] += connection_.area[t] / 3;
    return m;
  }

  /// Patches of very many edges are solved on clusters of them, and only then spread on the edges: the factorisations
  /// grow faster than the patch.
  bool solve_closed(std::span<const index_t> triangles, const std::vector<Complex>& guide,
                    const ClosedOptions& options) {
    const Unknowns u = number(triangles);
    const auto n = static_cast<Eigen::Index>(u.edges.size());
    if (n == 0) return true;
    const Eigen::VectorXd m = mass(u);
    Vector x(n);
    for (Eigen::Index i = 0; i < n; ++i) x[i] = guide[u.edges[static_cast<std::size_t>(i)]];
    if (u.edges.size() <= most_factorised) {
      if (!solve_smoothest([&](double shift) { return assemble(u, shift, nullptr); }, m, options, 1, x)) return false;
    } else {
      if (!solve_on_clusters(u, m, options, x)) return false;
    }
    store(u, x);
    return going();
  }

  bool solve_on_clusters(const Unknowns& u, const Eigen::VectorXd& m, const ClosedOptions& options, Vector& x) const {
    const EdgeClusters clusters(adjacency_, connection_, u.edges, unknown_, assemble(u, 0, nullptr), n_clusters);
    if (!going()) return false;
    const Eigen::VectorXd coarse_mass = clusters.mass(m);
    Vector y = clusters.sums(m.array() * x.array()).array() / coarse_mass.array().max(least_positive);
    const auto matrix = [&](double shift) {
      Matrix sum = clusters.stiffness();
      sum.diagonal() += Vector(shift * coarse_mass.array());
      return sum;
    };
    if (!solve_smoothest(matrix, coarse_mass, options, nearly_smoothest, y)) return false;
    x = clusters.prolong(y);
    return spread(u, m, m.sum() / static_cast<double>(clusters.size()), x);
  }

  /// @param matrix_with  stiffness plus a multiple of the mass.
  /// @param nearly       least eigenvalues up to which numbers that agree with the guide are taken.
  /// @param x            the guide; replaced by the solution.
  template <class MatrixWith>
  bool solve_smoothest(const MatrixWith& matrix_with, const Eigen::VectorXd& m, const ClosedOptions& options,
                       double nearly, Vector& x) const {
    const Eigen::Index n = x.size();
    const double shift =
        1e-3 / m.sum();  // below the least eigenvalue of any surface with curvature, so convergence is quick
    Factor factor;
    {
      const Matrix matrix = matrix_with(shift);
      factor.analyzePattern(matrix);
      if (!going()) return false;
      factor.factorize(matrix);
    }
    Vector pull = x;
    std::mt19937_64 engine(1);
    const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-52 - 1; };
    for (Eigen::Index i = 0; i < n; ++i) {
      const double real = uniform(), imaginary = uniform();
      x[i] = pull[i] + 0.1 * Complex(real, imaginary);
    }
    const auto scale = [&](Vector& y) {
      const double size = std::sqrt((m.array() * y.array().abs2()).sum());
      if (size > 0) y *= std::sqrt(m.sum()) / size;
      return size / std::sqrt(m.sum());
    };
    scale(x);
    double eigenvalue = 0;
    for (int i = 0; i < options.max_iterations; ++i) {
      if (!going()) return false;
      x = factor.solve(Vector(m.array() * x.array()));
      const double last = std::exchange(eigenvalue, 1 / scale(x));
      if (std::abs(eigenvalue - last) <= options.tolerance * eigenvalue) break;
    }
    // Numbers that agree with the curvature and are next to as smooth are worth more: on a torus the smoothest are those
    // about its top and its bottom, which do not fit together.
    Vector own = pull;
    double of_own = 0;
    for (int i = 0; i < guide_steps && own.squaredNorm() > 0; ++i) {
      if (!going()) return false;
      own = factor.solve(Vector(m.array() * own.array()));
      of_own = 1 / scale(own);
    }
    if (of_own > 0 && of_own <= nearly * eigenvalue) x = own;
    if (options.curvature > 0) {
      pull = factor.solve(Vector(m.array() * pull.array()));
      scale(pull);
      // The eigenvector is free up to a complex factor: turn it to agree with the curvature.
      const Complex agreement = (x.conjugate().array() * m.array() * pull.array()).sum();
      if (std::abs(agreement) > 0) x *= agreement / std::abs(agreement);
      x += options.curvature * pull;
    }
    return diffuse(matrix_with, m, 1 / eigenvalue, options.diffusion_steps, factor, x);
  }

  static void normalize(Vector& x) {
    for (Complex& value : x)
      if (std::abs(value) > 0) value /= std::abs(value);
  }

  /// Spreads and brings back to unit size, over shorter and shorter times: where the eigenvector is small its direction
  /// is poor, and pairs of opposite singularities stand there that unit crosses do not want.
  template <class MatrixWith>
  bool diffuse(const MatrixWith& matrix_with, const Eigen::VectorXd& m, double time, int steps, Factor& factor,
               Vector& x) const {
    for (int round = 0; round < steps; ++round) {
      time /= 4;
      if (!going()) return false;
      factor.factorize(matrix_with(1 / time));
      for (int i = 0; i < 4; ++i) {
        if (!going()) return false;
        normalize(x);
        x = factor.solve(Vector(m.array() * x.array()));
      }
      normalize(x);
    }
    return true;
  }

  /// `diffuse` over an area so small that a few conjugate gradients are enough: what clusters cannot tell.
  bool spread(const Unknowns& u, const Eigen::VectorXd& m, double area, Vector& x) const {
    Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper> solver;
    solver.setMaxIterations(100);
    solver.setTolerance(1e-2);
    const Matrix matrix = assemble(u, 1 / area, nullptr);
    solver.compute(matrix);
    for (int i = 0; i < 4; ++i) {
      if (!going()) return false;
      normalize(x);
      x = solver.solveWithGuess(Vector(m.array() * x.array() / area), x);
    }
    normalize(x);
    return true;
  }

  bool going() const {
    return proceed_(static_cast<double>(n_solved_) / static_cast<double>(adjacency_.triangles.size()));
  }

  void store(const Unknowns& u, const Vector& x) {
    for (std::size_t i = 0; i < u.edges.size(); ++i) {
      cross_[u.edges[i]] = x[static_cast<Eigen::Index>(i)];
      unknown_[u.edges[i]] = no_index;
    }
    n_solved_ += u.triangles.size();
  }

  const TriangleAdjacency& adjacency_;
  const FeatureGraph& features_;
  const EdgeConnection& connection_;
  std::vector<Complex> cross_;    ///< edge
  std::vector<index_t> unknown_;  ///< edge -> unknown of the patches in work, or `no_index`
  std::vector<char> constrained_patch_;
  std::function<bool(double)> proceed_;
  std::size_t n_solved_ = 0;  ///< triangles
};

}  // namespace framehex::detail
