// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/input.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/thread_transport.hpp"

#include <boost/random/uniform_real_distribution.hpp>

#include <algorithm>
#include <random>

namespace framehex::test {

/// A Kuhn lattice whose inner vertices are moved by up to `jitter` of an edge.
inline IndexedTetMesh jittered_kuhn(index_t n, double jitter, std::uint64_t seed = 7) {
  IndexedTetMesh mesh = kuhn_lattice(n);
  std::mt19937_64 random(seed);
  boost::random::uniform_real_distribution<double> shift(-1, 1);
  for (Vector3& p : mesh.points) {
    const bool inside = p.minCoeff() > 0 && p.maxCoeff() < n;
    const Vector3 d = jitter * Vector3(shift(random), shift(random), shift(random));
    if (inside) p += d;
  }
  return mesh;
}

/// The same mesh with vertices and cells in another order, and corners turned.
inline IndexedTetMesh permuted(const IndexedTetMesh& mesh, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto shuffled = [&](std::size_t n) {
    std::vector<index_t> order(n);
    for (std::size_t i = 0; i < n; ++i) order[i] = static_cast<index_t>(i);
    for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    return order;
  };
  const auto vertex = shuffled(mesh.points.size()), cell = shuffled(mesh.tets.size());
  IndexedTetMesh result{std::vector<Vector3>(mesh.points.size()),
                        std::vector<std::array<index_t, 4>>(mesh.tets.size())};
  for (std::size_t v = 0; v < vertex.size(); ++v) result.points[vertex[v]] = mesh.points[v];
  for (std::size_t t = 0; t < cell.size(); ++t) {
    auto corners = mesh.tets[t];
    for (index_t& v : corners) v = vertex[v];
    std::rotate(corners.begin() + 1, corners.begin() + 1 + static_cast<std::ptrdiff_t>(random() % 3), corners.end());
    result.tets[cell[t]] = corners;
  }
  return result;
}

/// The mesh with its vertices by rising coordinates.
inline IndexedTetMesh in_order(const IndexedTetMesh& mesh) {
  std::vector<index_t> order(mesh.points.size()), place(order.size());
  for (index_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](index_t a, index_t b) { return detail::lies_before(mesh.points[a], mesh.points[b]); });
  IndexedTetMesh result;
  for (index_t i = 0; i < order.size(); ++i) {
    place[order[i]] = i;
    result.points.push_back(mesh.points[order[i]]);
  }
  for (auto tet : mesh.tets) {
    for (index_t& v : tet) v = place[v];
    result.tets.push_back(tet);
  }
  return result;
}

/// What a rank brings of a mesh.
struct BroughtPart {
  std::vector<Vector3> points;
  std::vector<std::array<index_t, 4>> tets;
  std::vector<global_t> vertex_numbers, cell_numbers;
  std::vector<index_t> regions;
  PartInput input() const { return {points, tets, vertex_numbers, cell_numbers, regions}; }
};

/// Cells dealt to ranks by `rank_of(cell)`.
template <class RankOf>
BroughtPart part_of(const IndexedTetMesh& mesh, int rank, RankOf&& rank_of) {
  BroughtPart part;
  std::vector<index_t> local(mesh.points.size(), no_index);
  for (std::size_t cell = 0; cell < mesh.tets.size(); ++cell) {
    if (rank_of(cell) != rank) continue;
    auto& corners = part.tets.emplace_back(mesh.tets[cell]);
    part.cell_numbers.push_back(static_cast<global_t>(cell));
    for (index_t& v : corners) {
      if (local[v] == no_index) {
        local[v] = static_cast<index_t>(part.points.size());
        part.points.push_back(mesh.points[v]);
        part.vertex_numbers.push_back(static_cast<global_t>(v));
      }
      v = local[v];
    }
  }
  return part;
}

}  // namespace framehex::test
