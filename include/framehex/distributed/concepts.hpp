// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/concepts.hpp"
#include "framehex/mesh/indexed_mesh.hpp"

#include <cstdint>

namespace framehex::distributed {

/// How a host's part of a mesh belongs to the whole. A host specialises this for the type whose `mesh_traits` describe
/// the part that lies on this rank: its cells, and all their vertices.
/// @code
/// template <> struct framehex::distributed::distribution_traits<MyPart> {
///   static std::int64_t global_vertex(const MyPart&, vertex_type);  // >= 0, < 2^62, the same number on all ranks that have it
///   static std::int64_t global_cell(const MyPart&, cell_type);      // the same range, on one rank only
///   static int owner(const MyPart&, vertex_type);                   // rank; it must have the vertex itself
/// };
/// @endcode
/// Numbers need not be without gaps. Where results depend on an order of vertices or cells it is that of these numbers:
/// they are then those of the whole mesh with its vertices and cells in this order.
template <class M>
struct distribution_traits {};

/// A part of a mesh of tetrahedra, cells on one rank only, that can be read through both traits.
template <class M>
concept DistributedTetMesh = TetMesh<M> && requires(const M& mesh, vertex_t<M> vertex, cell_t<M> cell) {
  { distribution_traits<M>::global_vertex(mesh, vertex) } -> std::convertible_to<std::int64_t>;
  { distribution_traits<M>::global_cell(mesh, cell) } -> std::convertible_to<std::int64_t>;
  { distribution_traits<M>::owner(mesh, vertex) } -> std::convertible_to<int>;
};

/// Reference model of DistributedTetMesh.
struct IndexedPart {
  IndexedTetMesh mesh;
  std::vector<std::int64_t> vertex_ids;  ///< global numbers, per vertex
  std::vector<std::int64_t> cell_ids;    ///< the same per tetrahedron
  std::vector<int> owners;               ///< rank, per vertex
};

}  // namespace framehex::distributed

namespace framehex {

template <>
struct mesh_traits<distributed::IndexedPart> {
  using Part = distributed::IndexedPart;
  using Traits = mesh_traits<IndexedTetMesh>;
  using vertex_type = index_t;
  using cell_type = index_t;
  using scalar_type = double;

  static auto vertices(const Part& part) { return Traits::vertices(part.mesh); }
  static auto cells(const Part& part) { return Traits::cells(part.mesh); }
  static std::size_t index(const Part&, index_t vertex) { return vertex; }
  static std::array<double, 3> point(const Part& part, index_t vertex) { return Traits::point(part.mesh, vertex); }
  static std::array<index_t, 4> cell_vertices(const Part& part, index_t cell) { return part.mesh.tets[cell]; }
};

template <>
struct distributed::distribution_traits<distributed::IndexedPart> {
  static std::int64_t global_vertex(const IndexedPart& part, index_t vertex) { return part.vertex_ids[vertex]; }
  static std::int64_t global_cell(const IndexedPart& part, index_t cell) { return part.cell_ids[cell]; }
  static int owner(const IndexedPart& part, index_t vertex) { return part.owners[vertex]; }
};

static_assert(distributed::DistributedTetMesh<distributed::IndexedPart>);

}  // namespace framehex
