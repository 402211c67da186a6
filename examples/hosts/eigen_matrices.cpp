// SPDX-License-Identifier: BSL-1.0
// A cube as libigl's users hold it, recombined, and the result as matrices again.
#include <framehex/adapters/eigen_matrices.hpp>
#include <framehex/pipeline/recombine_into.hpp>

#include <cstdio>

/// n^3 cubes, each cut into six tetrahedra: any V and T will do, from igl::readMESH or igl::copyleft::tetgen say.
void make_cube(int n, Eigen::MatrixXd& V, Eigen::MatrixXi& T) {
  V.resize((n + 1) * (n + 1) * (n + 1), 3);
  T.resize(6 * n * n * n, 4);
  const auto vertex = [n](int i, int j, int k) { return i + (n + 1) * (j + (n + 1) * k); };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) V.row(vertex(i, j, k)) << i, j, k;
  int row = 0;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        // A tetrahedron for each edge of the ring round the diagonal from (i, j, k).
        const int ring[7] = {vertex(i + 1, j, k), vertex(i + 1, j + 1, k), vertex(i, j + 1, k), vertex(i, j + 1, k + 1),
                             vertex(i, j, k + 1), vertex(i + 1, j, k + 1), vertex(i + 1, j, k)};
        for (int r = 0; r < 6; ++r) T.row(row++) << vertex(i, j, k), ring[r], ring[r + 1], vertex(i + 1, j + 1, k + 1);
      }
}

int main() {
  Eigen::MatrixXd V;
  Eigen::MatrixXi T;
  make_cube(4, V, T);

  framehex::EigenOutput output;
  framehex::recombine_into(output, framehex::EigenTets(V, T));
  const Eigen::MatrixXd points = output.points();                                    // n x 3
  const Eigen::MatrixXi hexahedra = output.cells(framehex::CellKind::hexahedron);    // n x 8
  const Eigen::MatrixXi tetrahedra = output.cells(framehex::CellKind::tetrahedron);  // n x 4
  std::printf("%d tetrahedra became %d hexahedra and %d tetrahedra over %d points\n", static_cast<int>(T.rows()),
              static_cast<int>(hexahedra.rows()), static_cast<int>(tetrahedra.rows()), static_cast<int>(points.rows()));
}
