// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/io/label_limit.hpp"
#include "framehex/io/vtk_cells.hpp"
#include "framehex/mesh/concepts.hpp"
#include "framehex/mesh/mixed_output.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataSetAttributes.h>
#include <vtkIdList.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

/// VTK: the tetrahedra of a grid as a TetMesh, poly data as a TriangleMesh, and a grid as a place for results.
namespace framehex {

namespace detail {

/// @throws invalid_option  when the array has another number of values than there are cells.
inline void check_vtk_values(vtkDataArray& values, vtkIdType n_cells) {
  if (values.GetNumberOfTuples() != n_cells)
    throw invalid_option("an array of cell data has " + std::to_string(values.GetNumberOfTuples()) + " values for " +
                         std::to_string(n_cells) + " cells");
}

/// Which cells of a data set are another part's or hidden, by the array that VTK keeps for it.
class VtkGhosts {
public:
  explicit VtkGhosts(vtkDataSet& data)
      : types_(vtkArrayDownCast<vtkUnsignedCharArray>(
            data.GetCellData()->GetArray(vtkDataSetAttributes::GhostArrayName()))) {
    if (types_) check_vtk_values(*types_, data.GetNumberOfCells());
  }
  bool operator()(vtkIdType cell) const {
    constexpr int hidden =
        vtkDataSetAttributes::DUPLICATECELL | vtkDataSetAttributes::HIDDENCELL | vtkDataSetAttributes::REFINEDCELL;
    return types_ && (types_->GetValue(cell) & hidden) != 0;
  }

private:
  vtkUnsignedCharArray* types_;
};

/// Triangles or tetrahedra of a data set, their corners copied: what `vtkCellArray` hands out is overwritten at the next
/// question when it holds 32 bits, whichever thread asks.
template <class Data, std::size_t Corners>
class VtkSimplices {
public:
  static constexpr std::size_t n_corners = Corners;

  Data& data() const { return *data_; }
  /// VTK's numbers of the cells.
  const std::vector<vtkIdType>& cells() const { return cells_; }
  const std::vector<std::array<vtkIdType, Corners>>& corners() const { return corners_; }

  /// @throws invalid_connectivity  when the data set has lost or gained cells since the view was made.
  void check_unchanged() const {
    if (data_->GetNumberOfCells() != n_cells_)
      throw invalid_connectivity("the data set has " + std::to_string(data_->GetNumberOfCells()) + " cells, and had " +
                                 std::to_string(n_cells_) + " when the view was made");
  }

protected:
  explicit VtkSimplices(Data& data) : data_(&data), n_cells_(data.GetNumberOfCells()) {}

  void add(vtkIdType cell, vtkIdList& corners) {
    cells_.push_back(cell);
    auto& row = corners_.emplace_back();
    for (std::size_t i = 0; i < Corners; ++i) row[i] = corners.GetId(static_cast<vtkIdType>(i));
  }

  std::vector<index_t> labels(const char* array, const char* cell_name, const char* use, Entity entity) const {
    check_unchanged();
    vtkDataArray* const values = array ? data_->GetCellData()->GetArray(array) : nullptr;
    if (!values)
      throw invalid_option(array ? std::string("there is no array of cell data named ") + array
                                 : std::string("an array of cell data must be named"));
    check_vtk_values(*values, n_cells_);
    std::vector<index_t> labels;
    labels.reserve(cells_.size());
    for (const vtkIdType c : cells_) {
      const double value = values->GetComponent(c, 0);
      if (!(value >= 0 && value < no_index) || value != std::floor(value))
        throw invalid_option("the value of " + (cell_name + std::to_string(labels.size())) + " is no label of " + use,
                             entity, {labels.size()});
      labels.push_back(static_cast<index_t>(value));
    }
    return labels;
  }

private:
  Data* data_;
  vtkIdType n_cells_;
  std::vector<vtkIdType> cells_;
  std::vector<std::array<vtkIdType, Corners>> corners_;
};

template <class View>
struct vtk_traits {
  using vertex_type = vtkIdType;
  using cell_type = std::size_t;  // its place in `cells()`
  using scalar_type = double;

  static auto vertices(const View& view) { return std::views::iota(vtkIdType{0}, view.data().GetNumberOfPoints()); }
  static auto cells(const View& view) {
    view.check_unchanged();
    return std::views::iota(std::size_t{0}, view.cells().size());
  }
  static std::size_t index(const View&, vtkIdType v) { return static_cast<std::size_t>(v); }
  static std::array<double, 3> point(const View& view, vtkIdType v) {
    std::array<double, 3> p;
    view.data().GetPoint(v, p.data());
    return p;
  }
  static std::array<vtkIdType, View::n_corners> cell_vertices(const View& view, std::size_t cell) {
    return view.corners()[cell];
  }
};

}  // namespace detail

/// The tetrahedra of a grid, which must outlive it. Vertices, lines, polygons and deleted cells (`VTK_EMPTY_CELL`) are
/// passed over, and so are those that `vtkGhostType` says are another part's (duplicate), refined or hidden; cells are
/// numbered among the rest: `cells()[i]` is VTK's number of the i-th. Corners are copied, points are not.
class VtkTets : public detail::VtkSimplices<vtkUnstructuredGrid, 4> {
public:
  /// @throws invalid_connectivity  with VTK's number of the first solid cell that is no linear tetrahedron;
  ///         invalid_option  when `vtkGhostType` has another number of values than there are cells.
  explicit VtkTets(vtkUnstructuredGrid& grid) : VtkSimplices(grid) {
    const detail::VtkGhosts ghosts(grid);
    vtkNew<vtkIdList> corners;
    for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
      const int type = grid.GetCellType(c);
      if (type <= VTK_QUAD || ghosts(c)) continue;
      const auto refuse = [c](const std::string& reason) {
        throw invalid_connectivity("cell " + std::to_string(c) + " of the grid is " + reason, Entity::cell,
                                   {static_cast<std::size_t>(c)});
      };
      if (type != VTK_TETRA) refuse("no linear tetrahedron");
      grid.GetCells()->GetCellAtId(c, corners);
      if (corners->GetNumberOfIds() != 4)
        refuse("a tetrahedron of " + std::to_string(corners->GetNumberOfIds()) + " points");
      add(c, *corners);
    }
  }

