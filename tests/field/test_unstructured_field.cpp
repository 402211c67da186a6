// SPDX-License-Identifier: BSL-1.0
//
// Singular lines of the best field on unstructured meshes, whose edges of all lengths and directions are harder than a
// lattice's.
#include "framehex/field/compute_frame_field.hpp"
#include "support/surfaces.hpp"
#include "support/unstructured.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace framehex;

namespace {

/// Meshes inside a surface, turned at random.
IndexedTetMesh fill_turned(IndexedTriangleMesh surface, double volume, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const auto number = [&] { return static_cast<double>(engine() >> 11) * 0x1p-52 - 1; };
  const Quaternion turn = Quaternion(number(), number(), number(), number()).normalized();
  for (Vector3& p : surface.points) p = turn * p;
  return test::filled(std::move(surface), volume);
}

/// Lines of index 1/4 with both ends on the boundary.
std::size_t lines_across(const SingularGraph& graph) {
  std::size_t n = 0;
  for (std::size_t c = 0; c < graph.curves.size(); ++c)
    n += graph.curve_index[c] == 0.25 && graph.facets[graph.curves[c].front()].tets[1] == no_index &&
         graph.facets[graph.curves[c].back()].tets[1] == no_index;
  return n;
}

}  // namespace

TEST_CASE("an unstructured cylinder has four singular lines from lid to lid, at any density and in any direction") {
  std::uint64_t seed = 0;
  for (const index_t rings : {3U, 4U, 5U, 6U, 7U})
    for (const auto& [volume, n_directions] : {std::pair{4e-3, 12}, {2e-3, 3}, {5e-4, 3}})  // the coarsest is hardest
      for (int direction = 0; direction < n_directions; ++direction) {
        const IndexedTetMesh mesh = fill_turned(test::ringed_cylinder_surface(0.5, 2, rings), volume, ++seed);
        CAPTURE(rings, volume, seed, mesh.tets.size());
        const SingularGraph graph = compute_frame_field(mesh).singular_graph();
        CHECK(lines_across(graph) == 4);
        CHECK(graph.curves.size() == 4);
        CHECK(graph.boundary_facets.size() == 8);
      }
}

TEST_CASE("an unstructured ball has eight singular points, and a cube none, at any density and in any direction") {
  std::uint64_t seed = 100;
  for (const int levels : {2, 3})
    for (const double volume : {1e-3, 2e-4}) {
      const IndexedTetMesh mesh = fill_turned(test::sphere_surface(0.5, levels), volume, ++seed);
      CAPTURE(levels, volume, mesh.tets.size());
      const SingularGraph graph = compute_frame_field(mesh).singular_graph();
      CHECK(graph.boundary_facets.size() == 8);
      for (const index_t f : graph.boundary_facets) CHECK(graph.facets[f].index == 0.25);
    }
  for (const int n : {3, 7}) {
    const IndexedTetMesh mesh = fill_turned(test::box_surface(Vector3::Ones(), n, n, n), 1e-3, ++seed);
    CHECK(compute_frame_field(mesh).singular_graph().facets.empty());
  }
}
