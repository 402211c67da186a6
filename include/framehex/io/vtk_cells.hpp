// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/cell_kinds.hpp"

#include <array>
#include <cstdint>
#include <string_view>

/// VTK's numbers for the cells, and its order of their corners.
namespace framehex::vtk {

/// VTK's numbers of the cells.
enum CellType : std::uint8_t {
  vertex = 1,
  poly_vertex = 2,
  line = 3,
  poly_line = 4,
  triangle = 5,
  polygon = 7,
  pixel = 8,
  quad = 9,
  tetrahedron = 10,
  voxel = 11,
  hexahedron = 12,
  wedge = 13,
  pyramid = 14,
  quadratic_line = 21,
  quadratic_triangle = 22,
  quadratic_quad = 23,
  quadratic_tetrahedron = 24,
  quadratic_hexahedron = 25,
  quadratic_wedge = 26,
  quadratic_pyramid = 27
};

/// What the names of field data that name labels begin with, by dimension.
inline constexpr std::array<std::string_view, 4> group_prefixes{"points:", "curves:", "patches:", "regions:"};

/// VTK's number of a kind.
constexpr CellType cell_type(CellKind kind) {
  constexpr std::array<CellType, 4> types{tetrahedron, pyramid, wedge, hexahedron};
  return types[static_cast<std::size_t>(kind)];
}

/// VTK's number of a kind with a node on each edge.
constexpr CellType quadratic_cell_type(CellKind kind) {
  constexpr std::array<CellType, 4> types{quadratic_tetrahedron, quadratic_pyramid, quadratic_wedge,
                                          quadratic_hexahedron};
  return types[static_cast<std::size_t>(kind)];
}

/// Our corner that stands at place i of VTK's order, and the other way round: the prism is its own mirror image, since
/// VTK's manual lets its first triangle look outward where ours looks inward; the others agree.
constexpr std::size_t corner(CellKind kind, std::size_t i) {
  constexpr std::array<std::size_t, 6> prism{0, 2, 1, 3, 5, 4};
  return kind == CellKind::prism ? prism[i] : i;
}

}  // namespace framehex::vtk
