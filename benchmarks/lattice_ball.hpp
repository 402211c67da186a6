// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/mesh/indexed_mesh.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

namespace framehex::benchmarks {

/// A ball of `n_across` cells filled by two cubic lattices, the outer one turned against the inner one by 0.6 rad round
/// (1, 2, 3), each point moved by up to 0.05 an axis; the inner one fills half of the volume. Selection is easy inside
/// a lattice and hard where two meet, and here they meet on a sphere.
inline std::vector<Vector3> lattice_ball_points(int n_across) {
  const double radius = 0.5 * n_across, inner_radius = radius * std::cbrt(0.5);
  const Vector3 inner_offset = 0.37 * Vector3(1, 0.3, 0.7);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.6, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vector3> points;
  const auto for_each_lattice_point = [&](auto&& body) {
    for (int i = -n_across; i <= n_across; ++i)
      for (int j = -n_across; j <= n_across; ++j)
        for (int k = -n_across; k <= n_across; ++k) body(Vector3(i, j, k));
  };
  for_each_lattice_point([&](const Vector3& q) {
    const Vector3 p = q + inner_offset;
    if (p.norm() < inner_radius) points.push_back(p);
  });
  const auto is_free = [&](const Vector3& p) {
    const Vector3 nearest = (p - inner_offset).array().round().matrix() + inner_offset;
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        for (int k = -1; k <= 1; ++k) {
          const Vector3 q = nearest + Vector3(i, j, k);
          if (q.norm() < inner_radius && (q - p).norm() < 0.65) return false;
        }
    return true;
  };
  for_each_lattice_point([&](const Vector3& q) {
    const Vector3 p = turn * (q + Vector3::Constant(0.21));
    if (p.norm() >= inner_radius && p.norm() < radius && is_free(p)) points.push_back(p);
  });
  std::mt19937_64 engine(1);
  for (Vector3& p : points)
    for (int axis = 0; axis < 3; ++axis) p[axis] += 0.05 * (static_cast<double>(engine() >> 11) * 0x1p-52 - 1.0);
  return points;
}

/// Delaunay tetrahedra of points, by the program `tetgen`.
inline IndexedTetMesh delaunay(std::vector<Vector3> points) {
  std::string folder = (std::filesystem::temp_directory_path() / "framehex-ball-XXXXXX").string();
  if (!mkdtemp(folder.data())) throw io_error(folder + ": cannot be made");
  {
    std::ofstream out(folder + "/points.node");
    out.precision(17);
    out << points.size() << " 3 0 0\n";
    for (std::size_t i = 0; i < points.size(); ++i) out << i << ' ' << points[i].transpose() << '\n';
  }
  IndexedTetMesh mesh{.points = std::move(points), .tets = {}};
  if (std::system(("tetgen -QN " + folder + "/points.node > /dev/null").c_str()) == 0) {
    std::ifstream in(folder + "/points.1.ele");
    std::size_t n = 0, row = 0;
    int corners = 0, attributes = 0;
    in >> n >> corners >> attributes;
    for (std::array<index_t, 4> tet{}; in >> row >> tet[0] >> tet[1] >> tet[2] >> tet[3];) {
      const Vector3& a = mesh.points[tet[0]];
      if ((mesh.points[tet[1]] - a).cross(mesh.points[tet[2]] - a).dot(mesh.points[tet[3]] - a) < 0)
        std::swap(tet[2], tet[3]);
      mesh.tets.push_back(tet);
    }
  }
  std::filesystem::remove_all(folder);
  if (mesh.tets.empty()) throw io_error("tetgen is not on the PATH, or failed");
  return mesh;
}

inline IndexedTetMesh lattice_ball(int n_across) {
  return delaunay(lattice_ball_points(n_across));
}

}  // namespace framehex::benchmarks
