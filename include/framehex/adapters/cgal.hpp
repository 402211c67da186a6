// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/detail/boundary_faces.hpp"
#include "framehex/errors.hpp"
#include "framehex/mesh/concepts.hpp"

#include <CGAL/Surface_mesh.h>
#include <CGAL/Unique_hash_map.h>
#include <CGAL/number_utils.h>

#include <map>

/// CGAL: 3D triangulations and complexes in them as a TetMesh, `Surface_mesh` as a TriangleMesh and for boundaries.
///
/// CGAL's triangulations and mesh complexes are under the GPL; `Surface_mesh` under the LGPL.
namespace framehex {

namespace detail {

/// Some cells of a triangulation and their vertices, numbered in the order of CGAL's iterators.
template <class Triangulation>
struct CgalCells {
  using Vertex = typename Triangulation::Vertex_handle;
  using Cell = typename Triangulation::Cell_handle;

  const Triangulation* triangulation;
  std::vector<Vertex> vertices;
  std::vector<Cell> cells;
  CGAL::Unique_hash_map<Vertex, index_t> number{no_index};

  /// Takes in a vertex of a cell that was listed, once.
  void add_vertices(const Cell& cell) {
    for (int i = 0; i < 4; ++i) {
      const Vertex v = cell->vertex(i);
      if (number[v] != no_index) continue;
      number[v] = static_cast<index_t>(vertices.size());
      vertices.push_back(v);
    }
  }
};

template <class View>
struct cgal_traits {
  using vertex_type = typename View::Vertex;
  using cell_type = typename View::Cell;
  using scalar_type = double;

  static const std::vector<vertex_type>& vertices(const View& view) { return view.vertices; }
  static const std::vector<cell_type>& cells(const View& view) { return view.cells; }
  static std::size_t index(const View& view, vertex_type v) { return view.number[v]; }
  static std::array<double, 3> point(const View& view, vertex_type v) {
    const auto& weighted_or_not = view.triangulation->point(v);
    const auto& p = view.triangulation->geom_traits().construct_point_3_object()(weighted_or_not);
    return {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())};
  }
  static std::array<vertex_type, 4> cell_vertices(const View&, cell_type c) {
    return {c->vertex(0), c->vertex(1), c->vertex(2), c->vertex(3)};
  }
};

/// Labels as they are when they are whole numbers, else counted from 0 in ascending order.
template <class Index>
std::vector<index_t> cgal_labels(const std::vector<Index>& indices) {
  std::vector<index_t> labels;
  if constexpr (std::integral<Index>) {
    for (const Index i : indices) labels.push_back(static_cast<index_t>(i));
  } else {
    std::map<Index, index_t> rank;
    for (const Index& i : indices) rank.emplace(i, 0);
    index_t n = 0;
    for (auto& [index, label] : rank) label = n++;
    for (const Index& i : indices) labels.push_back(rank.at(i));
  }
  return labels;
}

}  // namespace detail

/// The finite cells of a `Delaunay_triangulation_3`, or any `Triangulation_3`: the convex hull of its points. It must
/// outlive the view unchanged.
template <class Triangulation>
struct CgalTriangulation : detail::CgalCells<Triangulation> {
  explicit CgalTriangulation(const Triangulation& t) : detail::CgalCells<Triangulation>{&t, {}, {}} {
    for (const auto v : t.finite_vertex_handles()) {
      this->number[v] = static_cast<index_t>(this->vertices.size());
      this->vertices.push_back(v);
    }
    for (const auto c : t.finite_cell_handles()) this->cells.push_back(c);
  }
};

/// The cells of a `Mesh_complex_3_in_triangulation_3`, their subdomains and patches. It must outlive the view unchanged.
template <class Complex>
struct CgalComplex : detail::CgalCells<typename Complex::Triangulation> {
  std::vector<index_t> regions;     ///< subdomain of each cell
  std::vector<LabelledFace> faces;  ///< facets of the complex with their patches

