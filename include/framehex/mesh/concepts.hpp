// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <ranges>
#include <vector>

namespace framehex {

/// How a host's mesh is read. A host specialises this for its own type; the mesh is never copied into another class
/// of mesh, owned or modified. The primary template is empty, so that what is missing is a named compile error.
///
/// For tetrahedra (concept TetMesh):
/// @code
/// template <> struct framehex::mesh_traits<MyMesh> {
///   using vertex_type = ...;   // handles: cheap to copy
///   using cell_type = ...;
///   using scalar_type = double;
///   static auto vertices(const MyMesh&);                   // forward range of vertex_type
///   static auto cells(const MyMesh&);                      // forward range of cell_type
///   static std::size_t index(const MyMesh&, vertex_type);  // 0-based, in the order of vertices()
///   static std::array<scalar_type, 3> point(const MyMesh&, vertex_type);
///   static std::array<vertex_type, 4> cell_vertices(const MyMesh&, cell_type);  // positive: (1-0)x(2-0).(3-0) > 0
/// };
/// @endcode
/// For triangles (concept TriangleMesh): `cell_vertices` returns three, anticlockwise seen from outside.
/// Results number cells 0-based in the order of `cells()`.
template <class M>
struct mesh_traits {};

/// Handle of a vertex of a host's mesh.
template <class M>
using vertex_t = typename mesh_traits<M>::vertex_type;
/// Handle of a cell of a host's mesh.
template <class M>
using cell_t = typename mesh_traits<M>::cell_type;
/// Coordinates of a host's mesh.
template <class M>
using scalar_t = typename mesh_traits<M>::scalar_type;

namespace detail {

template <class M, std::size_t Corners>
concept SimplexMesh = requires(const M& mesh, vertex_t<M> vertex, cell_t<M> cell) {
  requires std::floating_point<scalar_t<M>>;
  { mesh_traits<M>::vertices(mesh) } -> std::ranges::forward_range;
  { mesh_traits<M>::cells(mesh) } -> std::ranges::forward_range;
  requires std::convertible_to<std::ranges::range_value_t<decltype(mesh_traits<M>::vertices(mesh))>, vertex_t<M>>;
  requires std::convertible_to<std::ranges::range_value_t<decltype(mesh_traits<M>::cells(mesh))>, cell_t<M>>;
  { mesh_traits<M>::index(mesh, vertex) } -> std::convertible_to<std::size_t>;
  { mesh_traits<M>::point(mesh, vertex) } -> std::convertible_to<std::array<scalar_t<M>, 3>>;
  { mesh_traits<M>::cell_vertices(mesh, cell) } -> std::convertible_to<std::array<vertex_t<M>, Corners>>;
};

}  // namespace detail

/// A mesh of tetrahedra that can be read through `mesh_traits<M>`.
template <class M>
concept TetMesh = detail::SimplexMesh<M, 4>;

/// A mesh of triangles in space that can be read through `mesh_traits<M>`.
template <class M>
concept TriangleMesh = detail::SimplexMesh<M, 3>;

/// Counts the vertices. O(n) where the host's range has no size.
template <class M>
requires TetMesh<M> || TriangleMesh<M> std::size_t n_vertices(const M& mesh) {
  return static_cast<std::size_t>(std::ranges::distance(mesh_traits<M>::vertices(mesh)));
}

namespace detail {

/// Coordinates as the concept promises them, whatever type of its own the host returns.
template <class M>
std::array<scalar_t<M>, 3> coordinates(const M& mesh, vertex_t<M> vertex) {
  return mesh_traits<M>::point(mesh, vertex);
}

}  // namespace detail

/// Coordinates by dense vertex index, in double precision.
template <class M>
requires TetMesh<M> || TriangleMesh<M> std::vector<Vector3> positions(const M& mesh) {
  std::vector<Vector3> points;
  points.reserve(n_vertices(mesh));
  for (const auto vertex : mesh_traits<M>::vertices(mesh)) {
    const std::array<scalar_t<M>, 3> p = detail::coordinates<M>(mesh, vertex);
    points.emplace_back(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
  }
  return points;
}

namespace detail {

template <std::size_t Corners, class M>
std::vector<std::array<index_t, Corners>> connectivity(const M& mesh) {
  std::vector<std::array<index_t, Corners>> cells;
  for (const auto cell : mesh_traits<M>::cells(mesh)) {
    const std::array<vertex_t<M>, Corners> corners = mesh_traits<M>::cell_vertices(mesh, cell);
    auto& row = cells.emplace_back();
    for (std::size_t i = 0; i < Corners; ++i) row[i] = static_cast<index_t>(mesh_traits<M>::index(mesh, corners[i]));
  }
  return cells;
}

}  // namespace detail

/// Dense vertex indices of every tetrahedron, in the host's order.
template <TetMesh M>
std::vector<std::array<index_t, 4>> tetrahedra(const M& mesh) {
  return detail::connectivity<4>(mesh);
}

/// Dense vertex indices of every triangle, in the host's order.
template <TriangleMesh M>
std::vector<std::array<index_t, 3>> triangles(const M& mesh) {
  return detail::connectivity<3>(mesh);
}

}  // namespace framehex
