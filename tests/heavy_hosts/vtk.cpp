// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/vtk.hpp"
#include "framehex/mesh/enclosed_volume.hpp"
#include "support/host_reference.hpp"

#include <vtkCell.h>
#include <vtkDelaunay3D.h>
#include <vtkMeshQuality.h>
#include <vtkSphereSource.h>
#include <vtkXMLUnstructuredGridWriter.h>

using namespace framehex;

namespace {

/// The reference as a grid that has a triangle and a vertex in front as well.
vtkNew<vtkUnstructuredGrid> reference_grid(bool with_regions) {
  const auto& reference = test::host_reference();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vector3& p : reference.mesh.points) points->InsertNextPoint(p.data());
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(points);
  vtkNew<vtkIntArray> regions;
  regions->SetName("material");
  const vtkIdType triangle[3] = {0, 1, 2};
  grid->InsertNextCell(VTK_VERTEX, 1, triangle);
  grid->InsertNextCell(VTK_TRIANGLE, 3, triangle);
  regions->InsertNextValue(-1);
  regions->InsertNextValue(-1);
  for (std::size_t c = 0; c < reference.mesh.tets.size(); ++c) {
    const auto& t = reference.mesh.tets[c];
    const vtkIdType v[4] = {t[0], t[1], t[2], t[3]};
    grid->InsertNextCell(VTK_TETRA, 4, v);
    regions->InsertNextValue(static_cast<int>(reference.regions[c]));
  }
  if (with_regions) grid->GetCellData()->AddArray(regions);
  return grid;
}

MixedMesh from_grid(vtkUnstructuredGrid& grid) {
  MixedMesh mesh;
  for (vtkIdType v = 0; v < grid.GetNumberOfPoints(); ++v) mesh.points.emplace_back(grid.GetPoint(v));
  auto* const regions = grid.GetCellData()->GetArray("region");
  REQUIRE(regions);
  for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
    const int type = grid.GetCellType(c);
    const auto kind = std::find_if(all_cell_kinds.begin(), all_cell_kinds.end(),
                                   [&](CellKind k) { return framehex::vtk::cell_type(k) == type; });
    REQUIRE(kind != all_cell_kinds.end());
    std::vector<index_t> corners;
    for (std::size_t i = 0; i < static_cast<std::size_t>(n_corners(*kind)); ++i)
      corners.push_back(
          static_cast<index_t>(grid.GetCell(c)->GetPointId(static_cast<int>(framehex::vtk::corner(*kind, i)))));
    mesh.add(*kind, corners);
    mesh.regions.push_back(static_cast<index_t>(regions->GetComponent(c, 0)));
  }
  return mesh;
}

}  // namespace

TEST_CASE("the tetrahedra of a grid are a mesh, other cells aside") {
  const auto grid = reference_grid(true);
  const VtkTets view(*grid);
  test::check_host(view);
  CHECK(view.cells().front() == 2);
  CHECK(view.regions("material") == test::host_reference().regions);
  CHECK_THROWS_AS(view.regions("colour"), invalid_option);
  grid->GetCellData()->GetArray("material")->SetComponent(5, 0, -2);
  try {
    view.regions("material");
    FAIL();
  } catch (const invalid_option& e) {
    CHECK(e.indices() == std::vector<std::size_t>{3});
  }
  const vtkIdType wedge[6] = {0, 1, 2, 3, 4, 5};
  grid->InsertNextCell(VTK_WEDGE, 6, wedge);
  CHECK_THROWS_AS(VtkTets(*grid), invalid_connectivity);
}

TEST_CASE("a grid takes the result back, with volumes as VTK counts them") {
  const MixedMesh& expected = test::host_reference().result.mesh;
  VtkOutput output;
  export_mesh(expected, output);
  const MixedMesh back = from_grid(*output.grid());
  test::check_same_cells(back, expected);
  CHECK(back.regions == expected.regions);
  CHECK(output.faces()->GetNumberOfPolys() == static_cast<vtkIdType>(expected.faces.size()));

  // Wedges counted the other way round would have a negative volume.
  vtkNew<vtkMeshQuality> quality;
  quality->SetInputData(output.grid());
  quality->SetTetQualityMeasureToVolume();
  quality->SetHexQualityMeasureToVolume();
  quality->Update();
  auto* const volumes = quality->GetOutput()->GetCellData()->GetArray("Quality");
  const std::array<std::size_t, 2> counted{0, 3};
  double sum = 0;
  for (vtkIdType c = 0; c < volumes->GetNumberOfTuples(); ++c) {
    const auto kind = static_cast<std::size_t>(back.kinds[static_cast<std::size_t>(c)]);
    if (kind == 0 || kind == 3) sum += volumes->GetComponent(c, 0);
  }
  const auto report = verify::volume(expected);
  // VTK takes the faces of a hexahedron for flat, which those that were moved are not quite.
  CHECK(sum == Approx(report.by_kind[counted[0]] + report.by_kind[counted[1]]).epsilon(1e-3));
  if (const char* const folder = std::getenv("FRAMEHEX_KEEP_MESHES")) {
    vtkNew<vtkXMLUnstructuredGridWriter> writer;
    writer->SetFileName((std::string(folder) + "/vtk.vtu").c_str());
    writer->SetInputData(output.grid());
    writer->Write();
  }
}

TEST_CASE("poly data are a surface") {
  vtkNew<vtkSphereSource> sphere;
  sphere->Update();
  const VtkTriangles view(*sphere->GetOutput());
  CHECK_NOTHROW(validate_closed(view));
  CHECK(enclosed_volume(view) > 0.3);
  vtkNew<vtkPolyData> quad;
  quad->DeepCopy(sphere->GetOutput());
  const vtkIdType v[4] = {0, 1, 2, 3};
  quad->GetPolys()->InsertNextCell(4, v);
  CHECK_THROWS_AS(VtkTriangles(*quad), invalid_connectivity);
}

TEST_CASE("VTK's Delaunay tetrahedra are recombined") {
  vtkNew<vtkPoints> points;
  for (int i = 0; i < 64; ++i) points->InsertNextPoint(i % 4, i / 4 % 4 + 0.1 * (i % 4), i / 16 + 0.05 * (i / 4 % 4));
  vtkNew<vtkPolyData> cloud;
  cloud->SetPoints(points);
  vtkNew<vtkDelaunay3D> delaunay;
  delaunay->SetInputData(cloud);
  delaunay->Update();
  const VtkTets view(*delaunay->GetOutput());
  REQUIRE(view.cells().size() > 100);
  CHECK_NOTHROW(validate(view));
  CHECK(verify::is_conforming(recombine(view).mesh));
}
