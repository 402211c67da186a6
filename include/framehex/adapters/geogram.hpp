// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/mesh/concepts.hpp"
#include "framehex/mesh/mixed_output.hpp"

#include <geogram/mesh/mesh.h>

/// Geogram's meshes: cells as a TetMesh, facets as a TriangleMesh, and a place for results.
namespace framehex {

namespace detail {

struct geogram_traits {
  using vertex_type = GEO::index_t;
  using cell_type = GEO::index_t;
  using scalar_type = double;

  static auto vertices(const auto& view) { return std::views::iota(GEO::index_t{0}, view.mesh.vertices.nb()); }
  static std::size_t index(const auto&, vertex_type v) { return v; }
  static std::array<double, 3> point(const auto& view, vertex_type v) {
    const double* const p = view.mesh.vertices.point_ptr(v);
    return {p[0], p[1], p[2]};
  }
};

}  // namespace detail

/// The cells of a mesh, all tetrahedra. The mesh must outlive it.
struct GeogramTets {
  const GEO::Mesh& mesh;

  /// @throws invalid_connectivity  with the first cell that is none.
  explicit GeogramTets(const GEO::Mesh& m) : mesh(m) {
    for (GEO::index_t c = 0; c < m.cells.nb(); ++c)
      if (m.cells.type(c) != GEO::MESH_TET)
        throw invalid_connectivity("cell " + std::to_string(c) + " is no tetrahedron", Entity::cell, {c});
  }
};

/// The facets of a mesh, all triangles. The mesh must outlive it.
struct GeogramTriangles {
  const GEO::Mesh& mesh;

  /// @throws invalid_connectivity  with the first facet that is none.
  explicit GeogramTriangles(const GEO::Mesh& m) : mesh(m) {
    for (GEO::index_t f = 0; f < m.facets.nb(); ++f)
      if (m.facets.nb_vertices(f) != 3)
        throw invalid_connectivity("facet " + std::to_string(f) + " is no triangle", Entity::triangle, {f});
  }
};

template <>
struct mesh_traits<GeogramTets> : detail::geogram_traits {
  static auto cells(const GeogramTets& view) { return std::views::iota(GEO::index_t{0}, view.mesh.cells.nb()); }
  static std::array<vertex_type, 4> cell_vertices(const GeogramTets& view, cell_type c) {
    const auto& cells = view.mesh.cells;
    return {cells.vertex(c, 0), cells.vertex(c, 1), cells.vertex(c, 2), cells.vertex(c, 3)};
  }
};
static_assert(TetMesh<GeogramTets>);

template <>
struct mesh_traits<GeogramTriangles> : detail::geogram_traits {
  static auto cells(const GeogramTriangles& view) { return std::views::iota(GEO::index_t{0}, view.mesh.facets.nb()); }
  static std::array<vertex_type, 3> cell_vertices(const GeogramTriangles& view, cell_type f) {
    const auto& facets = view.mesh.facets;
    return {facets.vertex(f, 0), facets.vertex(f, 1), facets.vertex(f, 2)};
  }
};
static_assert(TriangleMesh<GeogramTriangles>);

/// Adds cells to a mesh of three dimensions in double precision. Call `mesh.cells.connect()` afterwards for adjacency.
///
/// Geogram counts a hexahedron's corners in the order of their coordinates, x fastest; the other kinds as we do.
class GeogramOutput {
public:
  using vertex_type = GEO::index_t;

  explicit GeogramOutput(GEO::Mesh& mesh) : mesh_(mesh) {}

  GEO::index_t add_vertex(const std::array<double, 3>& p) {
    const GEO::index_t v = mesh_.vertices.create_vertex();
    std::copy(p.begin(), p.end(), mesh_.vertices.point_ptr(v));
    return v;
  }
  void add_cell(CellKind kind, std::span<const GEO::index_t> c) {
    switch (kind) {
      case CellKind::tetrahedron: mesh_.cells.create_tet(c[0], c[1], c[2], c[3]); break;
      case CellKind::pyramid: mesh_.cells.create_pyramid(c[0], c[1], c[2], c[3], c[4]); break;
      case CellKind::prism: mesh_.cells.create_prism(c[0], c[1], c[2], c[3], c[4], c[5]); break;
      default: mesh_.cells.create_hex(c[0], c[1], c[3], c[2], c[4], c[5], c[7], c[6]);
    }
  }

private:
  GEO::Mesh& mesh_;
};
static_assert(MixedOutput<GeogramOutput>);

}  // namespace framehex
