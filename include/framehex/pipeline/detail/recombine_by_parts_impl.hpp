// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/cell_origins.hpp"
#include "framehex/assembly/detail/mixed_export.hpp"
#include "framehex/pipeline/recombine_by_parts.hpp"

#include <numeric>

namespace framehex::detail {

/// A mesh in one place, recombined in parts, as an assembly of the host's vertices and cells.
class PartsJoiner {
public:
  /// @param part  is let go.
  PartsJoiner(const std::vector<Vector3>& points, const TetAdjacency& adjacency, VertexNumbers numbers,
              PartRecombination part)
      : points_(points), adjacency_(adjacency), part_(std::move(part)) {
    result_.statistics = part_.assembly;
    place_vertices(numbers);
    add_cells();
    result_.mesh.edges.clear();
    std::vector<index_t> same(result_.mesh.points.size());
    std::iota(same.begin(), same.end(), index_t{0});
    label_faces(result_.mesh, same, {}, {}, {});
  }

  Assembly take() { return std::move(result_); }

private:
  bool is_host(global_t number) const { return number < static_cast<global_t>(points_.size()); }

  /// Host's vertices in their numbers, then new ones; of those that cells have used none is left out but by improvement.
  void place_vertices(VertexNumbers numbers) {
    std::vector<index_t> part_of(points_.size(), no_index), made;
    for (index_t v = 0; v < part_.vertex_numbers.size(); ++v)
      if (is_host(part_.vertex_numbers[v]))
        part_of[static_cast<std::size_t>(part_.vertex_numbers[v])] = v;
      else
        made.push_back(v);
    std::sort(made.begin(), made.end(),
              [this](index_t a, index_t b) { return part_.vertex_numbers[a] < part_.vertex_numbers[b]; });
    vertex_.assign(part_.vertex_numbers.size(), no_index);
    result_.result_of.assign(points_.size(), no_index);
    const auto add = [&](index_t host, index_t part) {
      const auto v = static_cast<index_t>(result_.mesh.points.size());
      const bool is_removed = part == no_index && host != no_index && !adjacency_.tets_of_vertex[host].empty();
      if (part != no_index) vertex_[part] = v;
      result_.mesh.points.push_back(part == no_index ? points_[host] : part_.mesh.points[part]);
      result_.vertex_of.push_back(is_removed ? no_index : host);
      if (host != no_index && !is_removed) result_.result_of[host] = v;
    };
    for (index_t host = 0; host < points_.size(); ++host) {
      const bool is_used = part_of[host] != no_index;
      if (!is_used && !adjacency_.tets_of_vertex[host].empty()) ++result_.statistics.n_removed_vertices;
      if (is_used || numbers == VertexNumbers::kept) add(host, part_of[host]);
      if (is_used && part_.mesh.points[part_of[host]] != points_[host]) result_.moved.push_back(host);
    }
    for (const index_t part : made) add(no_index, part);
    result_.statistics.n_new_vertices = made.size();
  }

  void add_cells() {
    const CellOrigins origins(adjacency_);
    AssemblyStatistics& statistics = result_.statistics;
    std::vector<index_t> corners, tets;
    std::array<Vector3, 8> p;
    for (auto kind = all_cell_kinds.rbegin(); kind != all_cell_kinds.rend(); ++kind)
      for (std::size_t i = 0; i < part_.mesh.n_cells(); ++i) {
        if (part_.mesh.kinds[i] != *kind) continue;
        const auto cell = part_.mesh.cells[i];
        corners.clear();
        CellComplex::Cell origin{};
        origin.kind = *kind;
        origin.corners.fill(no_index);
        for (std::size_t k = 0; k < cell.size(); ++k) {
          corners.push_back(vertex_[cell[k]]);
          p[k] = part_.mesh.points[cell[k]];
          const global_t number = part_.vertex_numbers[cell[k]];
          origin.corners[k] = is_host(number) ? static_cast<index_t>(number) : no_index - 1 - static_cast<index_t>(k);
        }
        result_.mesh.add(*kind, corners);
        result_.mesh.regions.push_back(part_.mesh.regions[i]);
        result_.candidate_of.push_back(part_.candidate_of[i]);
        tets.clear();
        if (*kind == CellKind::hexahedron || *kind == CellKind::prism)
          for (const global_t tet : part_.cell_of[i]) tets.push_back(static_cast<index_t>(tet));
        origins.append(origin, tets, result_.cell_of);
        const double volume = cell_volume(*kind, {p.data(), cell.size()});
        statistics.volume += volume;
        if (*kind == CellKind::hexahedron) statistics.hexahedron_volume += volume;
      }
  }

  const std::vector<Vector3>& points_;
  const TetAdjacency& adjacency_;
  PartRecombination part_;
  std::vector<index_t> vertex_;  ///< vertex of the part -> of the result
  Assembly result_;
};

FRAMEHEX_INLINE Assembly join_parts(const std::vector<Vector3>& points, const TetAdjacency& adjacency,
                                    VertexNumbers numbers, PartRecombination part) {
  return PartsJoiner(points, adjacency, numbers, std::move(part)).take();
}

}  // namespace framehex::detail
