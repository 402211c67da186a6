// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/io/vtk_cells.hpp"
#include "framehex/mesh/concepts.hpp"
#include "framehex/mesh/mixed_output.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>

/// VTK: the tetrahedra of a grid as a TetMesh, poly data as a TriangleMesh, and a grid as a place for results.
namespace framehex {

namespace detail {

/// Corners of a cell, as VTK holds them.
template <std::size_t Corners>
std::array<vtkIdType, Corners> vtk_corners(vtkCellArray& cells, vtkIdType cell) {
  vtkIdType n = 0;
  const vtkIdType* v = nullptr;
  cells.GetCellAtId(cell, n, v);
  std::array<vtkIdType, Corners> corners;
  std::copy_n(v, Corners, corners.begin());
  return corners;
}

template <class View>
struct vtk_traits {
  using vertex_type = vtkIdType;
  using cell_type = vtkIdType;
  using scalar_type = double;

  static auto vertices(const View& view) { return std::views::iota(vtkIdType{0}, view.data().GetNumberOfPoints()); }
  static std::size_t index(const View&, vtkIdType v) { return static_cast<std::size_t>(v); }
  static std::array<double, 3> point(const View& view, vtkIdType v) {
    std::array<double, 3> p;
    view.data().GetPoint(v, p.data());
    return p;
  }
};

}  // namespace detail

/// The tetrahedra of a grid, which must outlive it. Vertices, lines and polygons in the grid are passed over, so that
/// cells are numbered among the tetrahedra: `cells()[i]` is VTK's number of the i-th.
class VtkTets {
public:
  /// @throws invalid_connectivity  with VTK's number of the first solid cell that is no linear tetrahedron.
  explicit VtkTets(vtkUnstructuredGrid& grid) : grid_(&grid) {
    for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
      const int type = grid.GetCellType(c);
      if (type == VTK_TETRA)
        cells_.push_back(c);
      else if (type > VTK_QUAD)
        throw invalid_connectivity("cell " + std::to_string(c) + " of the grid is no linear tetrahedron", Entity::cell,
                                   {static_cast<std::size_t>(c)});
    }
  }

  vtkUnstructuredGrid& data() const { return *grid_; }
  const std::vector<vtkIdType>& cells() const { return cells_; }

  /// An array of the grid's cell data as labels of regions, one for each tetrahedron.
  ///
  /// @throws invalid_option  when there is no such array, or naming the first tetrahedron whose value is no label.
  std::vector<index_t> regions(const char* array) const {
    vtkDataArray* const values = grid_->GetCellData()->GetArray(array);
    if (!values) throw invalid_option(std::string("the grid has no array of cell data named ") + array);
    std::vector<index_t> labels;
    for (const vtkIdType c : cells_) {
      const double value = values->GetComponent(c, 0);
      if (!(value >= 0 && value < no_index) || value != std::floor(value))
        throw invalid_option("the value of tetrahedron " + std::to_string(labels.size()) + " is no label of a region",
                             Entity::cell, {labels.size()});
      labels.push_back(static_cast<index_t>(value));
    }
    return labels;
  }

private:
  vtkUnstructuredGrid* grid_;
  std::vector<vtkIdType> cells_;
};

/// Poly data of triangles alone, which must outlive it.
class VtkTriangles {
public:
  /// @throws invalid_connectivity  with the first polygon that is no triangle, or when there are strips.
  explicit VtkTriangles(vtkPolyData& surface) : surface_(&surface) {
    if (surface.GetNumberOfStrips() > 0)
      throw invalid_connectivity("the surface has triangle strips: vtkTriangleFilter takes them apart");
    for (vtkIdType c = 0; c < surface.GetNumberOfPolys(); ++c)
      if (surface.GetPolys()->GetCellSize(c) != 3)
        throw invalid_connectivity("polygon " + std::to_string(c) + " is no triangle", Entity::triangle,
                                   {static_cast<std::size_t>(c)});
  }

  vtkPolyData& data() const { return *surface_; }

private:
  vtkPolyData* surface_;
};

template <>
struct mesh_traits<VtkTets> : detail::vtk_traits<VtkTets> {
  static const std::vector<vtkIdType>& cells(const VtkTets& view) { return view.cells(); }
  static std::array<vtkIdType, 4> cell_vertices(const VtkTets& view, vtkIdType c) {
    return detail::vtk_corners<4>(*view.data().GetCells(), c);
  }
};
static_assert(TetMesh<VtkTets>);

template <>
struct mesh_traits<VtkTriangles> : detail::vtk_traits<VtkTriangles> {
  static auto cells(const VtkTriangles& view) { return std::views::iota(vtkIdType{0}, view.data().GetNumberOfPolys()); }
  static std::array<vtkIdType, 3> cell_vertices(const VtkTriangles& view, vtkIdType c) {
    return detail::vtk_corners<3>(*view.data().GetPolys(), c);
  }
};
static_assert(TriangleMesh<VtkTriangles>);

/// Makes a grid of the cells with their array `region`, and poly data of the labelled faces with their array `patch`
/// over the same points.
class VtkOutput {
public:
  using vertex_type = vtkIdType;

  VtkOutput() {
    points_->SetDataTypeToDouble();
    grid_->SetPoints(points_);
    faces_->SetPoints(points_);
    faces_->SetPolys(polygons_);
    regions_->SetName("region");
    patches_->SetName("patch");
    grid_->GetCellData()->AddArray(regions_);
    faces_->GetCellData()->AddArray(patches_);
  }

  vtkIdType add_vertex(const std::array<double, 3>& p) { return points_->InsertNextPoint(p.data()); }
  void add_cell(CellKind kind, std::span<const vtkIdType> corners, index_t region) {
    std::array<vtkIdType, 8> v{};
    for (std::size_t i = 0; i < corners.size(); ++i) v[i] = corners[vtk::corner(kind, i)];
    grid_->InsertNextCell(vtk::cell_type(kind), static_cast<vtkIdType>(corners.size()), v.data());
    regions_->InsertNextValue(static_cast<int>(region));
  }
  void add_face(std::span<const vtkIdType> corners, index_t label) {
    polygons_->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
    patches_->InsertNextValue(static_cast<int>(label));
  }

  vtkUnstructuredGrid* grid() const { return grid_; }
  vtkPolyData* faces() const { return faces_; }

private:
  vtkNew<vtkPoints> points_;
  vtkNew<vtkUnstructuredGrid> grid_;
  vtkNew<vtkPolyData> faces_;
  vtkNew<vtkCellArray> polygons_;
  vtkNew<vtkIntArray> regions_, patches_;
};
static_assert(MixedOutput<VtkOutput>);

}  // namespace framehex
