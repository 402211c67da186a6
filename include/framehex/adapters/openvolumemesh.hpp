// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/predicates.hpp"
#include "framehex/mesh/concepts.hpp"
#include "framehex/mesh/mixed_output.hpp"

#include <OpenVolumeMesh/Mesh/PolyhedralMesh.hh>
#include <OpenVolumeMesh/Mesh/TetrahedralMesh.hh>

#include <algorithm>
#include <map>

/// OpenVolumeMesh: its tetrahedral meshes as a TetMesh, its polyhedral ones as a place for results.
namespace framehex {

/// Any geometric tetrahedral mesh of OpenVolumeMesh, `GeometricTetrahedralMeshV3d` say, or a class derived from one.
template <class M>
concept OpenVolumeMeshTets = std::derived_from<M, OpenVolumeMesh::TetrahedralMeshTopologyKernel> &&
    requires(const M& mesh, OpenVolumeMesh::VertexHandle v) {
  mesh.vertex(v)[0];
};

/// @pre no deleted entities: `mesh.collect_garbage()` before.
template <OpenVolumeMeshTets M>
struct mesh_traits<M> {
  using vertex_type = OpenVolumeMesh::VertexHandle;
  using cell_type = OpenVolumeMesh::CellHandle;
  using scalar_type = std::remove_cvref_t<decltype(std::declval<const M&>().vertex(vertex_type(0))[0])>;

  static auto vertices(const M& mesh) {
    return std::views::iota(0, static_cast<int>(mesh.n_vertices())) |
           std::views::transform([](int i) { return vertex_type(i); });
  }
  static auto cells(const M& mesh) {
    return std::views::iota(0, static_cast<int>(mesh.n_cells())) |
           std::views::transform([](int i) { return cell_type(i); });
  }
  static std::size_t index(const M&, vertex_type v) { return static_cast<std::size_t>(v.idx()); }
  static std::array<scalar_type, 3> point(const M& mesh, vertex_type v) {
    const auto& p = mesh.vertex(v);
    return {p[0], p[1], p[2]};
  }
  /// The order in which OpenVolumeMesh lists them depends on how the cell was made; here they are positive.
  static std::array<vertex_type, 4> cell_vertices(const M& mesh, cell_type c) {
    const std::vector<vertex_type> listed = mesh.get_cell_vertices(c);
    std::array<vertex_type, 4> v{listed[0], listed[1], listed[2], listed[3]};
    const auto p = [&](std::size_t i) {
      const auto& x = mesh.vertex(v[i]);
      return Vector3(static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2]));
    };
    if (orientation(p(0), p(1), p(2), p(3)) < 0) std::swap(v[2], v[3]);
    return v;
  }
};

/// Adds cells to a geometric polyhedral mesh, `GeometricPolyhedralMeshV3d` say. Cells share their faces; the halffaces
/// of a cell look inward, as in OpenVolumeMesh's own examples.
template <class PolyhedralMesh>
class OpenVolumeMeshOutput {
public:
  using vertex_type = OpenVolumeMesh::VertexHandle;

  explicit OpenVolumeMeshOutput(PolyhedralMesh& mesh) : mesh_(mesh) {}

  vertex_type add_vertex(const std::array<double, 3>& p) {
    using Point = std::remove_cvref_t<decltype(mesh_.vertex(vertex_type(0)))>;
    using Scalar = std::remove_cvref_t<decltype(std::declval<const Point&>()[0])>;
    return mesh_.add_vertex(Point(static_cast<Scalar>(p[0]), static_cast<Scalar>(p[1]), static_cast<Scalar>(p[2])));
  }

  void add_cell(CellKind kind, std::span<const vertex_type> corners) {
    std::vector<OpenVolumeMesh::HalfFaceHandle> halffaces;
    for (const LocalFace& face : faces_of(kind)) {
      std::vector<vertex_type> inward;
      for (int i = face.size() - 1; i >= 0; --i)
        inward.push_back(corners[static_cast<std::size_t>(face.corners[static_cast<std::size_t>(i)])]);
      halffaces.push_back(halfface(inward));
    }
    mesh_.add_cell(halffaces);
  }

private:
  /// The face is made for the first of its cells; the second has its other side.
  OpenVolumeMesh::HalfFaceHandle halfface(const std::vector<vertex_type>& inward) {
    std::vector<int> key;
    for (const vertex_type v : inward) key.push_back(v.idx());
    std::sort(key.begin(), key.end());
    const auto [at, is_new] = face_of_.try_emplace(std::move(key));
    if (is_new) at->second = mesh_.add_face(inward);
    return mesh_.halfface_handle(at->second, is_new ? 0 : 1);
  }

  PolyhedralMesh& mesh_;
  std::map<std::vector<int>, OpenVolumeMesh::FaceHandle> face_of_;
};

}  // namespace framehex
