// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/indexed_mesh.hpp"

#include <cstring>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

namespace framehex::test {

/// Reads a binary STL and welds equal vertices; triangles that lose a corner by it are dropped.
inline IndexedTriangleMesh read_stl(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path);
  file.seekg(80);
  std::uint32_t n = 0;
  file.read(reinterpret_cast<char*>(&n), 4);
  IndexedTriangleMesh mesh;
  std::map<std::array<float, 3>, index_t> known;
  for (std::uint32_t t = 0; t < n; ++t) {
    char record[50];
    if (!file.read(record, 50)) throw std::runtime_error("short file " + path);
    std::array<index_t, 3> triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      std::array<float, 3> p;
      std::memcpy(p.data(), record + 12 + 12 * i, 12);
      for (float& x : p) x += 0.0F;  // -0 welds with 0
      const auto [it, is_new] = known.try_emplace(p, static_cast<index_t>(mesh.points.size()));
      if (is_new) mesh.points.emplace_back(p[0], p[1], p[2]);
      triangle[i] = it->second;
    }
    if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
      mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace framehex::test
