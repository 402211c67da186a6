// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/detail/part_state.hpp"
#include "framehex/parts/result.hpp"

namespace framehex::detail {

/// Numbers what has come of the turns, and says who shares what.
///
/// New vertices are numbered by the first leaf of their cells, cells by their leaf, and within by the order of their making:
/// the same however many ranks there are.
template <Transport Tr>
class ResultMaker {
public:
  /// @param leaf_of_cell  leaves of the state's cells, ascending.
  ResultMaker(const Tr& transport, const Partition& partition, const std::vector<index_t>& leaf_of_cell,
              global_t first_new)
      : transport_(transport), partition_(partition), leaf_of_cell_(leaf_of_cell), first_new_(first_new) {}

  /// Collective.
  void run(PartState state, PartRecombination& result) {
    number_corners(state);
    find_owners(state, result);
    number_vertices(state, result);
    number_cells(state, result);
    fill(state, result);
  }

private:
  /// Places of the cells' corners among the vertices that cells have.
  void number_corners(PartState& state) {
    std::vector<std::uint8_t> used(state.vertices.size(), 0);
    for (const CellRecord& cell : state.cells)
      for (std::size_t k = 0; k < cell.size(); ++k) used[state.find(cell.corners[k])] = 1;
    std::size_t n = 0;
    for (std::size_t v = 0; v < used.size(); ++v)
      if (used[v]) state.vertices[n++] = state.vertices[v];
    state.vertices.resize(n);
    first_leaf_.assign(n, no_index);
    for (std::size_t i = 0; i < state.cells.size(); ++i) {
      auto& corners = corners_.emplace_back();
      corners.fill(no_index);
      for (std::size_t k = 0; k < state.cells[i].size(); ++k) {
        corners[k] = static_cast<index_t>(state.find(state.cells[i].corners[k]));
        first_leaf_[corners[k]] = std::min(first_leaf_[corners[k]], leaf_of_cell_[i]);
      }
    }
  }

  /// Vertices of faces that one cell of this rank has.
  std::vector<VertexRecord> border_vertices(const PartState& state) const {
    std::vector<std::array<index_t, 4>> faces;
    for (std::size_t i = 0; i < corners_.size(); ++i)
      for (const LocalFace& local : faces_of(state.cells[i].kind)) {
        auto& face = faces.emplace_back();
        for (std::size_t k = 0; k < 4; ++k)
          face[k] = local.corners[k] < 0 ? no_index : corners_[i][static_cast<std::size_t>(local.corners[k])];
        std::sort(face.begin(), face.end());
      }
    std::sort(faces.begin(), faces.end());
    std::vector<std::uint8_t> on_border(state.vertices.size(), 0);
    for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
      while (end < faces.size() && faces[end] == faces[i]) ++end;
      if (end - i == 1)
        for (const index_t v : faces[i])
          if (v != no_index) on_border[v] = 1;
    }
    std::vector<VertexRecord> border;
    for (std::size_t v = 0; v < on_border.size(); ++v)
      if (on_border[v]) border.push_back({state.vertices[v].number, state.vertices[v].place});
    return border;
  }

  void find_owners(const PartState& state, PartRecombination& result) {
    if (transport_.n_ranks() > 1) shared_ = find_sharers(transport_, partition_, border_vertices(state));
    result.owners.assign(state.vertices.size(), transport_.rank());
    for (const auto& entry : shared_.entries) {
      const auto v = static_cast<index_t>(state.find(entry.vertex));
      result.shared.push_back({v, entry.rank});
      result.owners[v] = std::min(result.owners[v], entry.rank);
    }
  }

  /// Numbers before each leaf, of what is counted leaf by leaf on all ranks.
  std::vector<std::int64_t> first_of_leaf(std::vector<std::int64_t> counts) const {
    transport_.sum(std::span<std::int64_t>(counts));
    std::int64_t before = 0;
    for (std::int64_t& n : counts) n = std::exchange(before, before + n);
    return counts;
  }

  void number_vertices(const PartState& state, PartRecombination& result) const {
    struct Number {
      global_t made, given;
    };
    const auto is_own_new = [&](std::size_t v) {
      return state.vertices[v].number >= first_new_vertex && result.owners[v] == transport_.rank();
    };
    std::vector<std::int64_t> next(partition_.size(), 0);
    for (std::size_t v = 0; v < state.vertices.size(); ++v)
      if (is_own_new(v)) ++next[first_leaf_[v]];
    next = first_of_leaf(std::move(next));
    for (const StateVertex& v : state.vertices) result.vertex_numbers.push_back(v.number);
    for (std::size_t v = 0; v < state.vertices.size(); ++v)
      if (is_own_new(v)) result.vertex_numbers[v] = first_new_ + next[first_leaf_[v]]++;
    Rows<Number> rows = make_rows<Number>(transport_);
    for (const auto& [v, rank] : result.shared)
      if (is_own_new(v))
        rows[static_cast<std::size_t>(rank)].push_back({state.vertices[v].number, result.vertex_numbers[v]});
    for (const Number& number : send_joined(transport_, std::move(rows)))
      result.vertex_numbers[state.find(number.made)] = number.given;
  }

  void number_cells(const PartState& state, PartRecombination& result) const {
    std::vector<std::int64_t> next(partition_.size(), 0);
    for (const index_t leaf : leaf_of_cell_) ++next[leaf];
    next = first_of_leaf(std::move(next));
    for (std::size_t i = 0; i < state.cells.size(); ++i) result.cell_numbers.push_back(next[leaf_of_cell_[i]]++);
  }

  void fill(const PartState& state, PartRecombination& result) const {
    for (index_t v = 0; v < state.vertices.size(); ++v) {
      result.mesh.points.push_back(point_at(state.vertices[v].place));
      if (state.vertices[v].moved && state.vertices[v].number < first_new_vertex) result.moved.push_back(v);
    }
    std::size_t source = 0;
    for (std::size_t i = 0; i < state.cells.size(); ++i) {
      const CellRecord& cell = state.cells[i];
      result.mesh.add(cell.kind, {corners_[i].data(), cell.size()});
      result.mesh.regions.push_back(cell.region);
      result.candidate_of.push_back(cell.candidate);
      if (cell.tet >= 0) result.cell_of.values.push_back(cell.tet);
      const auto first = static_cast<std::ptrdiff_t>(result.cell_of.values.size());
      for (std::size_t k = 0; k < cell.n_sources; ++k, ++source)
        if (!state.sources[source].is_sliver) result.cell_of.values.push_back(state.sources[source].number);
      std::sort(result.cell_of.values.begin() + first, result.cell_of.values.end());
      result.cell_of.end_row();
    }
  }

  const Tr& transport_;
  const Partition& partition_;
  const std::vector<index_t>& leaf_of_cell_;
  global_t first_new_;
  std::vector<std::array<index_t, 8>> corners_;
  std::vector<index_t> first_leaf_;  ///< by vertex
  SharedVertices shared_;
};

}  // namespace framehex::detail
