// SPDX-License-Identifier: BSL-1.0
// Stands in for Geogram, which Debian does not have: the names and the numbering that the adapter uses, nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace GEO {

using index_t = std::uint32_t;
enum MeshCellType { MESH_TET = 0, MESH_HEX = 1, MESH_PRISM = 2, MESH_PYRAMID = 3, MESH_CONNECTOR = 4 };

struct MeshVertices {
  std::vector<double> coordinates;
  index_t nb() const { return static_cast<index_t>(coordinates.size() / 3); }
  index_t create_vertex() {
    coordinates.resize(coordinates.size() + 3);
    return nb() - 1;
  }
  const double* point_ptr(index_t v) const { return coordinates.data() + 3 * std::size_t{v}; }
  double* point_ptr(index_t v) { return coordinates.data() + 3 * std::size_t{v}; }
};

struct MeshFacets {
  std::vector<std::vector<index_t>> rows;
  index_t nb() const { return static_cast<index_t>(rows.size()); }
  index_t nb_vertices(index_t f) const { return static_cast<index_t>(rows[f].size()); }
  index_t vertex(index_t f, index_t lv) const { return rows[f][lv]; }
  index_t create_triangle(index_t a, index_t b, index_t c) { return create({a, b, c}); }
  index_t create_quad(index_t a, index_t b, index_t c, index_t d) { return create({a, b, c, d}); }

private:
  index_t create(std::vector<index_t> row) {
    rows.push_back(std::move(row));
    return nb() - 1;
  }
};

struct MeshCells {
  void connect() {}
  std::vector<MeshCellType> types;
  std::vector<std::vector<index_t>> rows;
  index_t nb() const { return static_cast<index_t>(rows.size()); }
  MeshCellType type(index_t c) const { return types[c]; }
  index_t nb_vertices(index_t c) const { return static_cast<index_t>(rows[c].size()); }
  index_t vertex(index_t c, index_t lv) const { return rows[c][lv]; }
  index_t create_tet(index_t a, index_t b, index_t c, index_t d) { return create(MESH_TET, {a, b, c, d}); }
  index_t create_pyramid(index_t a, index_t b, index_t c, index_t d, index_t e) {
    return create(MESH_PYRAMID, {a, b, c, d, e});
  }
  index_t create_prism(index_t a, index_t b, index_t c, index_t d, index_t e, index_t f) {
    return create(MESH_PRISM, {a, b, c, d, e, f});
  }
  index_t create_hex(index_t a, index_t b, index_t c, index_t d, index_t e, index_t f, index_t g, index_t h) {
    return create(MESH_HEX, {a, b, c, d, e, f, g, h});
  }

private:
  index_t create(MeshCellType type, std::vector<index_t> row) {
    types.push_back(type);
    rows.push_back(std::move(row));
    return nb() - 1;
  }
};

struct Mesh {
  MeshVertices vertices;
  MeshFacets facets;
  MeshCells cells;
};

}  // namespace GEO
