// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/cgal.hpp"
#include "framehex/adapters/cgal_delaunay.hpp"
#include "framehex/mesh/enclosed_volume.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "support/host_reference.hpp"
#include "support/surfaces.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>

#include <set>

using namespace framehex;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

namespace {

std::vector<Kernel::Point_3> lattice_points() {
  std::vector<Kernel::Point_3> points;
  for (int i = 0; i < 64; ++i)
    points.emplace_back(i % 4 + 0.01 * (i * i % 7), i / 4 % 4 + 0.01 * (i * i % 11), i / 16 + 0.01 * (i * i % 13));
  return points;
}

}  // namespace

TEST_CASE("a Delaunay triangulation of CGAL is a mesh: the same candidates as from its arrays") {
  const auto points = lattice_points();
  const CGAL::Delaunay_triangulation_3<Kernel> delaunay(points.begin(), points.end());
  const CgalTriangulation view(delaunay);
  REQUIRE(n_vertices(view) == points.size());
  CHECK_NOTHROW(validate(view));
  const IndexedTetMesh arrays{positions(view), tetrahedra(view)};
  CHECK(arrays.tets.size() == delaunay.number_of_finite_cells());
  const auto candidates = find_potential_hexahedra(view);
  CHECK(candidates.vertices == find_potential_hexahedra(arrays).vertices);
  CHECK(candidates.size() > 0);
  const Recombination result = recombine(view);
  CHECK(verify::is_conforming(result.mesh));

  SurfaceMesh boundary;
  const auto vertex_of = add_boundary(result.mesh, boundary);
  CHECK(boundary.is_valid());
  CHECK(CGAL::is_closed(boundary));
  CHECK(vertex_of.size() == boundary.number_of_vertices());
}

TEST_CASE("a complex of CGAL's mesher, with its subdomains and patches") {
  using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
  using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
  using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
  using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
  // A ball of radius 2 in two halves.
  const auto label = [](const Kernel::Point_3& p) {
    return CGAL::squared_distance(p, Kernel::Point_3(CGAL::ORIGIN)) > 4 ? 0 : p.x() < 0 ? 1 : 2;
  };
  const Domain domain(label, Kernel::Sphere_3({0.3, 0.1, 0}, 9), 1e-4);
  namespace par = CGAL::parameters;
  const Criteria criteria(par::facet_angle = 25, par::facet_size = 0.6, par::facet_distance = 0.05,
                          par::cell_radius_edge_ratio = 2, par::cell_size = 0.6);
  const Complex complex = CGAL::make_mesh_3<Complex>(domain, criteria);
  const CgalComplex view(complex);
  REQUIRE(view.cells.size() > 100);
  CHECK_NOTHROW(validate(view));
  CHECK(std::set<index_t>(view.regions.begin(), view.regions.end()) == std::set<index_t>{1, 2});
  const std::vector<Vector3> points = positions(view);
  std::set<index_t> patches;
  for (const LabelledFace& face : view.faces) {
    patches.insert(face.label);
    for (std::size_t i = 0; i < 3; ++i) {  // (0, 1), (0, 2), (1, 2), whose rim is not sharp
      const Vector3& p = points[face.vertices[i]];
      CHECK((face.label == 2 ? p.x() : p.norm() - 2) == Approx(0).margin(0.3));
    }
  }
  CHECK(patches == std::set<index_t>{0, 1, 2});
  const Recombination result = recombine(view, {.regions = view.regions, .faces = view.faces});
  CHECK(verify::is_conforming(result.mesh));
  CHECK(verify::is_valid(result.mesh));
}

TEST_CASE("Surface_mesh is a surface, without gaps in its numbers") {
  const auto& reference = test::host_reference().mesh;
  const IndexedTriangleMesh surface = extract_boundary(reference, make_adjacency(reference)).surface;
  SurfaceMesh mesh;
  std::vector<SurfaceMesh::Vertex_index> v;
  for (const Vector3& p : surface.points) v.push_back(mesh.add_vertex({p.x(), p.y(), p.z()}));
  for (const auto& t : surface.triangles) mesh.add_face(v[t[0]], v[t[1]], v[t[2]]);
  CHECK(positions(mesh) == surface.points);
  CHECK_NOTHROW(validate_closed(mesh));
  CHECK(enclosed_volume(mesh) == Approx(enclosed_volume(surface)));
  const auto isolated = mesh.add_vertex({9, 9, 9});
  mesh.add_vertex({9, 9, 8});
  mesh.remove_vertex(isolated);
  CHECK_THROWS_AS(validate_closed(mesh), invalid_connectivity);
  mesh.collect_garbage();
  CHECK_NOTHROW(validate_closed(mesh));
}

