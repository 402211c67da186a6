// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/boundary.hpp"
#include "framehex/mesh/mixed_output.hpp"
#include "framehex/pipeline/recombine.hpp"
#include "framehex/verify/validity.hpp"

#include <catch2/catch.hpp>

/// What every host's mesh is compared with: one mesh, its candidates and its result, made from flat arrays.
namespace framehex::test {

/// A lattice of 4 x 3 x 3 cubes in two regions, x < 2 and beyond, none of its points in line by a shear. Labelled edges through
/// some cubes keep them from being hexahedra, so that the result has cells of all kinds.
struct HostReference {
  IndexedTetMesh mesh;
  std::vector<index_t> regions;
  std::vector<LabelledFace> faces;  ///< of the side x = 0, label 7
  std::vector<LabelledEdge> edges;  ///< diagonals, label 2
  PotentialHexahedra candidates;
  Recombination result;  ///< with regions, faces, edges and a group of each
};
const HostReference& host_reference();

/// A host's mesh has the points, tetrahedra and candidates of the reference. @pre in the order of the reference.
template <TetMesh Host>
void check_host(const Host& host) {
  const HostReference& reference = host_reference();
  CHECK(positions(host) == reference.mesh.points);
  REQUIRE(n_vertices(host) == reference.mesh.points.size());
  auto tets = tetrahedra(host);
  auto expected = reference.mesh.tets;
  REQUIRE(tets.size() == expected.size());
  for (auto* list : {&tets, &expected})
    for (auto& t : *list) std::sort(t.begin(), t.end());
  CHECK(tets == expected);
  CHECK_NOTHROW(validate(host));
  CHECK(find_potential_hexahedra(host).vertices == reference.candidates.vertices);
}

/// What came back from a host is the reference's result: the same cells, valid and conforming.
inline void check_same_cells(const MixedMesh& back, const MixedMesh& expected) {
  REQUIRE(back.points == expected.points);
  REQUIRE(back.n_cells() == expected.n_cells());
  using Cell = std::pair<CellKind, std::vector<index_t>>;
  const auto sorted_cells = [](const MixedMesh& mesh) {
    std::vector<Cell> cells;
    for (std::size_t c = 0; c < mesh.n_cells(); ++c)
      cells.emplace_back(mesh.kinds[c], std::vector<index_t>(mesh.cells[c].begin(), mesh.cells[c].end()));
    std::sort(cells.begin(), cells.end());
    return cells;
  };
  CHECK(sorted_cells(back) == sorted_cells(expected));
  CHECK(verify::is_conforming(back));
  CHECK(verify::is_valid(back));
  CHECK(verify::volume(back).cells == Approx(verify::volume(expected).cells));
}

}  // namespace framehex::test