  explicit CgalComplex(const Complex& complex)
      : detail::CgalCells<typename Complex::Triangulation>{&complex.triangulation(), {}, {}} {
    std::vector<typename Complex::Subdomain_index> subdomains;
    for (auto c = complex.cells_in_complex_begin(); c != complex.cells_in_complex_end(); ++c) {
      this->cells.push_back(c);
      this->add_vertices(this->cells.back());
      subdomains.push_back(complex.subdomain_index(this->cells.back()));
    }
    regions = detail::cgal_labels(subdomains);
    std::vector<typename Complex::Surface_patch_index> patches;
    for (auto f = complex.facets_in_complex_begin(); f != complex.facets_in_complex_end(); ++f) {
      const auto& [cell, opposite] = *f;
      LabelledFace face{{no_index, no_index, no_index, no_index}, 0};
      for (int i = 0; i < 3; ++i)
        face.vertices[static_cast<std::size_t>(i)] = this->number[cell->vertex((opposite + 1 + i) % 4)];
      faces.push_back(face);
      patches.push_back(complex.surface_patch_index(*f));
    }
    const std::vector<index_t> labels = detail::cgal_labels(patches);
    for (std::size_t i = 0; i < faces.size(); ++i) faces[i].label = labels[i];
  }
};

template <class T>
struct mesh_traits<CgalTriangulation<T>> : detail::cgal_traits<CgalTriangulation<T>> {};
template <class C>
struct mesh_traits<CgalComplex<C>> : detail::cgal_traits<CgalComplex<C>> {};

/// Removed vertices that are not yet collected leave gaps in the numbers, which `validate_surface` refuses: call
/// `mesh.collect_garbage()` before. Faces of more than three corners are refused with their number in CGAL.
template <class Point>
struct mesh_traits<CGAL::Surface_mesh<Point>> {
  using Mesh = CGAL::Surface_mesh<Point>;
  using vertex_type = typename Mesh::Vertex_index;
  using cell_type = typename Mesh::Face_index;
  using scalar_type = double;

  static auto vertices(const Mesh& mesh) { return living<vertex_type>(mesh, mesh.num_vertices()); }
  static auto cells(const Mesh& mesh) { return living<cell_type>(mesh, mesh.num_faces()); }
  static std::size_t index(const Mesh&, vertex_type v) { return v.idx(); }
  static std::array<double, 3> point(const Mesh& mesh, vertex_type v) {
    const Point& p = mesh.point(v);
    return {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())};
  }
  static std::array<vertex_type, 3> cell_vertices(const Mesh& mesh, cell_type f) {
    const auto h = mesh.halfedge(f);
    if (mesh.next(mesh.next(mesh.next(h))) != h)
      throw invalid_connectivity("face " + std::to_string(f.idx()) + " is no triangle", Entity::triangle, {f.idx()});
    return {mesh.source(h), mesh.target(h), mesh.target(mesh.next(h))};
  }

private:
  template <class Handle>
  static auto living(const Mesh& mesh, std::size_t n) {
    using Number = typename Mesh::size_type;
    return std::views::iota(Number{0}, static_cast<Number>(n)) |
           std::views::filter([&mesh](Number i) { return !mesh.is_removed(Handle(i)); }) |
           std::views::transform([](Number i) { return Handle(i); });
  }
};

/// Adds the boundary of a mixed mesh, triangles and quadrilaterals, to a `Surface_mesh`.
///
/// @param mesh  conforming.
/// @return vertex added -> vertex of `mesh`, in the order in which they were added.
/// @throws nonmanifold  with the cell whose face CGAL refuses, where parts touch in a vertex or an edge.
/// @par Complexity   O(n log n).
template <class Point>
std::vector<index_t> add_boundary(const MixedMesh& mesh, CGAL::Surface_mesh<Point>& boundary) {
  using Mesh = CGAL::Surface_mesh<Point>;
  return detail::add_boundary_faces<typename Mesh::Vertex_index>(
      mesh, [&](const Vector3& p) { return boundary.add_vertex(Point(p.x(), p.y(), p.z())); },
      [&](const auto& corners) { return boundary.add_face(corners) != Mesh::null_face(); });
}

}  // namespace framehex
