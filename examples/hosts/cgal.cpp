// SPDX-License-Identifier: BSL-1.0
// A Delaunay triangulation of CGAL, recombined; the boundary of the result as a Surface_mesh.
#include <framehex/adapters/cgal.hpp>
#include <framehex/io/vtu_writer.hpp>
#include <framehex/pipeline/recombine.hpp>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <cstdio>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

int main() {
  std::vector<Kernel::Point_3> points;
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i) points.emplace_back(i + 0.02 * j * k, j + 0.03 * k, k + 0.04 * i);
  const CGAL::Delaunay_triangulation_3<Kernel> delaunay(points.begin(), points.end());

  const framehex::CgalTriangulation tets(delaunay);
  const auto result = framehex::recombine(tets);
  CGAL::Surface_mesh<Kernel::Point_3> boundary;
  framehex::add_boundary(result.mesh, boundary);
  std::printf("%zu tetrahedra became %zu cells; the boundary has %zu faces\n", tets.cells.size(), result.mesh.n_cells(),
              static_cast<std::size_t>(boundary.number_of_faces()));
  framehex::write_vtu("cgal.vtu", result.mesh);
}
