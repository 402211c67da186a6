// SPDX-License-Identifier: BSL-1.0
// Stands in for OpenVolumeMesh: tetrahedra, whose vertices it lists in an order of its own.
#pragma once

#include <OpenVolumeMesh/Mesh/PolyhedralMesh.hh>

namespace OpenVolumeMesh {

class TetrahedralMeshTopologyKernel {};

class GeometricTetrahedralMeshV3d : public TetrahedralMeshTopologyKernel {
public:
  std::size_t n_vertices() const { return points_.size(); }
  std::size_t n_cells() const { return cells_.size(); }
  VertexHandle add_vertex(const Vec3d& p) {
    points_.push_back(p);
    return VertexHandle(static_cast<int>(points_.size()) - 1);
  }
  const Vec3d& vertex(VertexHandle v) const { return points_[static_cast<std::size_t>(v.idx())]; }
  CellHandle add_cell(const std::vector<VertexHandle>& vertices) {
    cells_.push_back(vertices);
    return CellHandle(static_cast<int>(cells_.size()) - 1);
  }
  std::vector<VertexHandle> get_cell_vertices(CellHandle c) const { return cells_[static_cast<std::size_t>(c.idx())]; }

private:
  std::vector<Vec3d> points_;
  std::vector<std::vector<VertexHandle>> cells_;
};

}  // namespace OpenVolumeMesh
