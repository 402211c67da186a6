// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <array>
#include <cstdint>
#include <span>

/// Vertex, face and edge numbering of the four cells: the one place that states it.
///
/// Corners are numbered as in VTK, but for the prism, where VTK's manual stands alone: as in Gmsh and MEDIT its first
/// triangle looks inward (0 1 2 anticlockwise seen from 3 4 5), so that all four kinds have positive corner
/// determinants.
///
///        7--------6          5                4                3
///       /|       /|         /|\              /|\              /|\ .
///      4--------5 |        3---4            / | \            / | \ .
///      | |      | |        | | |           3--|--2          /  |  \ .
///      | 3------|-2        | 2 |          /   | /          0---|---2
///      |/       |/         |/ \|         0------1           \  |  /
///      0--------1          0---1                              \|/
///                                                              1
///     hexahedron           prism          pyramid         tetrahedron
///
namespace framehex {

/// The four kinds of cells, in ascending number of corners.
enum class CellKind : std::uint8_t { tetrahedron, pyramid, prism, hexahedron };

/// To go through them.
inline constexpr std::array<CellKind, 4> all_cell_kinds{CellKind::tetrahedron, CellKind::pyramid, CellKind::prism,
                                                        CellKind::hexahedron};

/// Number of corners: 4, 5, 6, 8.
constexpr int n_corners(CellKind kind) {
  constexpr std::array<int, 4> count{4, 5, 6, 8};
  return count[static_cast<std::size_t>(kind)];
}

/// A face by local corners, anticlockwise seen from outside; a triangle's fourth entry is -1.
struct LocalFace {
  std::array<std::int8_t, 4> corners;
  constexpr int size() const { return corners[3] < 0 ? 3 : 4; }
};

/// A corner and the ends of three edges there, in an order that makes the determinant of a valid cell positive.
/// At a pyramid's apex four edges meet; it has no entry.
struct LocalCorner {
  std::int8_t corner, x, y, z;
};

namespace cell_tables {

/// What `faces_of` gives.
/// @{
inline constexpr std::array<LocalFace, 4> tetrahedron_faces{
    {{{1, 2, 3, -1}}, {{0, 3, 2, -1}}, {{0, 1, 3, -1}}, {{0, 2, 1, -1}}}};
inline constexpr std::array<LocalFace, 5> pyramid_faces{
    {{{0, 3, 2, 1}}, {{0, 1, 4, -1}}, {{1, 2, 4, -1}}, {{2, 3, 4, -1}}, {{3, 0, 4, -1}}}};
inline constexpr std::array<LocalFace, 5> prism_faces{
    {{{0, 2, 1, -1}}, {{3, 4, 5, -1}}, {{0, 1, 4, 3}}, {{1, 2, 5, 4}}, {{2, 0, 3, 5}}}};
inline constexpr std::array<LocalFace, 6> hexahedron_faces{
    {{{0, 3, 2, 1}}, {{4, 5, 6, 7}}, {{0, 1, 5, 4}}, {{1, 2, 6, 5}}, {{2, 3, 7, 6}}, {{3, 0, 4, 7}}}};
/// @}

/// What `corners_of` gives.
/// @{
inline constexpr std::array<LocalCorner, 4> tetrahedron_corners{
    {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 0, 1, 3}, {3, 0, 2, 1}}};
inline constexpr std::array<LocalCorner, 4> pyramid_corners{{{0, 1, 3, 4}, {1, 2, 0, 4}, {2, 3, 1, 4}, {3, 0, 2, 4}}};
inline constexpr std::array<LocalCorner, 6> prism_corners{
    {{0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5}, {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}}};
inline constexpr std::array<LocalCorner, 8> hexahedron_corners{
    {{0, 1, 3, 4}, {1, 2, 0, 5}, {2, 3, 1, 6}, {3, 0, 2, 7}, {4, 7, 5, 0}, {5, 4, 6, 1}, {6, 5, 7, 2}, {7, 6, 4, 3}}};
/// @}

/// The ends of an edge, by local corners.
using LocalEdge = std::array<std::int8_t, 2>;

/// What `edges_of` gives.
/// @{
inline constexpr std::array<LocalEdge, 6> tetrahedron_edges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
inline constexpr std::array<LocalEdge, 8> pyramid_edges{
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}}};
inline constexpr std::array<LocalEdge, 9> prism_edges{
    {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}}};
inline constexpr std::array<LocalEdge, 12> hexahedron_edges{
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};
/// @}

}  // namespace cell_tables

/// Faces of a cell. Face f of a tetrahedron lies opposite corner f.
constexpr std::span<const LocalFace> faces_of(CellKind kind) {
  switch (kind) {
    case CellKind::tetrahedron: return cell_tables::tetrahedron_faces;
    case CellKind::pyramid: return cell_tables::pyramid_faces;
    case CellKind::prism: return cell_tables::prism_faces;
    default: return cell_tables::hexahedron_faces;
  }
}

/// Corners of a cell with the ends of three edges each, those of a pyramid without its apex.
constexpr std::span<const LocalCorner> corners_of(CellKind kind) {
  switch (kind) {
    case CellKind::tetrahedron: return cell_tables::tetrahedron_corners;
    case CellKind::pyramid: return cell_tables::pyramid_corners;
    case CellKind::prism: return cell_tables::prism_corners;
    default: return cell_tables::hexahedron_corners;
  }
}

/// Edges of a cell, by local corners.
constexpr std::span<const cell_tables::LocalEdge> edges_of(CellKind kind) {
  switch (kind) {
    case CellKind::tetrahedron: return cell_tables::tetrahedron_edges;
    case CellKind::pyramid: return cell_tables::pyramid_edges;
    case CellKind::prism: return cell_tables::prism_edges;
    default: return cell_tables::hexahedron_edges;
  }
}

}  // namespace framehex
