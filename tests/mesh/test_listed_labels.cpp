// SPDX-License-Identifier: BSL-1.0
#include "framehex/mesh/listed_labels.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>
#include <set>

using namespace framehex;

namespace {

/// A lattice of tetrahedra in two regions, with every facet and every edge listed.
MixedMesh lattice_with_everything(const IndexedTetMesh& lattice, int n) {
  MixedMesh mesh{.points = lattice.points, .kinds = {}, .cells = {}, .regions = {}, .faces = {}, .edges = {}};
  std::set<std::array<index_t, 3>> facets;
  std::set<std::array<index_t, 2>> edges;
  for (const auto& tet : lattice.tets) {
    mesh.add(CellKind::tetrahedron, tet);
    Vector3 centre = Vector3::Zero();
    for (const index_t v : tet) centre += lattice.points[v] / 4;
    mesh.regions.push_back(centre.x() * 2 < n ? 0 : 1);
    for (std::size_t i = 0; i < 4; ++i) {
      facets.insert(detail::sorted(facet(tet, static_cast<int>(i))));
      for (std::size_t j = 0; j < i; ++j) edges.insert({std::min(tet[i], tet[j]), std::max(tet[i], tet[j])});
    }
  }
  for (const auto& f : facets) mesh.faces.push_back({{f[0], f[1], f[2], no_index}, 0});
  for (const auto& e : edges) mesh.edges.push_back({e, 0});
  return mesh;
}

}  // namespace

TEST_CASE("of faces and edges that are all listed those stay that bound something", "[regression]") {
  constexpr int n = 4;
  const IndexedTetMesh lattice = test::kuhn_lattice(n);
  const TetAdjacency adjacency = make_adjacency(lattice);
  const MixedMesh everything = lattice_with_everything(lattice, n);
  MixedMesh mesh = everything;
  const ListedLabels found = drop_listed_labels(mesh, adjacency);
  CHECK((found.all_faces && found.all_edges));
  // Six sides and the plane between the regions, two triangles a square.
  CHECK(mesh.faces.size() == 7 * 2 * n * n);
  CHECK(found.n_faces == everything.faces.size() - mesh.faces.size());
  // Twelve edges of the cube, and four where the plane meets its sides: there three facets meet.
  CHECK(mesh.edges.size() == 16 * n);
  const auto extreme = [&](double x) { return x == 0 || x == n; };
  for (const auto& edge : mesh.edges) {
    const Vector3 middle = (mesh.points[edge.vertices[0]] + mesh.points[edge.vertices[1]]) / 2;
    CHECK(extreme(middle.x()) + extreme(middle.y()) + extreme(middle.z()) + (2 * middle.x() == n) == 2);
  }

  // One facet or one edge that is not listed: the others are meant.
  mesh = everything;
  const auto inner = std::find_if(mesh.faces.begin(), mesh.faces.end(), [&](const LabelledFace& face) {
    return !detail::BoundingFacets(adjacency, mesh.regions).contains(face);
  });
  mesh.faces.erase(inner);
  mesh.edges.erase(mesh.edges.begin());
  const std::size_t n_faces = mesh.faces.size(), n_edges = mesh.edges.size();
  const ListedLabels meant = drop_listed_labels(mesh, adjacency);
  CHECK((!meant.all_faces && !meant.all_edges && mesh.faces.size() == n_faces && mesh.edges.size() == n_edges));
  CHECK(drop_inner_faces(mesh, adjacency) == n_faces - 7 * 2 * n * n);

  // Labels of patches make curves where nothing is bent.
  mesh = everything;
  for (LabelledFace& face : mesh.faces) {
    double y = 0;
    for (std::size_t i = 0; i < 3; ++i) y += mesh.points[face.vertices[i]].y() / 3;
    face.label = y < n / 2 ? 0 : 1;
  }
  drop_listed_labels(mesh, adjacency);
  CHECK(mesh.edges.size() == (16 + 5) * n);
}
