// SPDX-License-Identifier: BSL-1.0
#include "framehex/mesh/boundary.hpp"
#include "framehex/tetrahedralization/flat_tets.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

#include <set>

using namespace framehex;

namespace {

/// A cube of six tetrahedra, all its vertices on the boundary.
IndexedTetMesh cube() {
  return test::kuhn_lattice(1);
}

Surface boundary_of(const IndexedTetMesh& mesh, const FeatureOptions& options = {}) {
  return Surface(extract_boundary(mesh, make_adjacency(mesh)).surface, options);
}

std::set<std::array<index_t, 3>> triangles_of(const Surface& surface) {
  std::set<std::array<index_t, 3>> triangles;
  for (const auto& t : surface.triangles()) triangles.insert(detail::canonical(t));
  return triangles;
}

/// Raises the corners of the upper (z = 1) or lower face that its diagonal does not join, and fills the hollow with a
/// tetrahedron.
void fill_flat(IndexedTetMesh& mesh, double z, double height) {
  const Surface surface = boundary_of(mesh);
  for (index_t h = 0; h < surface.adjacency.opposite.size(); ++h) {
    const TriangleAdjacency& a = surface.adjacency;
    std::array<index_t, 4> v{a.from(h), a.to(h), a.apex(h), a.apex(a.opposite[h])};
    const auto on_face = [&](index_t x) { return std::abs(mesh.points[x].z() - z) < 0.1; };
    if (!std::ranges::all_of(v, on_face)) continue;
    for (const std::size_t i : {2u, 3u}) mesh.points[v[i]].z() += z > 0.5 ? height : -height;
    std::swap(v[2], v[3]);
    if (orientation(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]) < 0)
      std::swap(v[2], v[3]);
    mesh.tets.push_back(v);
    return;
  }
}

std::vector<index_t> numbers(const IndexedTetMesh& mesh) {
  std::vector<index_t> all;
  for (index_t tet = 0; tet < mesh.tets.size(); ++tet) all.push_back(tet);
  return all;
}

}  // namespace

TEST_CASE("flat tetrahedra on a boundary are taken off, and the surface is cut as what is under them", "[regression]") {
  IndexedTetMesh mesh = cube();
  for (const double z : {0.0, 1.0}) fill_flat(mesh, z, 1e-3);
  REQUIRE(mesh.tets.size() == 8);
  IndexedTetMesh plain = mesh;
  plain.tets.resize(6);
  Surface surface = boundary_of(mesh);
  REQUIRE(triangles_of(surface) != triangles_of(boundary_of(plain)));
  TetAdjacency adjacency = make_adjacency(mesh);
  std::vector<index_t> regions = numbers(mesh);
  CHECK(peel_flat_tets(mesh, adjacency, regions, surface, 0.05) == 2);
  CHECK(mesh.tets == plain.tets);
  CHECK(adjacency.neighbours == make_adjacency(plain).neighbours);
  CHECK(regions == numbers(plain));
  CHECK(triangles_of(surface) == triangles_of(boundary_of(plain)));
  const Surface expected = boundary_of(plain);
  CHECK(std::ranges::count(surface.features.is_feature, 1) == std::ranges::count(expected.features.is_feature, 1));
  CHECK(peel_flat_tets(mesh, adjacency, regions, surface, 0.05) == 0);
}

TEST_CASE("a flat tetrahedron stays where its edge is a feature, between patches, or when it is good enough") {
  IndexedTetMesh mesh = cube();
  fill_flat(mesh, 1, 1e-3);
  TetAdjacency adjacency = make_adjacency(mesh);
  std::vector<index_t> regions = numbers(mesh);
  const auto& last = mesh.tets.back();
  FeatureOptions given, labels;
  const Surface plain = boundary_of(mesh);
  for (const auto& t : plain.triangles()) {
    const auto is_in_last = [&](index_t v) { return std::ranges::find(last, v) != last.end(); };
    labels.patches.push_back(std::ranges::all_of(t, is_in_last) ? static_cast<index_t>(labels.patches.size()) : 100);
  }
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < i; ++j) given.given_edges.push_back({last[j], last[i]});
  std::erase_if(given.given_edges, [&](const auto& e) {
    const auto& near = plain.adjacency.vertices_of_vertex[e[0]];
    return std::ranges::find(near, e[1]) == near.end();
  });
  Surface featured = boundary_of(mesh, given), patched = boundary_of(mesh, labels), good = plain;
  CHECK(peel_flat_tets(mesh, adjacency, regions, featured, 0.05) == 0);
  CHECK(peel_flat_tets(mesh, adjacency, regions, patched, 0.05) == 0);
  CHECK(peel_flat_tets(mesh, adjacency, regions, good, 1e-4) == 0);
  CHECK(mesh.tets.size() == 7);
}
