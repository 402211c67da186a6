// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/concepts.hpp"

#include <span>

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

/// Tetrahedra that lie in somebody's arrays: a TetMesh that owns nothing.
struct TetView {
  std::span<const Vector3> points;
  std::span<const std::array<index_t, 4>> tets;
};

/// A surface that lies in somebody's arrays: a TriangleMesh that owns nothing.
struct TriangleView {
  std::span<const Vector3> points;
  std::span<const std::array<index_t, 3>> triangles;
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

template <class M>
struct indexed_tet_traits : indexed_traits<M> {
  static auto cells(const M& mesh) { return std::views::iota(index_t{0}, static_cast<index_t>(mesh.tets.size())); }
  static std::array<index_t, 4> cell_vertices(const M& mesh, index_t cell) { return mesh.tets[cell]; }
};

template <class M>
struct indexed_triangle_traits : indexed_traits<M> {
  static auto cells(const M& mesh) { return std::views::iota(index_t{0}, static_cast<index_t>(mesh.triangles.size())); }
  static std::array<index_t, 3> cell_vertices(const M& mesh, index_t cell) { return mesh.triangles[cell]; }
};

}  // namespace detail

template <>
struct mesh_traits<IndexedTetMesh> : detail::indexed_tet_traits<IndexedTetMesh> {};
template <>
struct mesh_traits<TetView> : detail::indexed_tet_traits<TetView> {};
template <>
struct mesh_traits<IndexedTriangleMesh> : detail::indexed_triangle_traits<IndexedTriangleMesh> {};
template <>
struct mesh_traits<TriangleView> : detail::indexed_triangle_traits<TriangleView> {};

static_assert(TetMesh<IndexedTetMesh>);
static_assert(TetMesh<TetView>);
static_assert(TriangleMesh<IndexedTriangleMesh>);
static_assert(TriangleMesh<TriangleView>);

namespace detail {

/// `.points` and `.triangles` of any surface as flat arrays: its own where it has them, else a copy.
template <TriangleMesh M>
decltype(auto) flat(const M& mesh) {
  if constexpr (std::same_as<M, IndexedTriangleMesh>) {
    return mesh;
  } else if constexpr (std::same_as<M, TriangleView>) {
    return TriangleView(mesh);
  } else if constexpr (requires {
                         { mesh.view() } -> std::same_as<TriangleView>;
                       }) {
    return mesh.view();
  } else {
    return IndexedTriangleMesh{positions(mesh), triangles(mesh)};
  }
}

}  // namespace detail

}  // namespace framehex
