// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/eigen_matrices.hpp"
#include "framehex/mesh/adjacency.hpp"
#include "framehex/pipeline/recombine_into.hpp"
#include "support/host_reference.hpp"

using namespace framehex;

namespace {

template <class Matrix, class Rows>
Matrix to_matrix(const Rows& rows) {
  const auto n_rows = static_cast<Eigen::Index>(rows.size()), n_columns = static_cast<Eigen::Index>(rows[0].size());
  Matrix m(n_rows, n_columns);
  for (Eigen::Index i = 0; i < n_rows; ++i)
    for (Eigen::Index j = 0; j < n_columns; ++j)
      m(i, j) = static_cast<typename Matrix::Scalar>(rows[static_cast<std::size_t>(i)].data()[j]);
  return m;
}

MixedMesh from_matrices(const EigenOutput& output) {
  MixedMesh mesh;
  const Eigen::MatrixXd v = output.points();
  for (Eigen::Index i = 0; i < v.rows(); ++i) mesh.points.emplace_back(v.row(i));
  for (const CellKind kind : all_cell_kinds) {
    const Eigen::MatrixXi cells = output.cells(kind);
    const Eigen::VectorXi regions = output.regions(kind);
    REQUIRE(regions.size() == cells.rows());
    for (Eigen::Index c = 0; c < cells.rows(); ++c) {
      std::vector<index_t> corners;
      for (Eigen::Index i = 0; i < cells.cols(); ++i) corners.push_back(static_cast<index_t>(cells(c, i)));
      mesh.add(kind, corners);
      mesh.regions.push_back(static_cast<index_t>(regions[c]));
    }
  }
  return mesh;
}

}  // namespace

TEST_CASE("Eigen matrices are a tetrahedral mesh") {
  const auto& reference = test::host_reference();
  const auto v = to_matrix<Eigen::MatrixXd>(reference.mesh.points);
  const auto t = to_matrix<Eigen::MatrixXi>(reference.mesh.tets);
  test::check_host(EigenTets(v, t));
}

TEST_CASE("Eigen matrices take the result back") {
  const auto& reference = test::host_reference();
  const auto v = to_matrix<Eigen::MatrixXd>(reference.mesh.points);
  const auto t = to_matrix<Eigen::MatrixXi>(reference.mesh.tets);
  EigenOutput output;
  const Recombination result = recombine_into(
      output, EigenTets(v, t), {.regions = reference.regions, .faces = reference.faces, .edges = reference.edges});
  CHECK(result.mesh.points.empty());
  CHECK(result.vertex_of == reference.result.vertex_of);
  const MixedMesh back = from_matrices(output);
  test::check_same_cells(back, reference.result.mesh);
  const auto n_of = [&](index_t region) { return std::count(back.regions.begin(), back.regions.end(), region); };
  CHECK(n_of(1) > 0);
  CHECK(n_of(4) > 0);
  CHECK(static_cast<std::size_t>(n_of(1) + n_of(4)) == back.n_cells());
}

TEST_CASE("a cancelled run writes nothing to its output") {
  const auto& reference = test::host_reference();
  EigenOutput output;
  const Recombination result =
      recombine_into(output, reference.mesh, {.observer = [](const auto&...) { return false; }});
  CHECK(result.status == Status::cancelled);
  CHECK(output.points().rows() == 0);
}

TEST_CASE("Eigen surfaces, of any integers and storage") {
  using Rows = Eigen::Matrix<std::int64_t, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const std::vector<Vector3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<std::array<index_t, 3>> faces{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  const auto v = to_matrix<Eigen::MatrixXf>(points);
  const auto f = to_matrix<Rows>(faces);
  CHECK(triangles(EigenTriangles(v, f)) == faces);
  CHECK_NOTHROW(validate_closed(EigenTriangles(v, f)));
}

TEST_CASE("Eigen matrices of other shapes are refused") {
  const Eigen::MatrixXd v = Eigen::MatrixXd::Zero(4, 2);
  const Eigen::MatrixXi t(1, 4), f(1, 3);
  CHECK_THROWS_AS(EigenTets(v, t), invalid_connectivity);
  const Eigen::MatrixXd space = Eigen::MatrixXd::Zero(4, 3);
  CHECK_THROWS_AS(EigenTets(space, f), invalid_connectivity);
  CHECK_THROWS_AS(EigenTriangles(space, t), invalid_connectivity);
  Eigen::MatrixXi out(1, 4);
  out << 0, 1, 2, -1;
  CHECK_THROWS_AS(validate(EigenTets(space, out)), invalid_connectivity);
}

TEST_CASE("Eigen indices narrower than the number of rows, and negative ones, are named as they are") {
  const auto refusal = [](const auto& v, const auto& t) -> std::string {
    try {
      validate(EigenTets(v, t));
    } catch (const invalid_connectivity& e) {
      CHECK(e.indices() == std::vector<std::size_t>{0});
      return e.what();
    }
    return {};
  };
  // The tetrahedron stands on the first four of more points than its type counts.
  for (const Eigen::Index n : {200, 256, 300}) {
    Eigen::MatrixXd v = Eigen::MatrixXd::Zero(n, 3);
    v.row(1) << 1, 0, 0;
    v.row(2) << 0, 1, 0;
    v.row(3) << 0, 0, 1;
    Eigen::Matrix<std::uint8_t, Eigen::Dynamic, 4> bytes(1, 4);
    Eigen::Matrix<std::int8_t, Eigen::Dynamic, 4> signed_bytes(1, 4);
    bytes << 0, 1, 2, 3;
    signed_bytes << 0, 1, 2, 3;
    CHECK(positions(EigenTets(v, bytes)).size() == static_cast<std::size_t>(n));
    CHECK(refusal(v, bytes).empty());
    CHECK(refusal(v, signed_bytes).empty());
    signed_bytes(0, 2) = -7;
    CHECK(refusal(v, signed_bytes) == "cell 0 refers to vertex -7 of " + std::to_string(n));
  }
}

TEST_CASE("views of temporary matrices do not compile") {
  using V = Eigen::MatrixXd;
  using T = Eigen::MatrixXi;
  CHECK(std::is_constructible_v<EigenTets<V, T>, V&, const T&>);
  CHECK_FALSE(std::is_constructible_v<EigenTets<V, T>, V, T&>);
  CHECK_FALSE(std::is_constructible_v<EigenTets<V, T>, V&, T>);
  CHECK_FALSE(std::is_constructible_v<EigenTriangles<V, T>, V, T>);
  using Scaled = decltype(std::declval<V&>() * 2.0);
  CHECK_FALSE(std::is_constructible_v<EigenTets<Scaled, T>, Scaled, T&>);
}

TEST_CASE("labels that Eigen's integers do not hold are refused") {
  EigenOutput output;
  const std::array<int, 4> corners{0, 1, 2, 3};
  output.add_cell(CellKind::tetrahedron, corners, 2147483647u);
  CHECK(output.regions(CellKind::tetrahedron)[0] == 2147483647);
  CHECK_THROWS_AS(output.add_cell(CellKind::tetrahedron, corners, 2147483648u), io_error);
}
