// SPDX-License-Identifier: BSL-1.0
// Libraries that Debian does not have, by stand-ins with their names and their numbering.
#include "framehex/adapters/geogram.hpp"
#include "framehex/adapters/openvolumemesh.hpp"
#include "framehex/mesh/enclosed_volume.hpp"
#include "support/host_reference.hpp"

using namespace framehex;

namespace {

GEO::Mesh geogram_copy() {
  GEO::Mesh mesh;
  for (const Vector3& p : test::host_reference().mesh.points) {
    const GEO::index_t v = mesh.vertices.create_vertex();
    std::copy_n(p.data(), 3, mesh.vertices.point_ptr(v));
  }
  for (const auto& t : test::host_reference().mesh.tets) mesh.cells.create_tet(t[0], t[1], t[2], t[3]);
  return mesh;
}

/// The faces of Geogram's cells, looking inward, as its documentation numbers them.
const std::vector<std::vector<GEO::index_t>>& geogram_faces(GEO::MeshCellType type) {
  static const std::vector<std::vector<GEO::index_t>> tet{{1, 3, 2}, {0, 2, 3}, {3, 1, 0}, {0, 1, 2}},
      hex{{0, 2, 6, 4}, {3, 1, 5, 7}, {1, 0, 4, 5}, {2, 3, 7, 6}, {1, 3, 2, 0}, {4, 6, 7, 5}},
      prism{{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {0, 2, 5, 3}, {1, 4, 5, 2}},
      pyramid{{0, 1, 2, 3}, {0, 4, 1}, {0, 3, 4}, {2, 4, 3}, {2, 1, 4}};
  switch (type) {
    case GEO::MESH_TET: return tet;
    case GEO::MESH_HEX: return hex;
    case GEO::MESH_PRISM: return prism;
    default: return pyramid;
  }
}

/// Faces by their vertices from the least on, sorted: equal for equal oriented polyhedra.
using Faces = std::vector<std::vector<index_t>>;
Faces canonical(Faces faces) {
  for (auto& face : faces) std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  std::sort(faces.begin(), faces.end());
  return faces;
}

Faces inward_faces(const MixedMesh& mesh, std::size_t cell) {
  Faces faces;
  for (const LocalFace& face : faces_of(mesh.kinds[cell])) {
    faces.emplace_back();
    for (int i = face.size() - 1; i >= 0; --i)
      faces.back().push_back(mesh.cells[cell][static_cast<std::size_t>(face.corners[static_cast<std::size_t>(i)])]);
  }
  return canonical(std::move(faces));
}

OpenVolumeMesh::Vec3d to_vec(const Vector3& p) {
  return {p.x(), p.y(), p.z()};
}

}  // namespace

TEST_CASE("Geogram's cells are a tetrahedral mesh") {
  GEO::Mesh mesh = geogram_copy();
  test::check_host(GeogramTets(mesh));
  mesh.cells.create_pyramid(0, 1, 2, 3, 4);
  CHECK_THROWS_AS(GeogramTets(mesh), invalid_connectivity);
}

TEST_CASE("Geogram's facets are a surface") {
  GEO::Mesh mesh = geogram_copy();
  const auto boundary = extract_boundary(test::host_reference().mesh, make_adjacency(test::host_reference().mesh));
  for (const auto& t : boundary.surface.triangles)
    mesh.facets.create_triangle(boundary.vertex_of[t[0]], boundary.vertex_of[t[1]], boundary.vertex_of[t[2]]);
  CHECK(triangles(GeogramTriangles(mesh)).size() == boundary.surface.triangles.size());
  CHECK(enclosed_volume(GeogramTriangles(mesh)) == Approx(enclosed_volume(boundary.surface)));
  mesh.facets.create_quad(0, 1, 2, 3);
  CHECK_THROWS_AS(GeogramTriangles(mesh), invalid_connectivity);
}

TEST_CASE("Geogram takes the result back, its cells seen from inside as its tables tell") {
  const MixedMesh& expected = test::host_reference().result.mesh;
  GEO::Mesh mesh;
  GeogramOutput output(mesh);
  export_mesh(expected, output);
  REQUIRE(mesh.cells.nb() == expected.n_cells());
  REQUIRE(mesh.vertices.nb() == expected.points.size());
  for (GEO::index_t c = 0; c < mesh.cells.nb(); ++c) {
    Faces faces;
    for (const auto& face : geogram_faces(mesh.cells.type(c))) {
      faces.emplace_back();
      for (const GEO::index_t lv : face) faces.back().push_back(mesh.cells.vertex(c, lv));
    }
    CHECK(canonical(faces) == inward_faces(expected, c));
  }
}

TEST_CASE("OpenVolumeMesh is a tetrahedral mesh, in whatever order it lists corners") {
  OpenVolumeMesh::GeometricTetrahedralMeshV3d mesh;
  std::vector<OpenVolumeMesh::VertexHandle> v;
  for (const Vector3& p : test::host_reference().mesh.points) v.push_back(mesh.add_vertex(to_vec(p)));
  bool mirrored = false;
  for (const auto& t : test::host_reference().mesh.tets) {
    if (mirrored)
      mesh.add_cell({v[t[1]], v[t[0]], v[t[2]], v[t[3]]});
    else
      mesh.add_cell({v[t[0]], v[t[1]], v[t[2]], v[t[3]]});
    mirrored = !mirrored;
  }
  test::check_host(mesh);
}

TEST_CASE("OpenVolumeMesh takes the result back, with shared faces that look inward") {
  const MixedMesh& expected = test::host_reference().result.mesh;
  OpenVolumeMesh::GeometricPolyhedralMeshV3d mesh;
  OpenVolumeMeshOutput output(mesh);
  export_mesh(expected, output);
  REQUIRE(mesh.n_cells() == expected.n_cells());
  CHECK(mesh.n_faces() == make_face_table(expected).n_groups());
  for (std::size_t c = 0; c < expected.n_cells(); ++c) {
    Faces faces;
    for (const auto& halfface : mesh.halffaces(OpenVolumeMesh::CellHandle(static_cast<int>(c)))) {
      faces.emplace_back();
      for (const auto v : halfface) faces.back().push_back(static_cast<index_t>(v.idx()));
    }
    CHECK(canonical(faces) == inward_faces(expected, c));
  }
}
