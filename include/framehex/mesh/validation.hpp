// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/predicates.hpp"
#include "framehex/mesh/adjacency.hpp"
#include "framehex/mesh/indexed_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace framehex {

namespace detail {

/// Lengths whose tenth powers, which qualities and error bounds are made of, still are normal numbers.
constexpr double least_extent = 1e-30, largest_coordinate = 1e30;

inline std::string number_text(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

/// Numbers are those of the order of `vertices()`, in full: results refer to vertices by them.
template <class M>
void check_numbers(const M& mesh) {
  check_count(n_vertices(mesh), no_index, "vertices");
  std::size_t expected = 0;
  for (const auto vertex : mesh_traits<M>::vertices(mesh)) {
    const std::size_t index = mesh_traits<M>::index(mesh, vertex);
    if (index != expected)
      throw invalid_connectivity(
          "index() of vertex " + std::to_string(expected) + " in the order of vertices() is " + std::to_string(index),
          Entity::vertex, {expected});
    ++expected;
  }
}

template <class M>
void check_coordinates(const M& mesh) {
  std::size_t index = 0;
  std::array<double, 3> low{}, high{};
  for (const auto vertex : mesh_traits<M>::vertices(mesh)) {
    std::size_t axis = 0;
    for (const auto coordinate : coordinates<M>(mesh, vertex)) {
      const auto x = static_cast<double>(coordinate);
      if (!std::isfinite(x))
        throw invalid_coordinate("vertex " + std::to_string(index) + " has a coordinate that is not finite",
                                 Entity::vertex, {index});
      if (std::abs(x) > largest_coordinate)
        throw invalid_coordinate("vertex " + std::to_string(index) + " has the coordinate " + number_text(x) +
                                     ", beyond " + number_text(largest_coordinate),
                                 Entity::vertex, {index});
      low[axis] = index == 0 ? x : std::min(low[axis], x);
      high[axis] = index == 0 ? x : std::max(high[axis], x);
      ++axis;
    }
    ++index;
  }
  const double extent = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  if (extent > 0 && extent < least_extent)
    throw invalid_coordinate("all vertices lie in a box that is " + number_text(extent) + " wide; below " +
                             number_text(least_extent) + " products of coordinates vanish, so take a smaller unit");
}

/// @param n  vertices that there are.
template <std::size_t Corners, class M>
std::vector<std::array<index_t, Corners>> checked_connectivity(const M& mesh, std::size_t n, Entity entity) {
  const char* const name = entity == Entity::triangle ? "triangle " : "cell ";
  const auto n_cells = static_cast<std::size_t>(std::ranges::distance(mesh_traits<M>::cells(mesh)));
  check_count(n_cells, Corners == 3 ? TriangleAdjacency::most_triangles : no_index, "cells");
  std::vector<std::array<index_t, Corners>> cells;
  cells.reserve(n_cells);
  for (const auto handle : mesh_traits<M>::cells(mesh)) {
    const std::size_t cell = cells.size();
    const std::array<vertex_t<M>, Corners> corners = mesh_traits<M>::cell_vertices(mesh, handle);
    auto& row = cells.emplace_back();
    for (std::size_t i = 0; i < Corners; ++i) {
      const std::size_t v = mesh_traits<M>::index(mesh, corners[i]);
      if (v >= n)  // a negative number of the host's is printed as it is
        throw invalid_connectivity(name + std::to_string(cell) + " refers to vertex " +
                                       std::to_string(static_cast<std::ptrdiff_t>(v)) + " of " + std::to_string(n),
                                   entity, {cell});
      row[i] = static_cast<index_t>(v);
      if (std::find(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(i), row[i]) !=
          row.begin() + static_cast<std::ptrdiff_t>(i))
        throw invalid_connectivity(name + std::to_string(cell) + " uses vertex " + std::to_string(v) + " twice", entity,
                                   {cell});
    }
  }
  return cells;
}

/// A host's mesh as it was when it was checked.
struct CheckedTets {
  std::vector<Vector3> points;
  TetAdjacency adjacency;
};

/// Reads points and tetrahedra once each: what is used is what was checked, whatever the host answers the next time.
template <TetMesh M>
CheckedTets checked_tets(const M& mesh) {
  check_numbers(mesh);
  IndexedTetMesh read{positions(mesh), {}};
  check_coordinates(read);
  read.tets = checked_connectivity<4>(mesh, read.points.size(), Entity::cell);
  const auto& p = read.points;
  const auto& tets = read.tets;
  for (std::size_t cell = 0; cell < tets.size(); ++cell) {
    const auto& t = tets[cell];
    const int sign = orientation(p[t[0]], p[t[1]], p[t[2]], p[t[3]]);
    if (sign <= 0)
      throw inverted_cell("cell " + std::to_string(cell) + (sign == 0 ? " has no volume" : " is inverted"),
                          Entity::cell, {cell});
  }
  // Two tetrahedra on the same side of a facet overlap: a duplicate is the simplest case.
  TetAdjacency adjacency = make_adjacency(read);
  for (std::size_t cell = 0; cell < tets.size(); ++cell)
    for (std::size_t i = 0; i < 4; ++i) {
      const index_t other = adjacency.neighbours[cell][i];
      if (other == no_index || other < cell) continue;
      const auto face = facet(tets[cell], static_cast<int>(i));
      std::size_t j = 0;
      while (adjacency.neighbours[other][j] != cell ||
             detail::sorted(facet(tets[other], static_cast<int>(j))) != detail::sorted(face))
        ++j;
      const auto mirror = facet(tets[other], static_cast<int>(j));
      const auto at = static_cast<std::size_t>(std::find(mirror.begin(), mirror.end(), face[0]) - mirror.begin());
      if (mirror[(at + 1) % 3] == face[1])
        throw nonmanifold(
            "cells " + std::to_string(cell) + " and " + std::to_string(other) + " lie on the same side of a facet",
            Entity::cell, {cell, other});
    }
  return {std::move(read.points), std::move(adjacency)};
}

}  // namespace detail

/// `validate` and `make_adjacency` at the price of one.
template <TetMesh M>
TetAdjacency validated_adjacency(const M& mesh) {
  return detail::checked_tets(mesh).adjacency;
}

/// Checks once, before any work, all that the stages assume of a tetrahedral mesh: that `index()` counts the vertices
/// in the order of `vertices()` among the rest.
///
/// Parts that touch in a vertex or an edge, several components and isolated vertices are allowed.
///
/// @throws invalid_coordinate, invalid_connectivity, inverted_cell (zero volume included, decided exactly),
///         nonmanifold; with the first offender in the order of the mesh.
/// @par Complexity   O(n).
template <TetMesh M>
void validate(const M& mesh) {
  validated_adjacency(mesh);
}

namespace detail {

/// Are the triangles at a vertex one fan, or none? @pre closed.
inline bool is_fan(const TriangleAdjacency& adjacency, index_t v) {
  const auto around = adjacency.triangles_of_vertex[v];
  if (around.empty()) return true;
  index_t first = 3 * around[0];
  while (adjacency.from(first) != v) ++first;
  std::size_t n_reached = 0;
  index_t h = first;
  do {
    ++n_reached;
    h = adjacency.opposite[TriangleAdjacency::previous(h)];
  } while (h != first);
  return n_reached == around.size();
}

/// @throws nonmanifold  with a vertex whose triangles are not one fan. @pre closed.
inline void check_fans(const TriangleAdjacency& adjacency) {
  for (index_t v = 0; v < adjacency.n_vertices(); ++v)
    if (!is_fan(adjacency, v))
      throw nonmanifold("the surface touches itself at vertex " + std::to_string(v), Entity::vertex, {v});
}

/// @throws open_surface, nonmanifold
inline void check_closed(const TriangleAdjacency& adjacency) {
  for (index_t h = 0; h < adjacency.opposite.size(); ++h)
    if (adjacency.opposite[h] == no_index)
      throw open_surface("the surface is open along edge (" + std::to_string(adjacency.from(h)) + ", " +
                             std::to_string(adjacency.to(h)) + ")",
                         Entity::edge, {adjacency.from(h), adjacency.to(h)});
  check_fans(adjacency);
}

}  // namespace detail

/// Checks coordinates and indices of a surface, which may have rims and edges of three or more triangles.
///
/// @throws invalid_coordinate, invalid_connectivity, open_surface (no triangles); with the first offender in the order of
///         the mesh.
/// @par Complexity   O(n).
template <TriangleMesh M>
void validate_surface(const M& mesh) {
  detail::check_numbers(mesh);
  detail::check_coordinates(mesh);
  if (detail::checked_connectivity<3>(mesh, n_vertices(mesh), Entity::triangle).empty())
    throw open_surface("the surface has no triangles");
}

/// Checks that a surface is closed, manifold at its edges and vertices, and consistently oriented.
///
/// @throws invalid_coordinate, invalid_connectivity, nonmanifold, open_surface; with the first offender in the order of
/// the mesh.
/// @par Complexity   O(n).
template <TriangleMesh M>
void validate_closed(const M& mesh) {
  validate_surface(mesh);
  if constexpr (requires {
                  { mesh.adjacency } -> std::convertible_to<const TriangleAdjacency&>;
                })
    detail::check_closed(mesh.adjacency);
  else
    detail::check_closed(make_adjacency(mesh));
}

}  // namespace framehex
