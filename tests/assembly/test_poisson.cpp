// SPDX-License-Identifier: BSL-1.0
#include <catch2/catch.hpp>

#include "framehex/assembly/assemble.hpp"
#include "support/cube_candidates.hpp"

#include <Eigen/SparseCholesky>
#include <boost/random/uniform_real_distribution.hpp>

#include <numbers>
#include <random>

using namespace framehex;

namespace {

/// Every kind as a hexahedron with corners that coincide: its trilinear functions then sum to those of the kind, and
/// are linear on triangles and bilinear on quadrilaterals, so that cells that meet face to face are continuous.
std::array<index_t, 8> as_hexahedron(CellKind kind, std::span<const index_t> c) {
  switch (kind) {
    case CellKind::tetrahedron: return {c[0], c[1], c[2], c[2], c[3], c[3], c[3], c[3]};
    case CellKind::pyramid: return {c[0], c[1], c[2], c[3], c[4], c[4], c[4], c[4]};
    case CellKind::prism: return {c[0], c[1], c[2], c[2], c[3], c[4], c[5], c[5]};
    default: return {c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]};
  }
}

struct GaussPoint {
  Eigen::Matrix<double, 8, 1> values;
  Eigen::Matrix<double, 8, 3> gradients;  // in space
  Vector3 place;
  double weight;
};

template <class Visit>
void for_each_gauss_point(const MixedMesh& mesh, const std::array<index_t, 8>& corners, Visit&& visit) {
  const double g = std::sqrt(0.6) / 2;
  const std::array<double, 3> at{0.5 - g, 0.5, 0.5 + g}, weight{5.0 / 18, 8.0 / 18, 5.0 / 18};
  constexpr int reference[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                   {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) {
        const double s[3] = {at[i], at[j], at[k]};
        GaussPoint q;
        Eigen::Matrix<double, 8, 3> d;
        for (int c = 0; c < 8; ++c) {
          double f[3], df[3];
          for (int a = 0; a < 3; ++a) {
            f[a] = reference[c][a] ? s[a] : 1 - s[a];
            df[a] = reference[c][a] ? 1 : -1;
          }
          q.values[c] = f[0] * f[1] * f[2];
          d.row(c) << df[0] * f[1] * f[2], f[0] * df[1] * f[2], f[0] * f[1] * df[2];
        }
        Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
        q.place.setZero();
        for (int c = 0; c < 8; ++c) {
          const Vector3& p = mesh.points[corners[static_cast<std::size_t>(c)]];
          jacobian += p * d.row(c);
          q.place += q.values[c] * p;
        }
        q.gradients = d * jacobian.inverse();
        q.weight = weight[i] * weight[j] * weight[k] * jacobian.determinant();
        visit(q);
      }
}

double exact(const Vector3& p) {
  return std::sin(std::numbers::pi * p.x()) * std::cos(2 * p.y()) * std::exp(p.z());
}
double source(const Vector3& p) {
  return (std::numbers::pi * std::numbers::pi + 4 - 1) * exact(p);
}

/// Solves -div grad u = source with the exact values on the boundary. @return the error in the mean square.
double poisson_error(const MixedMesh& mesh) {
  std::vector<std::uint8_t> fixed(mesh.points.size(), 0);
  for (const LabelledFace& face : mesh.faces)
    for (std::size_t i = 0; i < face.size(); ++i) fixed[face.vertices[i]] = 1;
  const auto n = static_cast<Eigen::Index>(mesh.points.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n), u(n);
  for (Eigen::Index v = 0; v < n; ++v) u[v] = exact(mesh.points[static_cast<std::size_t>(v)]);
  for (std::size_t cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto corners = as_hexahedron(mesh.kinds[cell], mesh.cells[cell]);
    for_each_gauss_point(mesh, corners, [&](const GaussPoint& q) {
      for (int a = 0; a < 8; ++a) {
        const index_t va = corners[static_cast<std::size_t>(a)];
        if (fixed[va]) continue;
        right[va] += q.weight * q.values[a] * source(q.place);
        for (int b = 0; b < 8; ++b) {
          const index_t vb = corners[static_cast<std::size_t>(b)];
          const double k = q.weight * q.gradients.row(a).dot(q.gradients.row(b));
          if (fixed[vb])
            right[va] -= k * u[vb];
          else
            entries.emplace_back(static_cast<int>(va), static_cast<int>(vb), k);
        }
      }
    });
  }
  for (int v = 0; v < static_cast<int>(n); ++v)
    if (fixed[static_cast<std::size_t>(v)]) {
      entries.emplace_back(v, v, 1.0);
      right[v] = u[v];
    }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  u = solver.solve(right);
  double error = 0;
  for (std::size_t cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto corners = as_hexahedron(mesh.kinds[cell], mesh.cells[cell]);
    for_each_gauss_point(mesh, corners, [&](const GaussPoint& q) {
      double value = 0;
      for (int a = 0; a < 8; ++a) value += q.values[a] * u[corners[static_cast<std::size_t>(a)]];
      error += q.weight * (value - exact(q.place)) * (value - exact(q.place));
    });
  }
  return std::sqrt(error);
}

MixedMesh unit_cube(index_t n) {
  IndexedTetMesh mesh = test::kuhn_lattice(n, n, n, 1.0 / n);
  std::mt19937_64 engine(n);
  boost::random::uniform_real_distribution<double> uniform(-1, 1);
  for (Vector3& p : mesh.points)
    for (int i = 0; i < 3; ++i)
      if (p[i] > 0.5 / n && p[i] < 1 - 0.5 / n) p[i] += 0.1 / n * uniform(engine);
  std::vector<index_t> selected;
  for (index_t i = 0; i < n * n * n; ++i)
    if (uniform(engine) < 0.4) selected.push_back(i);
  return assemble(mesh, make_adjacency(mesh), test::cube_candidates(n), selected).mesh;
}

}  // namespace

TEST_CASE("linear elements on a mesh of all four kinds converge at second order", "[assembly]") {
  const MixedMesh coarse = unit_cube(4);
  for (const CellKind kind : all_cell_kinds)
    CHECK(std::find(coarse.kinds.begin(), coarse.kinds.end(), kind) != coarse.kinds.end());
  const double e4 = poisson_error(coarse), e8 = poisson_error(unit_cube(8)), e12 = poisson_error(unit_cube(12));
  CAPTURE(e4, e8, e12);
  CHECK(std::log(e4 / e8) / std::log(2.0) > 1.75);
  CHECK(std::log(e8 / e12) / std::log(1.5) > 1.75);
}
