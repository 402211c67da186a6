// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/midside_nodes.hpp"

#include <span>

namespace framehex::detail {

/// In which order a format counts the edges of its elements, by places of its own order of corners.
using EdgeOrder = std::span<const cell_tables::LocalEdge>;

inline constexpr std::array<cell_tables::LocalEdge, 1> order_line{{{0, 1}}};
inline constexpr std::array<cell_tables::LocalEdge, 3> order_triangle{{{0, 1}, {1, 2}, {2, 0}}};
inline constexpr std::array<cell_tables::LocalEdge, 4> order_quadrilateral{{{0, 1}, {1, 2}, {2, 3}, {3, 0}}};
inline constexpr std::array<cell_tables::LocalEdge, 6> vtk_tetrahedron{
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
inline constexpr std::array<cell_tables::LocalEdge, 6> msh_tetrahedron{
    {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {2, 3}, {1, 3}}};
inline constexpr std::array<cell_tables::LocalEdge, 8> msh_pyramid{
    {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 4}, {2, 3}, {2, 4}, {3, 4}}};
inline constexpr std::array<cell_tables::LocalEdge, 9> msh_prism{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}}};
inline constexpr std::array<cell_tables::LocalEdge, 12> msh_hexahedron{
    {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}}};

inline EdgeOrder face_edge_order(std::size_t n_corners) {
  if (n_corners == 2) return order_line;
  return n_corners == 3 ? EdgeOrder(order_triangle) : EdgeOrder(order_quadrilateral);
}

/// Of VTK and Abaqus: all kinds but the tetrahedron in our own order.
inline EdgeOrder vtk_edge_order(CellKind kind) {
  return kind == CellKind::tetrahedron ? EdgeOrder(vtk_tetrahedron) : edges_of(kind);
}

inline EdgeOrder msh_edge_order(CellKind kind) {
  switch (kind) {
    case CellKind::tetrahedron: return msh_tetrahedron;
    case CellKind::pyramid: return msh_pyramid;
    case CellKind::prism: return msh_prism;
    default: return msh_hexahedron;
  }
}

/// Appends the nodes on the edges of an element; those of a mesh of n points are numbered from n.
///
/// @param corners  in the format's order.
template <class Numbers, class Corners>
void append_midside(Numbers& numbers, const MidsideNodes& midside, std::size_t n_points, const Corners& corners,
                    EdgeOrder order) {
  using Number = typename Numbers::value_type;
  for (const auto& [a, b] : order)
    numbers.push_back(
        static_cast<Number>(n_points + midside.of(static_cast<index_t>(corners[static_cast<std::size_t>(a)]),
                                                  static_cast<index_t>(corners[static_cast<std::size_t>(b)]))));
}

/// All points of a file: the mesh's, then those on its edges.
inline std::vector<Vector3> points_with(const MixedMesh& mesh, const MidsideNodes* midside) {
  std::vector<Vector3> points = mesh.points;
  if (midside) points.insert(points.end(), midside->points.begin(), midside->points.end());
  return points;
}

}  // namespace framehex::detail
