// SPDX-License-Identifier: BSL-1.0
#include "framehex/field/frame_measures.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

namespace {

/// A pyramid of two tetrahedra, and a third between the diagonals of its base, as high as `height` times the base is long.
IndexedTetMesh pyramid_with_lid(double height) {
  IndexedTetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, height}, {0.5, 0.5, -0.7}};
  mesh.tets = {{0, 2, 1, 4}, {0, 3, 2, 4}, {0, 1, 2, 3}};
  return mesh;
}

double weight(const IndexedTetMesh& mesh, index_t v, index_t w) {
  const TetAdjacency adjacency = make_adjacency(mesh);
  const auto row = adjacency.vertices_of_vertex[v];
  const auto at = std::ranges::find(row, w) - row.begin();
  return dirichlet_weights(adjacency, mesh.points)[adjacency.vertices_of_vertex.offsets[v] + static_cast<offset_t>(at)];
}

}  // namespace

TEST_CASE("a flat tetrahedron leaves the weights of the edges as they are without it") {
  IndexedTetMesh without = pyramid_with_lid(1e-9);
  without.tets.pop_back();
  for (const double height : {1e-9, 1e-11, 1e-13})
    for (const auto& [v, w] : {std::pair<index_t, index_t>{0, 1}, {1, 2}, {2, 3}, {0, 2}, {1, 4}}) {
      CAPTURE(height, v, w);
      CHECK(weight(pyramid_with_lid(height), v, w) == Approx(weight(without, v, w)).epsilon(0.03).margin(1e-6));
    }
}

TEST_CASE("however flat a tetrahedron is, its weights stay such that the others can be told apart beside them",
          "[regression]") {
  for (double height = 1; height > 1e-15; height /= 3) {
    CAPTURE(height);
    CHECK(weight(pyramid_with_lid(height), 0, 1) < 1000);
  }
}

TEST_CASE("the weights of a tetrahedron that is not flat are those of finite elements") {
  // Of a corner of a cube with unit edges: 1/6 along each edge at the right angles, none across but for the floor.
  IndexedTetMesh corner;
  corner.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  corner.tets = {{0, 1, 2, 3}};
  CHECK(weight(corner, 0, 1) == Approx(1.0 / 6));
  CHECK(weight(corner, 1, 2) < 1e-3);
  // As flat as a tetrahedron may be that counts in full, its own height rules: 1 / (6 z) along the height.
  corner.points[3].z() = 1e-3;
  CHECK(weight(corner, 0, 3) == Approx(1000.0 / 6));
}
