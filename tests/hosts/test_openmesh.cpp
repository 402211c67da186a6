// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/openmesh.hpp"
#include "framehex/mesh/enclosed_volume.hpp"
#include "support/host_reference.hpp"

using namespace framehex;

namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};
struct OwnMesh : OpenMesh::TriMesh_ArrayKernelT<DoubleTraits> {};

OwnMesh copy_of(const IndexedTriangleMesh& surface) {
  OwnMesh mesh;
  std::vector<OpenMesh::VertexHandle> v;
  for (const Vector3& p : surface.points) v.push_back(mesh.add_vertex(OpenMesh::Vec3d(p.x(), p.y(), p.z())));
  for (const auto& t : surface.triangles) mesh.add_face(v[t[0]], v[t[1]], v[t[2]]);
  return mesh;
}

IndexedTriangleMesh reference_surface() {
  const auto& mesh = test::host_reference().mesh;
  return extract_boundary(mesh, make_adjacency(mesh)).surface;
}

}  // namespace

TEST_CASE("OpenMesh is a surface") {
  const IndexedTriangleMesh surface = reference_surface();
  const OwnMesh mesh = copy_of(surface);
  CHECK(positions(mesh) == surface.points);
  auto found = triangles(mesh), expected = surface.triangles;
  for (auto* list : {&found, &expected})
    for (auto& t : *list) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  CHECK(found == expected);
  CHECK_NOTHROW(validate_closed(mesh));
}

TEST_CASE("OpenMesh with deleted vertices is refused until they are collected") {
  OwnMesh mesh = copy_of(reference_surface());
  const auto isolated = mesh.add_vertex(OpenMesh::Vec3d(0, 0, 0));
  mesh.add_vertex(OpenMesh::Vec3d(0, 0, 1));
  mesh.delete_vertex(isolated);
  try {
    validate_closed(mesh);
    FAIL();
  } catch (const invalid_connectivity& e) {
    CHECK(std::string(e.what()).find("garbage_collection()") != std::string::npos);
    CHECK(e.indices() == std::vector<std::size_t>{static_cast<std::size_t>(isolated.idx())});
  }
  mesh.garbage_collection();
  CHECK_NOTHROW(validate_closed(mesh));
}

TEST_CASE("OpenMesh takes the boundary of a result, with its quadrilaterals") {
  const MixedMesh& result = test::host_reference().result.mesh;
  OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits> boundary;
  const auto vertex_of = add_boundary(result, boundary);
  CHECK(boundary.n_faces() == faces_used_once(result).size());
  REQUIRE(boundary.n_vertices() == vertex_of.size());
  for (const auto v : boundary.vertices()) {
    CHECK_FALSE(boundary.is_boundary(v));
    const auto& p = boundary.point(v);
    CHECK(Vector3(p[0], p[1], p[2]) == result.points[vertex_of[static_cast<std::size_t>(v.idx())]]);
  }
  CHECK(static_cast<int>(boundary.n_vertices() + boundary.n_faces()) - static_cast<int>(boundary.n_edges()) == 2);
}

TEST_CASE("OpenMesh refuses a boundary that touches itself, by name") {
  MixedMesh mesh;  // two tetrahedra with a common edge
  mesh.points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  mesh.add(CellKind::tetrahedron, std::array<index_t, 4>{0, 2, 3, 1});
  mesh.add(CellKind::tetrahedron, std::array<index_t, 4>{0, 4, 5, 1});
  OpenMesh::PolyMesh_ArrayKernelT<> boundary;
  CHECK_THROWS_AS(add_boundary(mesh, boundary), nonmanifold);
}
