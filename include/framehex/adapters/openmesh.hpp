// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/detail/boundary_faces.hpp"
#include "framehex/errors.hpp"
#include "framehex/mesh/concepts.hpp"

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

/// OpenMesh's triangle meshes as a TriangleMesh, and boundaries of results as its polygon meshes.
namespace framehex {

/// Any `OpenMesh::TriMesh_ArrayKernelT<Traits>`, or a class derived from one.
template <class M>
concept OpenMeshTriangles = std::derived_from<M, OpenMesh::TriConnectivity> && requires {
  typename M::Point;
};

/// Deleted vertices that are not yet collected leave gaps in the numbers, which are refused with the first of them: call
/// `mesh.garbage_collection()` before.
template <OpenMeshTriangles M>
struct mesh_traits<M> {
  using vertex_type = OpenMesh::VertexHandle;
  using cell_type = OpenMesh::FaceHandle;
  using scalar_type = typename M::Scalar;

  static auto vertices(const M& mesh) {
    refuse_gaps(mesh);
    return living<vertex_type>(mesh, mesh.n_vertices(), mesh.has_vertex_status());
  }
  static auto cells(const M& mesh) { return living<cell_type>(mesh, mesh.n_faces(), mesh.has_face_status()); }
  static std::size_t index(const M&, vertex_type v) { return static_cast<std::size_t>(v.idx()); }
  static std::array<scalar_type, 3> point(const M& mesh, vertex_type v) {
    const auto& p = mesh.point(v);
    return {p[0], p[1], p[2]};
  }
  static std::array<vertex_type, 3> cell_vertices(const M& mesh, cell_type f) {
    const auto h = mesh.halfedge_handle(f);
    return {mesh.from_vertex_handle(h), mesh.to_vertex_handle(h), mesh.to_vertex_handle(mesh.next_halfedge_handle(h))};
  }

private:
  static void refuse_gaps(const M& mesh) {
    if (!mesh.has_vertex_status()) return;
    const int n = static_cast<int>(mesh.n_vertices());
    int first = 0;
    while (first < n && !mesh.status(vertex_type(first)).deleted()) ++first;
    for (int v = first; v < n; ++v)
      if (!mesh.status(vertex_type(v)).deleted())
        throw invalid_connectivity("vertex " + std::to_string(first) +
                                       " is deleted and leaves a gap in the numbers: call garbage_collection() before",
                                   Entity::vertex, {static_cast<std::size_t>(first)});
  }

  template <class Handle>
  static auto living(const M& mesh, std::size_t n, bool has_status) {
    return std::views::iota(0, static_cast<int>(n)) |
           std::views::filter([&mesh, has_status](int i) { return !has_status || !mesh.status(Handle(i)).deleted(); }) |
           std::views::transform([](int i) { return Handle(i); });
  }
};
static_assert(TriangleMesh<OpenMesh::TriMesh_ArrayKernelT<>>);

/// Adds the boundary of a mixed mesh, triangles and quadrilaterals, to a polygon mesh.
///
/// @param mesh      conforming.
/// @param boundary  any `OpenMesh::PolyMesh_ArrayKernelT<Traits>`.
/// @return vertex added to `boundary` -> vertex of `mesh`, in the order in which they were added.
/// @throws nonmanifold  with the cell whose face OpenMesh refuses, where parts touch in a vertex or an edge.
/// @par Complexity   O(n log n).
template <class PolyMesh>
requires std::derived_from<PolyMesh, OpenMesh::PolyConnectivity> std::vector<index_t> add_boundary(
    const MixedMesh& mesh, PolyMesh& boundary) {
  using Scalar = typename PolyMesh::Scalar;
  return detail::add_boundary_faces<OpenMesh::VertexHandle>(
      mesh,
      [&](const Vector3& p) {
        return boundary.add_vertex(typename PolyMesh::Point(static_cast<Scalar>(p.x()), static_cast<Scalar>(p.y()),
                                                            static_cast<Scalar>(p.z())));
      },
      [&](const std::vector<OpenMesh::VertexHandle>& corners) { return boundary.add_face(corners).is_valid(); });
}

}  // namespace framehex
