// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/cell_kinds.hpp"
#include "framehex/parts/detail/held_tets.hpp"

#include <span>

namespace framehex::detail {

/// What is known of what lies outside a face, beside the cells that are at hand.
struct FaceMark {
  enum : std::uint8_t {
    boundary = 1,      ///< the outside of the mesh
    cut = 2,           ///< of a quadrilateral: two triangles, unless another quadrilateral faces it
    low_diagonal = 4,  ///< their common edge ends at the vertex of the lowest number
    half = 8           ///< one of them lies on the boundary
  };
};

/// A cell of a mixed mesh that is held in parts.
struct CellRecord {
  std::array<global_t, 8> corners;
  global_t tet = -1;  ///< the host's, of an untouched tetrahedron
  index_t region = 0;
  index_t candidate = no_index;  ///< of a hexahedron, on the rank that found it
  std::uint32_t n_sources = 0;
  CellKind kind = CellKind::tetrahedron;
  std::array<std::uint8_t, 6> marks{};

  std::size_t size() const { return static_cast<std::size_t>(n_corners(kind)); }
};

/// A tetrahedron that a hexahedron or prism was made of, or one that lay in its faces.
struct SourceTet {
  std::array<global_t, 4> vertices;
  global_t number;
  std::uint32_t is_sliver;
};

struct StateVertex {
  global_t number;
  Place place;
  std::uint8_t settled = 0;  ///< it was far enough inside a part when that was improved
  std::uint8_t moved = 0;    ///< from where the host has it
};

/// New vertices have numbers from here on until all are known.
inline constexpr global_t first_new_vertex = number_limit;
inline global_t new_vertex_number(int turn, index_t leaf, std::size_t order) {
  return first_new_vertex | global_t{turn} << 56 | global_t{leaf} << 28 | static_cast<global_t>(order);
}

/// Cells, what they were made of (row by row in the order of the cells), and their vertices.
struct PartState {
  std::vector<CellRecord> cells;
  std::vector<SourceTet> sources;
  std::vector<StateVertex> vertices;  ///< by rising number, once `tidy`

  void append(PartState&& other) {
    const auto join = []<class T>(std::vector<T>& to, std::vector<T>&& from) {
      if (to.empty())
        to = std::move(from);
      else
        to.insert(to.end(), from.begin(), from.end());
    };
    join(cells, std::move(other.cells));
    join(sources, std::move(other.sources));
    join(vertices, std::move(other.vertices));
  }

  void tidy() {
    std::sort(vertices.begin(), vertices.end(), [](const StateVertex& a, const StateVertex& b) {
      return std::tie(a.number, a.settled) < std::tie(b.number, b.settled);
    });
    vertices.erase(std::unique(vertices.begin(), vertices.end(),
                               [](const StateVertex& a, const StateVertex& b) { return a.number == b.number; }),
                   vertices.end());
  }

  /// @pre tidy, and there is one.
  std::size_t find(global_t number) const {
    return static_cast<std::size_t>(std::lower_bound(vertices.begin(), vertices.end(), number,
                                                     [](const StateVertex& v, global_t n) { return v.number < n; }) -
                                    vertices.begin());
  }

  Vector3 centre(const CellRecord& cell) const {
    std::array<Vector3, 8> p;
    for (std::size_t i = 0; i < cell.size(); ++i) p[i] = point_at(vertices[find(cell.corners[i])].place);
    return centre_of(p, cell.size());
  }
};

/// Brings each cell to the rank of its leaf, with its vertices. Collective.
/// @param leaf_of  by cell.
template <Transport Tr>
PartState redistribute(const Tr& transport, const Partition& partition, PartState state,
                       const std::vector<index_t>& leaf_of) {
  if (transport.n_ranks() == 1) return state;
  auto cells = make_rows<CellRecord>(transport);
  auto sources = make_rows<SourceTet>(transport);
  auto vertices = make_rows<StateVertex>(transport);
  std::vector<std::vector<std::uint8_t>> sent(cells.size());
  std::size_t source = 0;
  for (std::size_t i = 0; i < state.cells.size(); ++i) {
    const CellRecord& cell = state.cells[i];
    const auto to = static_cast<std::size_t>(partition.rank(leaf_of[i]));
    cells[to].push_back(cell);
    if (sent[to].empty()) sent[to].assign(state.vertices.size(), 0);
    const auto send_vertex = [&](global_t number) {
      const std::size_t v = state.find(number);
      if (!std::exchange(sent[to][v], std::uint8_t{1})) vertices[to].push_back(state.vertices[v]);
    };
    for (std::size_t k = 0; k < cell.size(); ++k) send_vertex(cell.corners[k]);
    for (std::size_t k = 0; k < cell.n_sources; ++k) {
      sources[to].push_back(state.sources[source]);
      for (const global_t v : state.sources[source++].vertices) send_vertex(v);
    }
  }
  state = {};
  PartState arrived;
  arrived.cells = send_joined(transport, std::move(cells));
  arrived.sources = send_joined(transport, std::move(sources));
  arrived.vertices = send_joined(transport, std::move(vertices));
  arrived.tidy();
  return arrived;
}

}  // namespace framehex::detail
