// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/detail/part_numbering.hpp"
#include "framehex/distributed/run_collectively.hpp"
#include "framehex/mesh/adjacency.hpp"

namespace framehex::distributed {

/// Which cells share a facet, over all ranks: the graph that partitioners cut. Collective.
///
/// @return for each cell of this rank the others, ascending; cells are counted on from rank to rank.
inline Csr<std::int64_t> neighbours_by_facets(const IndexedPart& part, const MpiTransport& transport) {
  using Facet = std::array<std::int64_t, 3>;
  struct Entry {
    Facet facet;
    std::int64_t cell;
    int rank;
  };
  struct Pair {
    std::int64_t cell, other;
  };
  const auto n_ranks = static_cast<std::size_t>(transport.n_ranks());
  std::int64_t first_cell = 0;
  const auto counts = detail::gathered(transport, std::vector<std::size_t>{part.mesh.tets.size()});
  for (int rank = 0; rank < transport.rank(); ++rank)
    first_cell += static_cast<std::int64_t>(counts[static_cast<std::size_t>(rank)]);
  std::vector<std::vector<Entry>> told(n_ranks);
  for (std::size_t c = 0; c < part.mesh.tets.size(); ++c)
    for (int face = 0; face < 4; ++face) {
      Facet key{};
      const auto t = facet(part.mesh.tets[c], face);
      for (std::size_t i = 0; i < 3; ++i) key[i] = part.vertex_ids[t[i]];
      std::sort(key.begin(), key.end());
      told[static_cast<std::size_t>(key[0]) / 1024 % n_ranks].push_back(
          {key, first_cell + static_cast<std::int64_t>(c), transport.rank()});
    }
  std::vector<Entry> entries = detail::send_joined(transport, std::move(told));
  std::ranges::sort(entries, {}, [](const Entry& e) { return std::pair(e.facet, e.cell); });
  std::vector<std::vector<Pair>> pairs(n_ranks);
  for (std::size_t i = 0; i + 1 < entries.size(); ++i) {
    const Entry &a = entries[i], &b = entries[i + 1];
    if (a.facet != b.facet) continue;
    pairs[static_cast<std::size_t>(a.rank)].push_back({a.cell, b.cell});
    pairs[static_cast<std::size_t>(b.rank)].push_back({b.cell, a.cell});
  }
  std::vector<Pair> mine = detail::send_joined(transport, std::move(pairs));
  std::ranges::sort(mine, {}, [](const Pair& p) { return std::pair(p.cell, p.other); });
  return make_csr<std::int64_t>(part.mesh.tets.size(), [&](auto&& put) {
    for (const Pair& p : mine) put(static_cast<std::size_t>(p.cell - first_cell), p.other);
  });
}

/// Sends cells to other ranks, with their vertices. Collective.
///
/// @param rank_of_cell  where each goes; may be this rank.
/// @return cells by rising global number. The first rank that has a vertex owns it; vertices without a cell are left out.
/// @throws remote_error  when there are not as many ranks as cells.
inline IndexedPart repartition(const IndexedPart& part, std::span<const int> rank_of_cell,
                               const MpiTransport& transport) {
  struct Vertex {
    std::int64_t id;
    std::array<double, 3> point;
  };
  struct Cell {
    std::int64_t id;
    std::array<index_t, 4> vertices;  ///< among those sent with it
  };
  return run_collectively(transport, [&] {
    if (rank_of_cell.size() != part.cell_ids.size())
      throw invalid_option("there are " + std::to_string(rank_of_cell.size()) + " ranks for " +
                           std::to_string(part.cell_ids.size()) + " cells");
    const auto n_ranks = static_cast<std::size_t>(transport.n_ranks());
    std::vector<std::vector<Vertex>> vertices(n_ranks);
    std::vector<std::vector<Cell>> cells(n_ranks);
    const Csr<index_t> going = make_csr(n_ranks, [&](auto&& put) {
      for (index_t c = 0; c < rank_of_cell.size(); ++c) put(static_cast<std::size_t>(rank_of_cell[c]), c);
    });
    std::vector<index_t> number(part.vertex_ids.size(), no_index);
    for (std::size_t rank = 0; rank < n_ranks; ++rank) {
      for (const index_t c : going[rank]) {
        Cell& cell = cells[rank].emplace_back(Cell{part.cell_ids[c], part.mesh.tets[c]});
        for (index_t& v : cell.vertices) {
          if (number[v] == no_index) {
            number[v] = static_cast<index_t>(vertices[rank].size());
            const Vector3& p = part.mesh.points[v];
            vertices[rank].push_back({part.vertex_ids[v], {p.x(), p.y(), p.z()}});
          }
          v = number[v];
        }
      }
      for (const index_t c : going[rank])
        for (const index_t v : part.mesh.tets[c]) number[v] = no_index;
    }
    IndexedPart result;
    std::vector<Cell> here;
    for (const Parcel& p : transport.exchange(detail::parcels_of(vertices, cells))) {
      detail::Unpacker in(p.bytes);
      const auto first = static_cast<index_t>(result.vertex_ids.size());
      for (const Vertex& v : in.take<Vertex>()) {
        result.vertex_ids.push_back(v.id);
        result.mesh.points.emplace_back(v.point[0], v.point[1], v.point[2]);
      }
      for (Cell cell : in.take<Cell>()) {
        for (index_t& v : cell.vertices) v += first;
        here.push_back(cell);
      }
    }
    std::ranges::sort(here, {}, &Cell::id);
    for (const Cell& cell : here) {
      result.cell_ids.push_back(cell.id);
      result.mesh.tets.push_back(cell.vertices);
    }
    detail::agree_on_vertices(transport, result, true);
    detail::join_vertices(result);
    return result;
  });
}

}  // namespace framehex::distributed