TEST_CASE("a face of Surface_mesh that is no triangle is refused by its number, not cut to its first corners") {
  // Cut, each quadrilateral of this pillow would be a triangle of a closed surface.
  SurfaceMesh mesh;
  std::vector<SurfaceMesh::Vertex_index> v;
  for (const auto& p : {Kernel::Point_3(0, 0, 0), Kernel::Point_3(1, 0, 0), Kernel::Point_3(0, 1, 0),
                        Kernel::Point_3(0, 0, 1), Kernel::Point_3(0.5, 0.5, 0)})
    v.push_back(mesh.add_vertex(p));
  mesh.add_face(v[0], v[1], v[3]);
  mesh.add_face(v[0], v[2], v[4], v[1]);
  mesh.add_face(v[0], v[3], v[2]);
  mesh.add_face(v[1], v[4], v[2], v[3]);
  try {
    validate_closed(mesh);
    FAIL();
  } catch (const invalid_connectivity& e) {
    CHECK(e.what() == std::string("face 1 is no triangle"));
    CHECK(e.indices() == std::vector<std::size_t>{1});
  }
}

TEST_CASE("CGAL's Delaunay tetrahedra fill surfaces whose triangles are facets of theirs, bent and hollow ones too") {
  IndexedTriangleMesh shell = test::sphere_surface(1, 2);
  const IndexedTriangleMesh hollow = test::sphere_surface(0.6, 2);
  for (const auto& t : hollow.triangles)
    shell.triangles.push_back({t[0] + index_t(shell.points.size()), t[2] + index_t(shell.points.size()),
                               t[1] + index_t(shell.points.size())});
  shell.points.insert(shell.points.end(), hollow.points.begin(), hollow.points.end());
  IndexedTriangleMesh bent = test::sphere_surface(1, 3);
  for (Vector3& p : bent.points) p = {p.x() + 0.4 * p.z() * p.z(), p.y(), p.z()};
  for (const IndexedTriangleMesh& surface : {test::sphere_surface(1, 2), bent, test::tetrahedron_surface(1), shell}) {
    // tetrahedralize() itself compares boundary and volume with the surface's.
    const Tetrahedralization filled = tetrahedralize(CgalDelaunay{}, surface, {});
    CHECK(filled.n_extra_points == 0);
    CHECK(filled.mesh.tets.size() >= surface.triangles.size() / 4);
  }
}

TEST_CASE("a ball filled by CGAL becomes the same kind of mesh as one filled by TetGen") {
  const auto result = mesh_surface(test::sphere_surface(1, 3), ConstantSize{0.25}, CgalDelaunay{});
  CHECK(verify::is_conforming(result.recombination.mesh));
  CHECK(verify::is_valid(result.recombination.mesh));
  const verify::VolumeReport volume = verify::volume(result.recombination.mesh);
  CHECK(volume.by_kind[static_cast<std::size_t>(CellKind::hexahedron)] > 0.6 * volume.cells);
}

TEST_CASE("a triangle that is no facet of the Delaunay tetrahedra is named") {
  // A point before a triangle, inside of its sphere, is nearer to its neighbour beyond the edge.
  IndexedTriangleMesh cube = test::box_surface({1, 1, 1}, 1, 1, 1);
  std::size_t n_refused = 0;
  for (const double x : {0.5, 0.2, 0.8}) {
    const std::vector<Vector3> inside{{x, 0.4, 1e-3}, {0.3, x, 0.999}};
    try {
      tetrahedralize(CgalDelaunay{}, cube, inside);
    } catch (const tetrahedralization_error& e) {
      ++n_refused;
      REQUIRE(e.indices().size() == 3);
      const std::array<index_t, 3> named{index_t(e.indices()[0]), index_t(e.indices()[1]), index_t(e.indices()[2])};
      CHECK(std::count(cube.triangles.begin(), cube.triangles.end(), named) == 1);
    }
  }
  CHECK(n_refused > 0);
  const auto stop = [](const Progress&) { return false; };
  CHECK(CgalDelaunay{}({cube.points, 8, cube.triangles, stop}).status == Status::cancelled);
}
