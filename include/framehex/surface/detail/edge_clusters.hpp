// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/detail/edge_connection.hpp"

#include <Eigen/SparseCore>

#include <span>
#include <utility>
#include <vector>

namespace framehex::detail {

/// Numbers on the edges of a surface by fewer numbers, those of connected sets of edges: within a set the number is the
/// same everywhere, but turned along a path of triangles, and from one to the next it changes gradually.
///
/// @par Source   Vanek, Mandel, Brezina, Computing 56 (1996) 179-196: smoothed aggregation.
class EdgeClusters {
public:
  using Vector = Eigen::VectorXcd;
  using Matrix = Eigen::SparseMatrix<Complex>;

  /// @param edges      of the unknowns. @param unknown  edge -> unknown, or `no_index`.
  /// @param stiffness  of the unknowns; must outlive this.
  /// @param n_wanted   clusters, about.
  /// @par Complexity   O(n).
  EdgeClusters(const TriangleAdjacency& adjacency, const EdgeConnection& connection, std::span<const index_t> edges,
               std::span<const index_t> unknown, const Matrix& stiffness, std::size_t n_wanted)
      : adjacency_(adjacency), connection_(connection), edges_(edges), unknown_(unknown) {
    cluster_.assign(edges.size(), no_index);
    phase_.assign(edges.size(), Complex(1));
    const std::size_t size = (edges.size() + n_wanted - 1) / n_wanted;
    for (index_t seed = 0; seed < edges.size(); ++seed)
      if (cluster_[seed] == no_index) grow(seed, size);
    make_prolongation(stiffness);
    stiffness_ = prolongation_.adjoint() * Matrix(stiffness * prolongation_);
  }

  std::size_t size() const { return n_; }

  /// Energy of numbers of clusters.
  const Matrix& stiffness() const { return stiffness_; }

  /// @param mass  of the edges. @return that of clusters, which adds up to about the same.
  Eigen::VectorXd mass(const Eigen::VectorXd& mass) const { return prolongation_.cwiseAbs().transpose() * mass; }

  Vector sums(const Vector& x) const { return prolongation_.adjoint() * x; }
  Vector prolong(const Vector& x) const { return prolongation_ * x; }

private:
  static constexpr double damping = 2.0 / 3;  ///< for eigenvalues up to about two

  /// One step of Jacobi's iteration makes what is constant in clusters gradual.
  void make_prolongation(const Matrix& stiffness) {
    std::vector<Eigen::Triplet<Complex>> entries;
    entries.reserve(cluster_.size());
    for (std::size_t i = 0; i < cluster_.size(); ++i)
      entries.emplace_back(static_cast<int>(i), static_cast<int>(cluster_[i]), phase_[i]);
    Matrix constant(stiffness.rows(), static_cast<Eigen::Index>(n_));
    constant.setFromTriplets(entries.begin(), entries.end());
    const Vector steps = damping * stiffness.diagonal().array().inverse();
    prolongation_ = constant - Matrix(steps.asDiagonal() * Matrix(stiffness * constant));
  }

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
  Matrix prolongation_, stiffness_;
};

}  // namespace framehex::detail
