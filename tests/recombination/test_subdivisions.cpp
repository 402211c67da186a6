// SPDX-License-Identifier: BSL-1.0
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "support/hexahedron_subdivisions.hpp"

#include <catch2/catch.hpp>

#include <boost/random/uniform_int_distribution.hpp>

#include <numeric>
#include <random>

using namespace framehex;

namespace {

using test::Subdivision;
using test::SubdivisionEnumerator;

/// The cube with corners and tetrahedra numbered at random. Not every subdivision has tetrahedra of positive volume on
/// the corners of a cube, but the search asks for their connectivity and for the volume of the hexahedron only.
IndexedTetMesh shuffled_cube(const Subdivision& subdivision, std::mt19937_64& engine) {
  static const std::array<Vector3, 8> cube{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(1, 1, 0), Vector3(0, 1, 0),
                                           Vector3(0, 0, 1), Vector3(1, 0, 1), Vector3(1, 1, 1), Vector3(0, 1, 1)};
  std::array<index_t, 8> number{};
  std::iota(number.begin(), number.end(), 0u);
  const auto shuffle = [&engine](auto& values) {
    for (std::size_t i = values.size(); i > 1; --i)
      std::swap(values[i - 1], values[boost::random::uniform_int_distribution<std::size_t>(0, i - 1)(engine)]);
  };
  shuffle(number);
  IndexedTetMesh mesh;
  mesh.points.resize(8);
  for (std::size_t i = 0; i < 8; ++i) mesh.points[number[i]] = cube[i];
  for (const auto& tet : subdivision) {
    auto& t = mesh.tets.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) t[i] = number[static_cast<std::size_t>(tet[i])];
  }
  shuffle(mesh.tets);
  return mesh;
}

/// Turns the tetrahedra so that each facet inside is used from both sides and the boundary looks outward.
void orient(IndexedTetMesh& mesh) {
  const TetAdjacency adjacency = make_adjacency(mesh);
  // A boundary facet shows which way is out: the cube is convex.
  const Vector3 centre(0.5, 0.5, 0.5);
  std::vector<bool> done(mesh.tets.size(), false);
  std::vector<index_t> stack;
  for (std::size_t first = 0; first < mesh.tets.size() && stack.empty(); ++first)
    for (std::size_t i = 0; i < 4 && stack.empty(); ++i)
      if (adjacency.neighbours[first][i] == no_index) {
        const auto f = facet(mesh.tets[first], static_cast<int>(i));
        const auto& p = mesh.points;
        if ((p[f[1]] - p[f[0]]).cross(p[f[2]] - p[f[0]]).dot(p[f[0]] - centre) < 0)
          std::swap(mesh.tets[first][2], mesh.tets[first][3]);
        stack.push_back(static_cast<index_t>(first));
        done[first] = true;
      }
  const auto has = [](const std::array<index_t, 4>& tet, std::array<index_t, 3> f) {
    for (int i = 0; i < 4; ++i)
      for (std::size_t turn = 0; turn < 3; ++turn) {
        std::rotate(f.begin(), f.begin() + 1, f.end());
        if (facet(tet, i) == f) return true;
      }
    return false;
  };
  while (!stack.empty()) {
    const index_t t = stack.back();
    stack.pop_back();
    for (int i = 0; i < 4; ++i)
      for (index_t s = 0; s < mesh.tets.size(); ++s) {
        const auto f = facet(mesh.tets[t], i);
        if (done[s] ||
            std::ranges::any_of(f, [&](index_t v) { return std::ranges::find(mesh.tets[s], v) == mesh.tets[s].end(); }))
          continue;
        if (!has(mesh.tets[s], {f[0], f[2], f[1]})) std::swap(mesh.tets[s][2], mesh.tets[s][3]);
        done[s] = true;
        stack.push_back(s);
      }
  }
  REQUIRE(std::ranges::all_of(done, [](bool d) { return d; }));
}

}  // namespace

TEST_CASE("All 174 subdivisions of the hexahedron are found, each once, however labelled") {
  const auto symmetries = SubdivisionEnumerator::symmetries();
  std::map<std::size_t, std::size_t> n_labelled, n_classes;
  std::set<Subdivision> classes, seen;
  for (const Subdivision& s : SubdivisionEnumerator().up_to_symmetry()) {
    if (seen.count(s)) continue;
    std::set<Subdivision> orbit;
    for (const auto& map : symmetries) orbit.insert(SubdivisionEnumerator::image(s, map));
    n_labelled[s.size()] += orbit.size();
    ++n_classes[s.size()];
    classes.insert(s);
    seen.merge(orbit);
  }
  using Counts = std::map<std::size_t, std::size_t>;
  CHECK(n_labelled == Counts{{5, 2},
                             {6, 72},
                             {7, 132},
                             {8, 312},
                             {9, 552},
                             {10, 852},
                             {11, 1396},
                             {12, 1348},
                             {13, 1164},
                             {14, 840},
                             {15, 296}});
  CHECK(n_classes ==
        Counts{{5, 1}, {6, 5}, {7, 5}, {8, 7}, {9, 13}, {10, 20}, {11, 35}, {12, 30}, {13, 28}, {14, 19}, {15, 11}});
  CHECK(classes.size() == 174);

  std::mt19937_64 engine(174);
  for (const Subdivision& s : classes) {
    for (int sample = 0; sample < 8; ++sample) {
      const auto& map = symmetries[boost::random::uniform_int_distribution<std::size_t>(0, 47)(engine)];
      IndexedTetMesh mesh = shuffled_cube(SubdivisionEnumerator::image(s, map), engine);
      orient(mesh);
      // The floor leaves out other hexahedra on the same corners, such as the cube with its top turned by a quarter.
      const auto found = find_potential_hexahedra(mesh, {.quality_floor = 0.9, .input_check = InputCheck::skip});
      REQUIRE(found.size() == 1);
      CHECK(found.tets[0].size() == mesh.tets.size());
      CHECK(found.face_slivers[0].empty());
      CHECK(found.quality[0] == Approx(1));
      CHECK(found.volume[0] == Approx(1));
    }
  }
}