  /// An array of the grid's cell data as labels of regions, one for each tetrahedron.
  ///
  /// @throws invalid_option  when there is no such array, when it has not one value a cell, or naming the first
  ///         tetrahedron whose value is no label; invalid_connectivity when the grid has lost or gained cells.
  std::vector<index_t> regions(const char* array) const {
    return labels(array, "tetrahedron ", "a region", Entity::cell);
  }
};

/// Poly data of triangles alone, which must outlive it. Deleted and ghost cells are passed over as by `VtkTets`, and so
/// are vertices and lines: `cells()[i]` is VTK's number of the i-th triangle. Corners are copied, points are not.
class VtkTriangles : public detail::VtkSimplices<vtkPolyData, 3> {
public:
  /// @throws invalid_connectivity  with the first polygon that is no triangle, or when there are strips;
  ///         invalid_option  when `vtkGhostType` has another number of values than there are cells.
  explicit VtkTriangles(vtkPolyData& surface) : VtkSimplices(surface) {
    if (surface.GetNumberOfStrips() > 0)
      throw invalid_connectivity("the surface has triangle strips: vtkTriangleFilter takes them apart");
    const detail::VtkGhosts ghosts(surface);
    // Asked before anyone has deleted a cell, `GetCellType` would build what it answers from.
    const bool may_have_deleted = !surface.NeedToBuildCells();
    const vtkIdType first = surface.GetNumberOfVerts() + surface.GetNumberOfLines();  // cells are numbered behind these
    vtkNew<vtkIdList> corners;
    for (vtkIdType c = 0; c < surface.GetNumberOfPolys(); ++c) {
      if (ghosts(first + c) || (may_have_deleted && surface.GetCellType(first + c) == VTK_EMPTY_CELL)) continue;
      surface.GetPolys()->GetCellAtId(c, corners);
      if (corners->GetNumberOfIds() != 3)
        throw invalid_connectivity("polygon " + std::to_string(c) + " is no triangle", Entity::triangle,
                                   {static_cast<std::size_t>(c)});
      add(first + c, *corners);
    }
  }

  /// An array of the surface's cell data as labels of patches (`FeatureOptions::patches`), one for each triangle.
  ///
  /// @throws as `VtkTets::regions`, with the triangle.
  std::vector<index_t> patches(const char* array) const {
    return labels(array, "triangle ", "a patch", Entity::triangle);
  }
};

template <>
struct mesh_traits<VtkTets> : detail::vtk_traits<VtkTets> {};
static_assert(TetMesh<VtkTets>);

template <>
struct mesh_traits<VtkTriangles> : detail::vtk_traits<VtkTriangles> {};
static_assert(TriangleMesh<VtkTriangles>);

/// Makes a grid of the cells with their array `region`, and poly data of the labelled faces with their array `patch`
/// over the same points. What is added throws io_error for labels beyond 2^31 - 1, which the arrays of `int` do not hold.
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

  // Each insertion says `Modified`, or VTK goes on answering with the bounds and ranges of before.
  vtkIdType add_vertex(const std::array<double, 3>& p) {
    points_->Modified();
    return points_->InsertNextPoint(p.data());
  }
  void add_cell(CellKind kind, std::span<const vtkIdType> corners, index_t region) {
    detail::check_label_fits("VTK", region, detail::greatest_int_label);
    std::array<vtkIdType, 8> v{};
    for (std::size_t i = 0; i < corners.size(); ++i) v[i] = corners[vtk::corner(kind, i)];
    grid_->InsertNextCell(vtk::cell_type(kind), static_cast<vtkIdType>(corners.size()), v.data());
    add_label(*regions_, region, *grid_);
  }
  void add_face(std::span<const vtkIdType> corners, index_t label) {
    detail::check_label_fits("VTK", label, detail::greatest_int_label);
    polygons_->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
    polygons_->Modified();
    add_label(*patches_, label, *faces_);
  }

  vtkUnstructuredGrid* grid() const { return grid_; }
  vtkPolyData* faces() const { return faces_; }

private:
  static void add_label(vtkIntArray& labels, index_t label, vtkDataSet& owner) {
    labels.InsertNextValue(static_cast<int>(label));
    labels.Modified();
    owner.Modified();
  }

  vtkNew<vtkPoints> points_;
  vtkNew<vtkUnstructuredGrid> grid_;
  vtkNew<vtkPolyData> faces_;
  vtkNew<vtkCellArray> polygons_;
  vtkNew<vtkIntArray> regions_, patches_;
};
static_assert(MixedOutput<VtkOutput>);

}  // namespace framehex
