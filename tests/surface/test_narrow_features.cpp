// SPDX-License-Identifier: BSL-1.0
#include "framehex/mesh/enclosed_volume.hpp"
#include "framehex/surface/narrow_features.hpp"
#include "framehex/surface/self_intersection.hpp"
#include "support/surfaces.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace framehex;

namespace {

using Profile = std::vector<Eigen::Vector2d>;  // radius and height, from the axis at the bottom to the axis at the top

/// A body of revolution with n facets around.
IndexedTriangleMesh revolved(const Profile& profile, index_t n) {
  IndexedTriangleMesh mesh;
  const auto rings = static_cast<index_t>(profile.size()) - 2;
  for (index_t r = 1; r <= rings; ++r)
    for (index_t i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      mesh.points.emplace_back(profile[r][0] * std::cos(angle), profile[r][0] * std::sin(angle), profile[r][1]);
    }
  const index_t bottom = rings * n, top = bottom + 1;
  mesh.points.emplace_back(0, 0, profile.front()[1]);
  mesh.points.emplace_back(0, 0, profile.back()[1]);
  for (index_t i = 0; i < n; ++i) {
    const index_t j = (i + 1) % n;
    mesh.triangles.push_back({bottom, j, i});
    for (index_t r = 0; r + 1 < rings; ++r) {
      mesh.triangles.push_back({r * n + i, r * n + j, (r + 1) * n + j});
      mesh.triangles.push_back({r * n + i, (r + 1) * n + j, (r + 1) * n + i});
    }
    mesh.triangles.push_back({(rings - 1) * n + i, (rings - 1) * n + j, top});
  }
  return mesh;
}

/// A surface closed in itself has each half edge once in either direction.
void check_closed(const IndexedTriangleMesh& mesh) {
  const TriangleAdjacency adjacency = make_adjacency(mesh);
  for (const index_t opposite : adjacency.opposite) CHECK(opposite != no_index);
  CHECK(find_self_intersections(mesh).empty());
}

bool same(const IndexedTriangleMesh& a, const IndexedTriangleMesh& b) {
  return a.points == b.points && a.triangles == b.triangles;
}

}  // namespace

TEST_CASE("a ledge narrower than asked goes, a wider one stays") {
  const double ledge = 0.01;
  const Profile stacked{{0, 0}, {1, 0}, {1, 1}, {1 - ledge, 1}, {1 - ledge, 2}, {0, 2}};
  const IndexedTriangleMesh with = revolved(stacked, 24);
  CHECK(same(merge_narrow_features(with, 0.9 * ledge).surface, with));

  const MergedFeatures without = merge_narrow_features(with, 1.1 * ledge);
  CHECK(without.n_merged == 24);
  CHECK(without.surface.points.size() == with.points.size() - 24);
  CHECK(without.surface.triangles.size() == with.triangles.size() - 48);
  check_closed(without.surface);
  CHECK(std::abs(enclosed_volume(without.surface) - enclosed_volume(with)) < ledge * 2 * std::numbers::pi);
  for (std::size_t t = 0; t < without.parent.size(); ++t) {
    const auto& old = with.triangles[without.parent[t]];
    for (std::size_t i = 0; i < 3; ++i)
      CHECK((without.surface.points[without.surface.triangles[t][i]] - with.points[old[i]]).norm() < 1.1 * ledge);
  }
}

TEST_CASE("steps and grooves go as ledges do") {
  const Profile groove{{0, 0}, {1, 0}, {1, 1}, {0.995, 1}, {0.995, 1.004}, {1, 1.004}, {1, 2}, {0, 2}};
  const MergedFeatures merged = merge_narrow_features(revolved(groove, 30), 0.01);
  CHECK(merged.n_merged >= 60);
  check_closed(merged.surface);
  CHECK(enclosed_volume(merged.surface) == Approx(15 * std::sin(2 * std::numbers::pi / 30) * 2).epsilon(0.01));
}

TEST_CASE("thin sheets and slender bodies stay, and what is finer than that everywhere") {
  const double thin = 1e-4;
  for (const IndexedTriangleMesh& mesh :
       {test::box_surface({1, 2, thin}), test::box_surface({thin, thin, 1}), test::sphere_surface(thin, 4)})
    CHECK(same(merge_narrow_features(mesh, 100 * thin).surface, mesh));
}

TEST_CASE("a hole narrower than asked keeps its place and stays a hole") {
  const IndexedTriangleMesh tube = test::tube_surface(1e-3, 1, 1, 24);
  const MergedFeatures merged = merge_narrow_features(tube, 0.01);
  check_closed(merged.surface);
  const TriangleAdjacency adjacency = make_adjacency(merged.surface);
  CHECK(merged.surface.points.size() + merged.surface.triangles.size() == adjacency.opposite.size() / 2);  // a torus
  CHECK(enclosed_volume(merged.surface) == Approx(enclosed_volume(tube)).epsilon(1e-4));
}

TEST_CASE("rims stay") {
  IndexedTriangleMesh open = test::box_surface({1, 1, 1});
  open.triangles.resize(10);
  CHECK(same(merge_narrow_features(open, 0.5).surface, open));
}
