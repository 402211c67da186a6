// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/io/triangle_soup.hpp"

#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <sstream>

namespace framehex {

namespace detail {

inline IndexedTriangleMesh soup_of_scene(const aiScene& scene) {
  IndexedTriangleMesh soup;
  std::vector<index_t> polygon;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    const auto first = static_cast<index_t>(soup.points.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v)
      soup.points.emplace_back(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      polygon.clear();
      for (unsigned i = 0; i < face.mNumIndices; ++i) {
        if (face.mIndices[i] >= mesh.mNumVertices)
          throw invalid_connectivity("polygon " + std::to_string(f) + " refers to vertex " +
                                         std::to_string(face.mIndices[i]) + " of " + std::to_string(mesh.mNumVertices),
                                     Entity::triangle, {f});
        polygon.push_back(first + face.mIndices[i]);
      }
      append_polygon(soup, polygon);
    }
  }
  return soup;
}

/// assimp takes the last vertex of an OFF file in place of one that the file does not have.
inline void check_off_indices(const std::string& bytes) {
  std::istringstream file(bytes);
  std::string line;
  // The next line that holds anything but a comment.
  const auto next_line = [&] {
    while (std::getline(file, line)) {
      line.erase(std::min(line.find('#'), line.size()));
      if (line.find_first_not_of(" \t\r") != line.npos) return true;
    }
    return false;
  };
  std::size_t n_vertices = 0, n_polygons = 0;
  if (!next_line() || line.find("OFF") == line.npos) return;
  line.erase(0, line.find("OFF") + 3);  // the counts may follow on the same line
  if (line.find_first_not_of(" \t\r") == line.npos && !next_line()) return;
  if (!(std::istringstream(line) >> n_vertices >> n_polygons)) return;
  for (std::size_t v = 0; v < n_vertices; ++v)
    if (!next_line()) return;
  for (std::size_t f = 0; f < n_polygons && next_line(); ++f) {
    std::istringstream numbers(line);
    long long n = 0, vertex = 0;
    numbers >> n;
    for (long long i = 0; i < n && numbers >> vertex; ++i)
      if (vertex < 0 || static_cast<std::size_t>(vertex) >= n_vertices)
        throw invalid_connectivity("polygon " + std::to_string(f) + " refers to vertex " + std::to_string(vertex) +
                                       " of " + std::to_string(n_vertices),
                                   Entity::triangle, {f});
  }
}

}  // namespace detail

/// Reads a surface of triangles or polygons, which are cut into triangles: STL of both kinds, OBJ, OFF, PLY. Needs
/// assimp.
///
/// @param path  the file; its extension tells the format.
/// @return welded and oriented as `surface_of_soup` says. assimp holds coordinates in single precision.
/// @throws io_error naming the file: missing, another format, or assimp's own complaint; invalid_coordinate and
///         invalid_connectivity, naming the file and the vertex or triangle in assimp's numbering (the file's order).
/// @par Complexity   O(n log n).
inline SoupSurface read_surface(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (extension != ".stl" && extension != ".obj" && extension != ".off" && extension != ".ply")
    throw io_error(name + ": unknown extension of a surface (known: .stl .obj .off .ply)");
  const std::string bytes = read_file(path);
  if (bytes.empty()) throw io_error(name + ": is empty");
  // assimp 5.2 never returns from a PLY file that ends within its header.
  if (extension == ".ply" && bytes.find("\nend_header\n") == bytes.npos && bytes.find("\nend_header\r") == bytes.npos)
    throw io_error(name + ": the header does not end");

  Assimp::Importer importer;
  // Without any of assimp's later steps: they drop, merge, turn and move what the caller wants to hear of, and some
  // abort the program on damaged files.
  const aiScene* const scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, extension.c_str() + 1);
  if (!scene) {
    std::string complaint = importer.GetErrorString();
    std::replace(complaint.begin(), complaint.end(), '\n', ' ');
    // How assimp calls what it reads from memory.
    const std::string unnamed = " for $$$___magic___$$$" + extension;
    if (const std::size_t at = complaint.find(unnamed); at != complaint.npos) complaint.erase(at, unnamed.size());
    throw io_error(name + ": cannot be understood (" + complaint + ")");
  }
  try {
    if (extension == ".off") detail::check_off_indices(bytes);
    const IndexedTriangleMesh soup = detail::soup_of_scene(*scene);
    if (soup.triangles.empty()) throw io_error(name + ": holds no triangles");
    return surface_of_soup(soup);
  } catch (const invalid_coordinate& e) {
    throw invalid_coordinate(name + ": " + e.what(), e.entity(), e.indices());
  } catch (const invalid_connectivity& e) {
    throw invalid_connectivity(name + ": " + e.what(), e.entity(), e.indices());
  }
}

}  // namespace framehex
