// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/concepts.hpp"

namespace framehex {

/// Reference model of TetMesh: points and four vertex indices a tetrahedron, positively oriented.
struct IndexedTetMesh {
  std::vector<Vector3> points;
  std::vector<std::array<index_t, 4>> tets;
};

/// Reference model of TriangleMesh: points and three vertex indices a triangle, anticlockwise seen from outside.
struct IndexedTriangleMesh {
  std::vector<Vector3> points;
  std::vector<std::array<index_t, 3>> triangles;
};

namespace detail {

template <class M>
struct indexed_traits {
  using vertex_type = index_t;
  using cell_type = index_t;
  using scalar_type = double;

  static auto vertices(const M& mesh) { return std::views::iota(index_t{0}, static_cast<index_t>(mesh.points.size())); }
  static std::size_t index(const M&, index_t vertex) { return vertex; }
  static std::array<double, 3> point(const M& mesh, index_t vertex) {
    const Vector3& p = mesh.points[vertex];
    return {p.x(), p.y(), p.z()};
  }
};

}  // namespace detail

template <>
struct mesh_traits<IndexedTetMesh> : detail::indexed_traits<IndexedTetMesh> {
  static auto cells(const IndexedTetMesh& mesh) {
    return std::views::iota(index_t{0}, static_cast<index_t>(mesh.tets.size()));
  }
  static std::array<index_t, 4> cell_vertices(const IndexedTetMesh& mesh, index_t cell) { return mesh.tets[cell]; }
};

template <>
struct mesh_traits<IndexedTriangleMesh> : detail::indexed_traits<IndexedTriangleMesh> {
  static auto cells(const IndexedTriangleMesh& mesh) {
    return std::views::iota(index_t{0}, static_cast<index_t>(mesh.triangles.size()));
  }
  static std::array<index_t, 3> cell_vertices(const IndexedTriangleMesh& mesh, index_t cell) {
    return mesh.triangles[cell];
  }
};

static_assert(TetMesh<IndexedTetMesh>);
static_assert(TriangleMesh<IndexedTriangleMesh>);

}  // namespace framehex
