// SPDX-License-Identifier: BSL-1.0
#include "framehex/verify/solver_quality.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

namespace {

/// n^3 unit cubes, their corners moved by `map`.
template <class Map>
MixedMesh cubes(index_t n, Map&& map) {
  MixedMesh mesh;
  for (index_t k = 0; k <= n; ++k)
    for (index_t j = 0; j <= n; ++j)
      for (index_t i = 0; i <= n; ++i) mesh.points.push_back(map(Vector3(i, j, k)));
  const auto at = [&](index_t i, index_t j, index_t k) { return i + (n + 1) * (j + (n + 1) * k); };
  for (index_t k = 0; k < n; ++k)
    for (index_t j = 0; j < n; ++j)
      for (index_t i = 0; i < n; ++i)
        mesh.add(CellKind::hexahedron, std::array<index_t, 8>{at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k),
                                                              at(i, j + 1, k), at(i, j, k + 1), at(i + 1, j, k + 1),
                                                              at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)});
  return mesh;
}

}  // namespace

TEST_CASE("cubes are what solvers like best") {
  const verify::SolverQuality q = verify::solver_quality(cubes(3, [](Vector3 p) { return p; }));
  CHECK(q.non_orthogonality == Approx(0).margin(1e-7));
  CHECK(q.flatness == Approx(1));
  CHECK(q.volume_ratio == Approx(1));
  CHECK(q.weight == Approx(0.5));
  // Half a unit square, and the centre half a unit above it: 6 volumes are 1/2, the longest edge is the diagonal.
  CHECK(q.decomposition == Approx(0.5 / 2));
  // A corner has one inner face in each direction, where the cube inside has two.
  CHECK(q.determinant == Approx(1.0 / 8));
  CHECK((q.lonely.empty() && q.small_determinant.empty() && q.bad_decomposition.empty() && q.small_weight.empty()));
}

TEST_CASE("shear is the angle off the normal, stretch the ratio of volumes, warp what is lost of the area") {
  for (const double angle : {0.1, 0.5, 1.2}) {
    const auto shear = [&](Vector3 p) { return Vector3(p.x() + std::tan(angle) * p.y(), p.y(), p.z()); };
    CHECK(verify::solver_quality(cubes(2, shear)).non_orthogonality == Approx(angle));
  }
  const auto stretch = [](Vector3 p) { return Vector3(p.x() < 1.5 ? p.x() : 1 + 5 * (p.x() - 1), p.y(), p.z()); };
  CHECK(verify::solver_quality(cubes(2, stretch)).volume_ratio == Approx(0.2));
  CHECK(verify::solver_quality(cubes(2, stretch)).weight == Approx(0.5 / (0.5 + 2.5)));
  // Centres at half a unit, and at half of 20 units, from the faces between: the four first cells are too near.
  for (const double direction : {1.0, -1.0}) {
    const auto very = [&](Vector3 p) { return Vector3(p.x() < 1.5 ? p.x() : 1 + 20 * (p.x() - 1), p.y(), p.z()); };
    const auto turned = [&](Vector3 p) {
      return direction > 0 ? very(p) : Vector3(-very({2 - p.x(), p.y(), p.z()}).x(), p.y(), p.z());
    };
    const verify::SolverQuality q = verify::solver_quality(cubes(2, turned));
    CHECK(q.weight == Approx(1.0 / 21));
    const index_t first = direction > 0 ? 0 : 1;
    CHECK(q.small_weight == std::vector<index_t>{first, first + 2, first + 4, first + 6});
  }
  // The square's corners lifted and lowered by h in turn: four triangles of base 1 and height sqrt(1/4 + h^2).
  const double h = 0.3;
  const std::array<Vector3, 4> warped{Vector3(0, 0, h), Vector3(1, 0, -h), Vector3(1, 1, h), Vector3(0, 1, -h)};
  const FaceGeometry face = face_geometry(warped);
  CHECK(face.area.isApprox(Vector3(0, 0, 1)));
  CHECK(face.centre.isApprox(Vector3(0.5, 0.5, 0)));
  double total = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3 mean(0.5, 0.5, 0);
    total += (warped[i] - mean).cross(warped[(i + 1) % 4] - mean).norm() / 2;
  }
  CHECK(face.flatness == Approx(1 / total));
  CHECK(face.flatness < 0.95);
}

