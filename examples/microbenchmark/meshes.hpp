// SPDX-License-Identifier: BSL-1.0
// One mesh in three hosts: flat arrays, objects behind pointers, matrices. A fourth of your own goes here.
#pragma once

#include <framehex/adapters/eigen_matrices.hpp>
#include <framehex/insertion/volume_options.hpp>
#include <framehex/mesh/indexed_mesh.hpp>

#include <memory>
#include <random>

/// Along each side.
inline constexpr framehex::index_t n_cubes = 12;

/// n^3 cubes, each cut into six tetrahedra; points inside are moved a little, so that qualities differ.
inline framehex::IndexedTetMesh make_arrays(framehex::index_t n) {
  using framehex::index_t;
  framehex::IndexedTetMesh mesh;
  std::mt19937 random(1);
  const auto noise = [&](index_t i) {
    return i == 0 || i == n ? 0. : 0.1 * (static_cast<double>(random()) / 4294967296. - 0.5);
  };
  for (index_t k = 0; k <= n; ++k)
    for (index_t j = 0; j <= n; ++j)
      for (index_t i = 0; i <= n; ++i) mesh.points.emplace_back(i + noise(i), j + noise(j), k + noise(k));
  const auto vertex = [n](index_t i, index_t j, index_t k) { return i + (n + 1) * (j + (n + 1) * k); };
  for (index_t k = 0; k < n; ++k)
    for (index_t j = 0; j < n; ++j)
      for (index_t i = 0; i < n; ++i) {
        const index_t ring[7] = {vertex(i + 1, j, k),     vertex(i + 1, j + 1, k), vertex(i, j + 1, k),
                                 vertex(i, j + 1, k + 1), vertex(i, j, k + 1),     vertex(i + 1, j, k + 1),
                                 vertex(i + 1, j, k)};
        for (int r = 0; r < 6; ++r)
          mesh.tets.push_back({vertex(i, j, k), ring[r], ring[r + 1], vertex(i + 1, j + 1, k + 1)});
      }
  return mesh;
}

/// A mesh of objects, as many codes have it.
struct PointerMesh {
  struct Vertex {
    double x, y, z;
    std::size_t number;
  };
  struct Tet {
    std::array<Vertex*, 4> corners;
  };
  std::vector<std::unique_ptr<Vertex>> vertices;
  std::vector<std::unique_ptr<Tet>> tets;

  explicit PointerMesh(const framehex::IndexedTetMesh& arrays) {
    for (const auto& p : arrays.points)
      vertices.push_back(std::make_unique<Vertex>(Vertex{p.x(), p.y(), p.z(), vertices.size()}));
    for (const auto& t : arrays.tets)
      tets.push_back(std::make_unique<Tet>(
          Tet{{vertices[t[0]].get(), vertices[t[1]].get(), vertices[t[2]].get(), vertices[t[3]].get()}}));
  }
};

template <>
struct framehex::mesh_traits<PointerMesh> {
  using vertex_type = PointerMesh::Vertex*;
  using cell_type = PointerMesh::Tet*;
  using scalar_type = double;
  static auto vertices(const PointerMesh& m) {
    return m.vertices | std::views::transform([](const auto& v) { return v.get(); });
  }
  static auto cells(const PointerMesh& m) {
    return m.tets | std::views::transform([](const auto& t) { return t.get(); });
  }
  static std::size_t index(const PointerMesh&, vertex_type v) { return v->number; }
  static std::array<double, 3> point(const PointerMesh&, vertex_type v) { return {v->x, v->y, v->z}; }
  static const std::array<vertex_type, 4>& cell_vertices(const PointerMesh&, cell_type t) { return t->corners; }
};

/// V and T, column by column as Eigen has them by default.
struct MatrixMesh {
  Eigen::MatrixXd V;
  Eigen::MatrixXi T;

  explicit MatrixMesh(const framehex::IndexedTetMesh& arrays) {
    V.resize(static_cast<Eigen::Index>(arrays.points.size()), 3);
    T.resize(static_cast<Eigen::Index>(arrays.tets.size()), 4);
    for (Eigen::Index i = 0; i < V.rows(); ++i) V.row(i) = arrays.points[static_cast<std::size_t>(i)];
    for (Eigen::Index i = 0; i < T.rows(); ++i)
      for (Eigen::Index j = 0; j < 4; ++j)
        T(i, j) = static_cast<int>(arrays.tets[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]);
  }
};

/// Seeds on the lower and upper side of a cube of n^3 unit cubes, and its inside.
inline std::vector<framehex::BoundarySeed> box_seeds(framehex::index_t n) {
  std::vector<framehex::BoundarySeed> seeds;
  for (framehex::index_t i = 0; i <= n; ++i)
    for (framehex::index_t j = 0; j <= n; ++j)
      for (const framehex::index_t k : {framehex::index_t{0}, n})
        seeds.push_back({framehex::Vector3(i, j, k), framehex::Vector3(0, 0, k == 0 ? -1 : 1)});
  return seeds;
}
struct BoxDomain {
  double extent;
  double clearance(const framehex::Vector3& p, double) const { return std::min(p.minCoeff(), extent - p.maxCoeff()); }
};
