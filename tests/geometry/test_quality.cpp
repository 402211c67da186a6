// SPDX-License-Identifier: BSL-1.0
#include "framehex/geometry/quality.hpp"
#include "support/cells.hpp"
#include "support/four_cells.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

namespace {

const double root3 = std::sqrt(3.0);
const std::array<Vector3, 4> regular_tetrahedron{Vector3(0, 0, 0), Vector3(1, 1, 0), Vector3(0, 1, 1),
                                                 Vector3(1, 0, 1)};
const std::array<Vector3, 6> right_prism{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0.5, root3 / 2, 0),
                                         Vector3(0, 0, 1), Vector3(1, 0, 1), Vector3(0.5, root3 / 2, 1)};
const std::array<Vector3, 5> equal_pyramid{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(1, 1, 0), Vector3(0, 1, 0),
                                           Vector3(0.5, 0.5, std::sqrt(0.5))};

double determinant_sign(const std::array<Vector3, 4>& t) {
  return (t[1] - t[0]).cross(t[2] - t[0]).dot(t[3] - t[0]);
}

}  // namespace

TEST_CASE("Scaled Jacobians of regular cells") {
  REQUIRE(determinant_sign(regular_tetrahedron) > 0);
  CHECK(scaled_jacobian(CellKind::hexahedron, test::unit_cube) == Approx(1));
  CHECK(scaled_jacobian_with_centre(test::unit_cube) == Approx(1));
  CHECK(scaled_jacobian(CellKind::tetrahedron, regular_tetrahedron) == Approx(std::sqrt(0.5)));
  CHECK(scaled_jacobian(CellKind::prism, right_prism) == Approx(root3 / 2));
  CHECK(scaled_jacobian(CellKind::pyramid, equal_pyramid) == Approx(std::sqrt(0.5)));
}

TEST_CASE("Scaled Jacobians of bad cells") {
  auto cube = test::unit_cube;
  cube[6] = cube[2];
  CHECK(scaled_jacobian(CellKind::hexahedron, cube) == 0);
  cube = test::unit_cube;
  std::swap_ranges(cube.begin(), cube.begin() + 4, cube.begin() + 4);
  CHECK(scaled_jacobian(CellKind::hexahedron, cube) == Approx(-1));
  // The top turned by a quarter.
  cube = test::unit_cube;
  std::rotate(cube.begin() + 4, cube.begin() + 5, cube.end());
  CHECK(scaled_jacobian_with_centre(cube) <= scaled_jacobian(CellKind::hexahedron, cube));
}

TEST_CASE("Scaled Jacobian depends neither on size, place and orientation nor on the corner that comes first") {
  std::mt19937_64 engine(1);
  for (int sample = 0; sample < 100; ++sample) {
    const auto cube = test::shaken_cube(0.4, engine);
    const double quality = scaled_jacobian(CellKind::hexahedron, cube);
    const Eigen::Matrix3d turn = Quaternion(0.1 * sample, 0.3, -0.7, 0.2).normalized().toRotationMatrix();
    std::array<Vector3, 8> moved;
    constexpr std::array<std::size_t, 8> next{1, 2, 3, 0, 5, 6, 7, 4};
    for (std::size_t i = 0; i < 8; ++i) moved[i] = 1e-3 * (turn * cube[next[i]]) + Vector3(1, 2, 3);
    CHECK(scaled_jacobian(CellKind::hexahedron, moved) == Approx(quality).margin(1e-9));
  }
}

TEST_CASE("Volumes of cells that fit add up") {
  const MixedMesh mesh = test::four_cells();
  std::array<double, 4> expected{1, 0.5, 1.0 / 3, 1.0 / 6};
  for (std::size_t cell = 0; cell < mesh.n_cells(); ++cell) {
    std::vector<Vector3> corners;
    for (const index_t v : mesh.cells[cell]) corners.push_back(mesh.points[v]);
    CHECK(cell_volume(mesh.kinds[cell], corners) == Approx(expected[cell]));
  }

  std::mt19937_64 engine(2);
  for (int sample = 0; sample < 100; ++sample) {
    const auto p = test::shaken_cube(0.4, engine);
    const double whole = cell_volume(CellKind::hexahedron, p);
    // Gauss's two points a direction are exact for the Jacobian, which has degree 2.
    double integral = 0;
    const std::array<double, 2> gauss{0.5 - std::sqrt(1.0 / 12), 0.5 + std::sqrt(1.0 / 12)};
    for (const double u : gauss)
      for (const double v : gauss)
        for (const double w : gauss) integral += test::trilinear_jacobian(p, u, v, w) / 8;
    CHECK(whole == Approx(integral).margin(1e-12));

    double pyramids = 0;
    for (const LocalFace& face : faces_of(CellKind::hexahedron)) {
      const auto at = [&](std::size_t i) { return p[static_cast<std::size_t>(face.corners[i])]; };
      pyramids += cell_volume(CellKind::pyramid, std::array{at(3), at(2), at(1), at(0), Vector3(0.4, 0.5, 0.6)});
    }
    CHECK(whole == Approx(pyramids).margin(1e-12));

    // A hexahedron with flat ends is two prisms.
    auto flat = p;
    for (std::size_t i = 0; i < 4; ++i) flat[i].z() = 0, flat[i + 4].z() = 1;
    const std::array<Vector3, 6> a{flat[0], flat[1], flat[3], flat[4], flat[5], flat[7]};
    const std::array<Vector3, 6> b{flat[1], flat[2], flat[3], flat[5], flat[6], flat[7]};
    CHECK(cell_volume(CellKind::hexahedron, flat) ==
          Approx(cell_volume(CellKind::prism, a) + cell_volume(CellKind::prism, b)).margin(1e-12));
  }
}

TEST_CASE("Volume keeps its digits far from the origin") {
  auto cube = test::unit_cube;
  for (Vector3& p : cube) p += Vector3(1e8, -1e8, 1e8);
  CHECK(cell_volume(CellKind::hexahedron, cube) == Approx(1).epsilon(1e-14));
}
