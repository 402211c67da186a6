// SPDX-License-Identifier: BSL-1.0
//
//     closed_surface SURFACE
//
// Exits with 0 when CGAL calls the surface closed, manifold and free of self-intersections, with 1 when it does not, with 2 when
// it cannot read it: what campaign.py asks about surfaces that were refused.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <iostream>
#include <vector>

int main(int argc, char** argv) {
  using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
  namespace pmp = CGAL::Polygon_mesh_processing;
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> polygons;
  if (argc != 2 || !CGAL::IO::read_polygon_soup(argv[1], points, polygons) || polygons.empty()) return 2;
  const auto is_unsound = [](const char* why) {
    std::cout << why << '\n';
    return 1;
  };
  pmp::merge_duplicate_points_in_polygon_soup(points, polygons);
  if (!pmp::orient_polygon_soup(points, polygons)) return is_unsound("not manifold");
  CGAL::Surface_mesh<Point> mesh;
  pmp::polygon_soup_to_polygon_mesh(points, polygons, mesh);
  if (!CGAL::is_closed(mesh)) return is_unsound("open");
  if (pmp::does_self_intersect(mesh)) return is_unsound("crosses itself");
  return 0;
}
