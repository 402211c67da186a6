// SPDX-License-Identifier: BSL-1.0
#include "bytes.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/mesh/validation.hpp"
#include "targets.hpp"

#include <map>

namespace framehex::test {

namespace {

/// Points with any coordinates, or on a small lattice, where much coincides and lies in planes.
std::vector<Vector3> points_of(Bytes& bytes) {
  std::vector<Vector3> points(bytes.below(12));
  const bool on_lattice = bytes.below(4) != 0;
  const auto coordinate = [&] { return on_lattice ? static_cast<double>(bytes.below(4)) : bytes.any(); };
  for (Vector3& p : points) p = Vector3{coordinate(), coordinate(), coordinate()};
  return points;
}

template <std::size_t Corners>
std::vector<std::array<index_t, Corners>> cells_of(Bytes& bytes, std::size_t n_points) {
  std::vector<std::array<index_t, Corners>> cells;
  while (!bytes.empty()) {
    auto& cell = cells.emplace_back();
    for (index_t& v : cell) v = bytes.below(static_cast<unsigned>(n_points) + 1);
  }
  return cells;
}

/// How often each set of corners but one stands in the cells.
template <std::size_t Corners>
std::map<std::array<index_t, Corners - 1>, int> sides(const std::vector<std::array<index_t, Corners>>& cells) {
  std::map<std::array<index_t, Corners - 1>, int> count;
  for (const auto& cell : cells)
    for (std::size_t out = 0; out < Corners; ++out) {
      std::array<index_t, Corners - 1> side{};
      for (std::size_t i = 0, k = 0; i < Corners; ++i)
        if (i != out) side[k++] = cell[i];
      std::ranges::sort(side);
      ++count[side];
    }
  return count;
}

bool is_accepted(auto&& check) {
  try {
    check();
    return true;
  } catch (const error&) {
    return false;
  }
}

void validate_tets(Bytes& bytes) {
  IndexedTetMesh mesh{points_of(bytes), {}};
  mesh.tets = cells_of<4>(bytes, mesh.points.size());
  if (!is_accepted([&] { validate(mesh); })) return;
  for (const auto& t : mesh.tets)
    for (const index_t v : t) promise(v < mesh.points.size(), "a valid tetrahedron refers to vertices that are there");
  for (const auto& [side, n] : sides(mesh.tets)) promise(n <= 2, "a facet of a valid mesh has two cells at most");
}

void validate_triangles(Bytes& bytes) {
  IndexedTriangleMesh surface{points_of(bytes), {}};
  surface.triangles = cells_of<3>(bytes, surface.points.size());
  if (!is_accepted([&] { validate_closed(surface); })) return;
  for (const auto& [edge, n] : sides(surface.triangles))
    promise(n == 2, "an edge of a closed surface has two triangles");
}

}  // namespace

void fuzz_validate(std::span<const std::uint8_t> input) {
  Bytes bytes(input);
  bytes.below(2) == 0 ? validate_tets(bytes) : validate_triangles(bytes);
}

}  // namespace framehex::test
