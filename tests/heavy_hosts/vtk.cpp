// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/vtk.hpp"
#include "framehex/mesh/enclosed_volume.hpp"
#include "support/host_reference.hpp"

#include <vtkCell.h>
#include <vtkDelaunay3D.h>
#include <vtkMeshQuality.h>
#include <vtkSphereSource.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <atomic>
#include <thread>

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

/// The message and indices of what is thrown, or nothing.
template <class Error, class Call>
std::pair<std::string, std::vector<std::size_t>> thrown(Call&& call) {
  try {
    call();
  } catch (const Error& e) {
    return {e.what(), e.indices()};
  }
  return {};
}

vtkNew<vtkPolyData> reference_surface() {
  vtkNew<vtkSphereSource> sphere;
  sphere->Update();
  vtkNew<vtkPolyData> surface;
  surface->DeepCopy(sphere->GetOutput());
  return surface;
}

void add_ghosts(vtkDataSet& data, const std::vector<unsigned char>& types) {
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  for (const unsigned char type : types) ghosts->InsertNextValue(type);
  data.GetCellData()->AddArray(ghosts);
}

}  // namespace

TEST_CASE("threads read one grid of 32-bit cells at a time") {
  const auto grid = reference_grid(false);
  vtkNew<vtkCellArray> cells;
  cells->DeepCopy(grid->GetCells());
  cells->ConvertTo32BitStorage();
  vtkNew<vtkUnsignedCharArray> types;
  types->DeepCopy(grid->GetCellTypesArray());
  grid->SetCells(types, cells);
  REQUIRE_FALSE(grid->GetCells()->IsStorage64Bit());
  const auto& tets = test::host_reference().mesh.tets;
  std::atomic<int> n_wrong{0};
  const auto read = [&] {
    for (int round = 0; round < 200; ++round) {
      const VtkTets view(*grid);
      std::size_t c = 0;
      for (const auto cell : mesh_traits<VtkTets>::cells(view)) {
        const auto v = mesh_traits<VtkTets>::cell_vertices(view, cell);
        for (std::size_t i = 0; i < 4; ++i) n_wrong += static_cast<index_t>(v[i]) != tets[c][i];
        ++c;
      }
    }
  };
  std::thread other(read);
  read();
  other.join();
  CHECK(n_wrong == 0);
}

TEST_CASE("grids that do not hold what they should are refused, not read beyond their ends") {
  const auto grid = reference_grid(true);
  const VtkTets view(*grid);
  CHECK(thrown<invalid_option>([&] { view.regions(nullptr); }).first == "an array of cell data must be named");
  vtkNew<vtkIntArray> few;
  few->SetName("few");
  for (int i = 0; i < 5; ++i) few->InsertNextValue(i);
  grid->GetCellData()->AddArray(few);
  const std::string n = std::to_string(grid->GetNumberOfCells());
  CHECK(thrown<invalid_option>([&] { view.regions("few"); }).first ==
        "an array of cell data has 5 values for " + n + " cells");

  const vtkIdType v[4] = {0, 1, 2, 3};
  const auto last = static_cast<std::size_t>(grid->InsertNextCell(VTK_TETRA, 3, v));
  const auto [message, indices] = thrown<invalid_connectivity>([&] { VtkTets{*grid}; });
  CHECK(message == "cell " + n + " of the grid is a tetrahedron of 3 points");
  CHECK(indices == std::vector<std::size_t>{last});
  CHECK_THROWS_AS(validate(view), invalid_connectivity);  // there is a cell more than when it was made
  CHECK_THROWS_AS(view.regions("material"), invalid_connectivity);

  vtkNew<vtkUnstructuredGrid> empty;
  grid->ShallowCopy(empty);
  CHECK_THROWS_AS(validate(view), invalid_connectivity);
}

