// SPDX-License-Identifier: BSL-1.0
// VTK's Delaunay tetrahedra of a bent lattice of points, recombined into a grid that VTK writes.
#include <framehex/adapters/vtk.hpp>
#include <framehex/pipeline/recombine_into.hpp>

#include <vtkDelaunay3D.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <cstdio>

int main() {
  vtkNew<vtkPoints> points;
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i) points->InsertNextPoint(i + 0.02 * j * k, j + 0.03 * k, k + 0.04 * i);
  vtkNew<vtkPolyData> cloud;
  cloud->SetPoints(points);
  vtkNew<vtkDelaunay3D> delaunay;
  delaunay->SetInputData(cloud);
  delaunay->Update();

  framehex::VtkOutput output;
  framehex::recombine_into(output, framehex::VtkTets(*delaunay->GetOutput()));
  std::printf("%lld tetrahedra became %lld cells\n", static_cast<long long>(delaunay->GetOutput()->GetNumberOfCells()),
              static_cast<long long>(output.grid()->GetNumberOfCells()));
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetFileName("vtk.vtu");
  writer->SetInputData(output.grid());
  writer->Write();
}
