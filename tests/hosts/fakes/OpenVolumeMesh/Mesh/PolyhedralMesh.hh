// SPDX-License-Identifier: BSL-1.0
// Stands in for OpenVolumeMesh, which Debian does not have: the names that the adapter uses, nothing else.
#pragma once

#include <array>
#include <vector>

namespace OpenVolumeMesh {

template <int Tag>
class Handle {
public:
  explicit Handle(int idx = -1) : idx_(idx) {}
  int idx() const { return idx_; }
  bool is_valid() const { return idx_ >= 0; }

private:
  int idx_;
};
using VertexHandle = Handle<0>;
using FaceHandle = Handle<1>;
using HalfFaceHandle = Handle<2>;
using CellHandle = Handle<3>;

struct Vec3d : std::array<double, 3> {
  Vec3d(double x, double y, double z) : std::array<double, 3>{x, y, z} {}
};

class GeometricPolyhedralMeshV3d {
public:
  std::size_t n_vertices() const { return points_.size(); }
  std::size_t n_faces() const { return faces_.size(); }
  std::size_t n_cells() const { return cells_.size(); }
  VertexHandle add_vertex(const Vec3d& p) {
    points_.push_back(p);
    return VertexHandle(static_cast<int>(points_.size()) - 1);
  }
  const Vec3d& vertex(VertexHandle v) const { return points_[static_cast<std::size_t>(v.idx())]; }
  FaceHandle add_face(const std::vector<VertexHandle>& vertices) {
    faces_.push_back(vertices);
    return FaceHandle(static_cast<int>(faces_.size()) - 1);
  }
  HalfFaceHandle halfface_handle(FaceHandle f, unsigned char side) const { return HalfFaceHandle(2 * f.idx() + side); }
  CellHandle add_cell(const std::vector<HalfFaceHandle>& halffaces) {
    cells_.push_back(halffaces);
    return CellHandle(static_cast<int>(cells_.size()) - 1);
  }
  /// For tests: a cell's halffaces, each by its vertices in order.
  std::vector<std::vector<VertexHandle>> halffaces(CellHandle c) const {
    std::vector<std::vector<VertexHandle>> result;
    for (const HalfFaceHandle h : cells_[static_cast<std::size_t>(c.idx())]) {
      auto vertices = faces_[static_cast<std::size_t>(h.idx() / 2)];
      if (h.idx() % 2 == 1) vertices = {vertices.rbegin(), vertices.rend()};
      result.push_back(std::move(vertices));
    }
    return result;
  }

protected:
  std::vector<Vec3d> points_;
  std::vector<std::vector<VertexHandle>> faces_;
  std::vector<std::vector<HalfFaceHandle>> cells_;
};

}  // namespace OpenVolumeMesh