TEST_CASE("deleted cells and ghosts of a grid are passed over") {
  const auto grid = reference_grid(true);
  const auto& reference = test::host_reference();
  const auto n = static_cast<std::size_t>(grid->GetNumberOfCells());
  std::vector<unsigned char> ghosts(n, 0);
  ghosts[2] = vtkDataSetAttributes::DUPLICATECELL;
  ghosts[4] = vtkDataSetAttributes::HIDDENCELL;
  ghosts[5] = vtkDataSetAttributes::EXTERIORCELL;  // at the outer boundary, and as good as any other
  add_ghosts(*grid, ghosts);
  grid->GetCellTypesArray()->SetValue(7, VTK_EMPTY_CELL);
  const VtkTets view(*grid);
  REQUIRE(view.cells().size() == reference.mesh.tets.size() - 3);
  CHECK(std::vector(view.cells().begin(), view.cells().begin() + 4) == std::vector<vtkIdType>{3, 5, 6, 8});
  CHECK(view.regions("material")[3] == reference.regions[6]);
  CHECK(mesh_traits<VtkTets>::cell_vertices(view, 3)[0] == reference.mesh.tets[6][0]);

  ghosts.pop_back();
  add_ghosts(*grid, ghosts);
  CHECK_THROWS_AS(VtkTets(*grid), invalid_option);
}

TEST_CASE("deleted polygons and ghosts of poly data are passed over; arrays of cell data are patches") {
  const auto surface = reference_surface();
  const auto n = static_cast<std::size_t>(surface->GetNumberOfPolys());
  vtkNew<vtkCellArray> vertices;
  const vtkIdType v = 0;
  vertices->InsertNextCell(1, &v);
  surface->SetVerts(vertices);
  vtkNew<vtkIntArray> colours;
  colours->SetName("colour");
  colours->InsertNextValue(-1);  // the vertex'
  for (std::size_t t = 0; t < n; ++t) colours->InsertNextValue(static_cast<int>(10 * t));
  surface->GetCellData()->AddArray(colours);
  CHECK(VtkTriangles(*surface).patches("colour")[5] == 50);
  CHECK_THROWS_AS(VtkTriangles(*surface).patches("material"), invalid_option);

  std::vector<unsigned char> ghosts(n + 1, 0);
  ghosts[1] = vtkDataSetAttributes::DUPLICATECELL;
  add_ghosts(*surface, ghosts);
  surface->BuildCells();
  surface->DeleteCell(3);
  const VtkTriangles view(*surface);
  CHECK(view.cells().size() == n - 2);
  CHECK(std::vector(view.cells().begin(), view.cells().begin() + 2) == std::vector<vtkIdType>{2, 4});
  const std::vector<index_t> patches = view.patches("colour");
  CHECK(std::vector(patches.begin(), patches.begin() + 2) == std::vector<index_t>{10, 30});
  colours->SetComponent(4, 0, -1);
  CHECK(thrown<invalid_option>([&] { view.patches("colour"); }).second == std::vector<std::size_t>{1});
}

TEST_CASE("labels that VTK's arrays do not hold are refused") {
  MixedMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.add(CellKind::tetrahedron, std::array<index_t, 4>{0, 1, 2, 3});
  mesh.regions = {2147483647u};
  mesh.faces = {{{0, 2, 1, no_index}, 2147483647u}};
  VtkOutput holds;
  export_mesh(mesh, holds);
  CHECK(holds.grid()->GetCellData()->GetArray("region")->GetComponent(0, 0) == 2147483647.);
  mesh.faces[0].label = 2147483648u;
  VtkOutput faces;
  CHECK_THROWS_AS(export_mesh(mesh, faces), io_error);
  mesh.faces.clear();
  mesh.regions[0] = 3000000000u;
  VtkOutput regions;
  CHECK_THROWS_AS(export_mesh(mesh, regions), io_error);
}

TEST_CASE("a grid that grows has its bounds and ranges anew") {
  MixedMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.add(CellKind::tetrahedron, std::array<index_t, 4>{0, 1, 2, 3});
  mesh.regions = {1};
  mesh.faces = {{{0, 2, 1, no_index}, 1}};
  VtkOutput output;
  export_mesh(mesh, output);
  CHECK(output.grid()->GetBounds()[1] == 1);
  CHECK(output.faces()->GetCellData()->GetArray("patch")->GetRange()[1] == 1);
  const vtkMTimeType before = output.faces()->GetMTime();
  for (Vector3& p : mesh.points) p.x() += 2;
  mesh.regions = {5};
  mesh.faces[0].label = 6;
  export_mesh(mesh, output);
  CHECK(output.grid()->GetBounds()[1] == 3);
  CHECK(output.grid()->GetCellData()->GetArray("region")->GetRange()[1] == 5);
  CHECK(output.faces()->GetCellData()->GetArray("patch")->GetRange()[1] == 6);
  CHECK(output.faces()->GetMTime() > before);
}

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
