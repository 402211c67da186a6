// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/indexed_mesh.hpp"

#include <fstream>
#include <stdexcept>
#include <string>

namespace framehex::test {

/// Reads a PLY file of the one layout that tests/data has: binary little-endian, float x y z, triangles of int.
inline IndexedTriangleMesh read_ply(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::size_t n_points = 0, n_triangles = 0;
  for (std::string word; file >> word && word != "end_header";) {
    if (word == "vertex") file >> n_points;
    if (word == "face") file >> n_triangles;
  }
  file.get();
  IndexedTriangleMesh mesh;
  for (std::size_t i = 0; i < n_points; ++i) {
    float p[3];
    file.read(reinterpret_cast<char*>(p), sizeof p);
    mesh.points.emplace_back(p[0], p[1], p[2]);
  }
  for (std::size_t i = 0; i < n_triangles; ++i) {
    file.get();
    std::int32_t t[3];
    file.read(reinterpret_cast<char*>(t), sizeof t);
    mesh.triangles.push_back({static_cast<index_t>(t[0]), static_cast<index_t>(t[1]), static_cast<index_t>(t[2])});
  }
  if (!file) throw std::runtime_error("cannot read " + path);
  return mesh;
}

}  // namespace framehex::test
