// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/detail/edge_connection.hpp"

#include <Eigen/SparseCholesky>

#include <span>
#include <utility>
#include <vector>

namespace framehex::detail {

/// Unknowns on edges gathered into connected sets that share one number: that of each edge is its set's, turned along a
/// path of triangles.
class EdgeClusters {
public:
  using Vector = Eigen::VectorXcd;
  using Matrix = Eigen::SparseMatrix<Complex>;

  /// @param edges    of the unknowns. @param unknown  edge -> unknown, or `no_index`.
  /// @param n_wanted clusters, about.
  /// @par Complexity   O(n).
  EdgeClusters(const TriangleAdjacency& adjacency, const EdgeConnection& connection, std::span<const index_t> edges,
               std::span<const index_t> unknown, std::size_t n_wanted)
      : adjacency_(adjacency), connection_(connection), edges_(edges), unknown_(unknown) {
    cluster_.assign(edges.size(), no_index);
    phase_.assign(edges.size(), Complex(1));
    const std::size_t size = (edges.size() + n_wanted - 1) / n_wanted;
    for (index_t seed = 0; seed < edges.size(); ++seed)
      if (cluster_[seed] == no_index) grow(seed, size);
  }

  Eigen::Index size() const { return static_cast<Eigen::Index>(n_); }

  /// What the energy of a matrix is for vectors that are constant in clusters.
  Matrix restrict(const Matrix& matrix) const {
    std::vector<Eigen::Triplet<Complex>> entries;
    entries.reserve(static_cast<std::size_t>(matrix.nonZeros()));
    for (int column = 0; column < matrix.outerSize(); ++column)
      for (Matrix::InnerIterator at(matrix, column); at; ++at) {
        const auto i = static_cast<std::size_t>(at.row()), j = static_cast<std::size_t>(at.col());
        entries.emplace_back(static_cast<int>(cluster_[i]), static_cast<int>(cluster_[j]),
                             std::conj(phase_[i]) * at.value() * phase_[j]);
      }
    Matrix result(size(), size());
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
  }

  Eigen::VectorXd restrict_mass(const Eigen::VectorXd& mass) const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(size());
    for (std::size_t i = 0; i < cluster_.size(); ++i) result[cluster_[i]] += mass[static_cast<Eigen::Index>(i)];
    return result;
  }

  Vector sums(const Vector& x) const {
    Vector result = Vector::Zero(size());
    for (std::size_t i = 0; i < cluster_.size(); ++i)
      result[cluster_[i]] += std::conj(phase_[i]) * x[static_cast<Eigen::Index>(i)];
    return result;
  }

  Vector prolong(const Vector& x) const {
    Vector result(static_cast<Eigen::Index>(cluster_.size()));
    for (std::size_t i = 0; i < cluster_.size(); ++i) result[static_cast<Eigen::Index>(i)] = phase_[i] * x[cluster_[i]];
    return result;
  }

private:
  /// Calls visit(neighbour, what turns this unknown's number into the neighbour's).
  template <class Visit>
  void each_neighbour(index_t i, Visit&& visit) const {
    const index_t h = connection_.half_edge_of[edges_[i]];
    for (const index_t side : {h, adjacency_.opposite[h]}) {
      if (side == no_index) continue;
      for (index_t o = 3 * (side / 3); o < 3 * (side / 3) + 3; ++o)
        if (const index_t j = unknown_[connection_.edge_of[o]]; o != side && j != no_index)
          visit(j, connection_.turn(side) * std::conj(connection_.turn(o)));
    }
  }

  /// A new cluster; where it has no room, its edges go to a neighbouring one.
  void grow(index_t seed, std::size_t size) {
    members_.assign(1, seed);
    cluster_[seed] = n_;
    phase_[seed] = 1;
    for (std::size_t k = 0; k < members_.size() && members_.size() < size; ++k)
      each_neighbour(members_[k], [&](index_t j, const Complex& turn) {
        if (cluster_[j] != no_index || members_.size() == size) return;
        cluster_[j] = n_;
        phase_[j] = turn * phase_[members_[k]];
        members_.push_back(j);
      });
    if (4 * members_.size() < size && join_neighbour()) return;
    ++n_;
  }

  bool join_neighbour() {
    for (const index_t i : members_) {
      index_t into = no_index;
      Complex turn = 1;
      each_neighbour(i, [&](index_t j, const Complex& from_i) {
        if (into != no_index || cluster_[j] == n_) return;
        into = cluster_[j];
        turn = phase_[j] * std::conj(from_i * phase_[i]);
      });
      if (into == no_index) continue;
      for (const index_t member : members_) {
        cluster_[member] = into;
        phase_[member] *= turn;
      }
      return true;
    }
    return false;
  }

  const TriangleAdjacency& adjacency_;
  const EdgeConnection& connection_;
  std::span<const index_t> edges_, unknown_;
  std::vector<index_t> cluster_;  ///< of each unknown
  std::vector<Complex> phase_;    ///< unknown -> what turns its cluster's number into its own
  std::vector<index_t> members_;
  index_t n_ = 0;
};

/// Solves a matrix over edges by conjugate gradients, whose steps are corrected by what clusters tell.
class ClusteredSolver {
public:
  using Vector = EdgeClusters::Vector;
  using Matrix = EdgeClusters::Matrix;

  /// @param matrix  Hermitian, positive.
  ClusteredSolver(Matrix matrix, const EdgeClusters& clusters)
      : matrix_(std::move(matrix)),
        clusters_(clusters),
        inverse_diagonal_(matrix_.diagonal().array().inverse()),
        coarse_(clusters.restrict(matrix_)) {}

  /// @param x  a guess; replaced by the solution. @param proceed  asked before each step; false ends it.
  /// @return false when told to stop.
  template <class Proceed>
  bool solve(const Vector& right, double tolerance, Vector& x, Proceed&& proceed) const {
    constexpr int most_steps = 200;
    Vector residual = right - matrix_ * x, step = precondition(residual);
    double product = residual.dot(step).real();
    const double enough = tolerance * right.norm();
    for (int i = 0; i < most_steps && residual.norm() > enough; ++i) {
      if (!proceed()) return false;
      const Vector image = matrix_ * step;
      const double length = product / step.dot(image).real();
      x += length * step;
      residual -= length * image;
      const Vector next = precondition(residual);
      const double next_product = residual.dot(next).real();
      step = next + (next_product / product) * step;
      product = next_product;
    }
    return true;
  }

private:
  Vector precondition(const Vector& residual) const {
    return Vector(inverse_diagonal_.array() * residual.array()) +
           clusters_.prolong(coarse_.solve(clusters_.sums(residual)));
  }

  Matrix matrix_;
  const EdgeClusters& clusters_;
  Vector inverse_diagonal_;
  Eigen::SimplicialLDLT<Matrix> coarse_;
};

}  // namespace framehex::detail
