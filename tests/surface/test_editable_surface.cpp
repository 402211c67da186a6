// SPDX-License-Identifier: BSL-1.0
#include <catch2/catch.hpp>
#include <random>

#include "framehex/surface/detail/editable_surface.hpp"
#include "framehex/surface/detail/vertex_removal.hpp"
#include "framehex/surface/feature_detection.hpp"
#include "support/surface_checks.hpp"
#include "support/surfaces.hpp"

using namespace framehex;
using detail::EditableSurface;

namespace {

IndexedTriangleMesh living(const EditableSurface& s) {
  IndexedTriangleMesh mesh;
  mesh.points = s.points;
  for (const auto& t : s.corners)
    if (t[0] != no_index) mesh.triangles.push_back(t);
  return mesh;
}

/// The invariants of the structure, each from its definition.
void check_structure(const EditableSurface& s) {
  for (index_t t = 0; t < s.n_triangles(); ++t) {
    if (!s.alive(t)) continue;
    for (index_t h = 3 * t; h < 3 * t + 3; ++h) {
      const index_t g = s.opposite[h];
      REQUIRE(g != no_index);
      REQUIRE(s.alive(g / 3));
      REQUIRE(s.opposite[g] == h);
      REQUIRE(s.from(g) == s.to(h));
      REQUIRE(s.to(g) == s.from(h));
      REQUIRE(s.feature[g] == s.feature[h]);
      if (s.feature[h]) continue;
      REQUIRE(s.patch[g / 3] == s.patch[t]);
      REQUIRE(s.sector[h] == s.sector[EditableSurface::next(g)]);
      REQUIRE(s.sector[EditableSurface::next(h)] == s.sector[g]);
    }
  }
  for (index_t v = 0; v < s.points.size(); ++v) {
    if (s.half_edge_of[v] == no_index) continue;
    REQUIRE(s.alive(s.half_edge_of[v] / 3));
    REQUIRE(s.from(s.half_edge_of[v]) == v);
  }
  (void)make_adjacency(living(s));  // throws unless edge-manifold
}

}  // namespace

TEST_CASE("random edits keep the structure, its sectors and the topology") {
  for (const auto& surface : {test::box_surface({1, 2, 3}, 2, 2, 2), test::torus_surface(1, 0.4, 8, 6),
                              test::l_shape_surface(), test::cylinder_surface(1, 1, 12)}) {
    EditableSurface s{Surface(surface)};
    check_structure(s);
    detail::SectorNormals normals(s, make_adjacency(surface));
    const Observer nobody;
    detail::Pulse pulse(nobody, "");
    detail::VertexRemover remover(s, normals, pulse);
    std::mt19937_64 engine(5);
    const long chi = test::euler_characteristic(surface);
    std::vector<index_t> added;
    for (int edit = 0; edit < 1500; ++edit) {
      index_t h = 0;
      do h = static_cast<index_t>(engine() % s.opposite.size());
      while (!s.alive(h / 3));
      const index_t g = s.opposite[h];
      switch (engine() % 5) {
        case 0: {
          const index_t v = s.add_vertex((s.points[s.from(h)] + s.points[s.to(h)]) / 2);
          const index_t left = normals.add(s, normals.at(h));
          s.split_edge(h, v, left, s.feature[h] ? normals.add(s, normals.at(g)) : left);
          added.push_back(v);
          break;
        }
        case 1: {
          const index_t t = h / 3;
          const index_t v =
              s.add_vertex((s.points[s.corners[t][0]] + s.points[s.corners[t][1]] + s.points[s.corners[t][2]]) / 3);
          s.split_triangle(t, v, normals.add(s, normals.at(h)));
          added.push_back(v);
          break;
        }
        case 2:
          if (!s.feature[h] && !s.joined(s.apex(h), s.apex(g))) s.flip(h);
          break;
        default:
          if (!added.empty()) {
            std::swap(added[engine() % added.size()], added.back());
            if (remover.remove(added.back(), {-2, -1})) added.pop_back();
          }
      }
      if (edit % 50 == 0) check_structure(s);
    }
    check_structure(s);
    CHECK(test::euler_characteristic(living(s)) == chi);
  }
}
