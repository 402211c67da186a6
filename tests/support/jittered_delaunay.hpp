// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/adjacency.hpp"
#include "support/delaunay_lattice.hpp"

#include <boost/random/uniform_real_distribution.hpp>

namespace framehex::test {

/// A lattice of n x n x n cubes with its face slivers, each point then moved by up to `jitter` in each direction (in the
/// sides only on the boundary), or as far as its tetrahedra stay positive.
inline IndexedTetMesh jittered_delaunay(index_t n, unsigned seed, double jitter) {
  IndexedTetMesh mesh = DelaunayLattice(n, seed, 0.6).mesh;
  const TetAdjacency adjacency = make_adjacency(mesh);
  std::mt19937_64 engine(seed);
  boost::random::uniform_real_distribution<> uniform(-1, 1);
  const auto is_positive = [&](index_t tet) {
    const auto& t = mesh.tets[tet];
    const auto& p = mesh.points;
    return orientation_determinant(p[t[0]], p[t[1]], p[t[2]], p[t[3]]) > 1e-6;
  };
  for (index_t v = 0; v < mesh.points.size(); ++v) {
    const Vector3 start = mesh.points[v];
    Vector3 shift;
    for (int axis = 0; axis < 3; ++axis) {
      shift[axis] = jitter * uniform(engine);
      if (start[axis] < 0.5 || start[axis] > n - 0.5) shift[axis] = 0;
    }
    bool moved = false;
    for (double share = 1; share > 0.05 && !moved; share *= 0.7) {
      mesh.points[v] = start + share * shift;
      moved = std::ranges::all_of(adjacency.tets_of_vertex[v], is_positive);
    }
    if (!moved) mesh.points[v] = start;
  }
  return mesh;
}

}  // namespace framehex::test