TEST_CASE("cells whose inner faces leave a direction out are found") {
  // One layer: nothing is inside across it. A row: two inner faces alike; its ends have one.
  MixedMesh layer = cubes(3, [](Vector3 p) { return p; });
  const auto keep = [](const MixedMesh& all, auto&& wanted) {
    MixedMesh some;
    some.points = all.points;
    for (std::size_t c = 0; c < all.n_cells(); ++c)
      if (wanted(c)) some.add(all.kinds[c], all.cells[c]);
    return some;
  };
  const verify::SolverQuality one = verify::solver_quality(keep(layer, [](std::size_t c) { return c < 9; }));
  CHECK(one.small_determinant.size() == 9);
  CHECK(one.lonely.empty());
  const verify::SolverQuality row = verify::solver_quality(keep(layer, [](std::size_t c) { return c < 3; }));
  CHECK(row.lonely == std::vector<index_t>{0, 2});
  CHECK(row.determinant == 0);
  // Tetrahedra with two faces outside, and none else.
  const IndexedTetMesh lattice = test::kuhn_lattice(3);
  MixedMesh tets;
  tets.points = lattice.points;
  for (const auto& tet : lattice.tets) tets.add(CellKind::tetrahedron, tet);
  std::vector<int> n_outside(tets.n_cells(), 0);
  for (const CellFace& face : faces_used_once(tets)) ++n_outside[face.cell];
  std::vector<index_t> expected;
  for (index_t c = 0; c < n_outside.size(); ++c)
    if (n_outside[c] >= 2) expected.push_back(c);
  CHECK(!expected.empty());
  CHECK(verify::solver_quality(tets).small_determinant == expected);
}

TEST_CASE("a face that no cut shows whole to both its cells is named") {
  // One corner is pushed through the centre of the cell beyond: its three faces there look away from that centre.
  const auto dent = [](Vector3 p) { return p == Vector3(1, 1, 1) ? Vector3(1.9, 1.9, 1.9) : p; };
  const MixedMesh mesh = cubes(2, dent);
  const verify::SolverQuality q = verify::solver_quality(mesh);
  std::vector<index_t> expected;
  for (index_t c = 0; c < mesh.n_cells(); ++c)
    for (index_t other = 0; other < mesh.n_cells(); ++other)
      for (const LocalFace& face : cell_tables::hexahedron_faces) {
        // Faces of c that other has too; on the boundary c alone counts.
        std::vector<Vector3> p;
        std::size_t n_common = 0;
        for (const std::int8_t corner : face.corners) {
          const index_t v = mesh.cells[c][static_cast<std::size_t>(corner)];
          p.push_back(mesh.points[v]);
          for (const index_t w : mesh.cells[other]) n_common += v == w;
        }
        if (n_common < 4 || other < c) continue;
        bool is_outside = true;
        for (index_t third = 0; third < mesh.n_cells(); ++third) {
          std::size_t n = 0;
          for (const std::int8_t corner : face.corners)
            for (const index_t w : mesh.cells[third]) n += mesh.cells[c][static_cast<std::size_t>(corner)] == w;
          is_outside = is_outside && (third == c || n < 4);
        }
        if (other == c && !is_outside) continue;
        const auto centre = [&](index_t cell) {
          std::vector<FaceGeometry> faces;
          for (const LocalFace& f : cell_tables::hexahedron_faces) {
            std::vector<Vector3> corners;
            for (const std::int8_t corner : f.corners)
              corners.push_back(mesh.points[mesh.cells[cell][static_cast<std::size_t>(corner)]]);
            faces.push_back(face_geometry(corners));
          }
          return cell_geometry(faces).centre;
        };
        const auto sees = [&](const Vector3& eye, std::size_t a, std::size_t b, std::size_t d, double side) {
          Eigen::Matrix3d edges;
          edges << p[a] - eye, p[b] - eye, p[d] - eye;
          return side * edges.determinant() > 0;
        };
        bool any = false;
        for (const auto& [a, b, d, e] :
             {std::array<std::size_t, 4>{0, 1, 2, 3}, std::array<std::size_t, 4>{1, 2, 3, 0}})
          any = any || (sees(centre(c), a, b, d, 1) && sees(centre(c), a, d, e, 1) &&
                        (other == c || (sees(centre(other), a, b, d, -1) && sees(centre(other), a, d, e, -1))));
        if (!any) expected.insert(expected.end(), {c, other});
      }
  std::sort(expected.begin(), expected.end());
  expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
  CHECK(!expected.empty());
  CHECK(q.bad_decomposition == expected);
  CHECK(q.decomposition <= 0);
}
