// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/parts/detail/calling_thread.hpp"
#include "framehex/parts/detail/part_turn.hpp"

#include <optional>

namespace framehex::detail {

/// Shifts of the octrees of one turn after another, over the width of the mesh. Every place is far from the leaves'
/// borders in one of any four; see MortonCube.
inline double shift_of_turn(int turn) {
  constexpr std::array<double, 5> shifts{0.0, 0.4, 0.2, 0.6, 0.8};
  return shifts[static_cast<std::size_t>(turn) % shifts.size()];
}

/// Closes and improves a mixed mesh that is held in parts, in turns. For each the cells are divided anew, by a shifted octree,
/// and all leaves are worked on at the same time, each on its own: what lay on a border before lies inside now.
template <Transport Tr, Executor E>
class AssemblyTurns {
public:
  AssemblyTurns(const Tr& transport, const Vector3& low, const Vector3& high, const AssemblyOptions& options,
                const E& executor, CallingThread& thread)
      : transport_(transport), low_(low), high_(high), options_(options), executor_(executor), thread_(thread) {}

  AssemblyStatistics statistics;
  std::size_t n_kept = 0;  ///< turns of parts that came to nothing

  /// @param part_size  cells, at most, of a leaf.
  /// @return false when stopped. Collective. Ends: leaves grow until one holds all.
  bool run(PartState& state, std::size_t part_size) {
    constexpr int n_turns = 4;
    for (int turn = 0;; ++turn) {
      if (turn >= n_turns) part_size *= 2;
      const std::size_t n_leaves = run_turn(state, part_size, turn, turn + 1 < n_turns);
      if (any_rank(transport_, thread_.stopped())) return false;
      if (n_leaves <= 1) break;
      if (turn + 1 >= n_turns && n_unmatched_ == 0) break;
      if (options_.interfaces == InterfaceMode::open && turn + 1 >= n_turns) break;
    }
    return true;
  }

  /// Faces that have no other side, after the last turn.
  std::int64_t n_unmatched() const { return n_unmatched_; }
  /// Their vertices that the host has, of the faces that this rank looked at.
  const std::vector<global_t>& unmatched_vertices() const { return unmatched_vertices_; }
  std::size_t n_turns() const { return n_turns_; }
  /// Leaves of the last turn, and that in which each cell of the result was.
  const Partition& partition() const { return *partition_; }
  const std::vector<index_t>& leaf_of_cell() const { return leaf_of_cell_; }

private:
  std::size_t run_turn(PartState& state, std::size_t part_size, int turn, bool defers) {
    ++n_turns_;
    thread_.set_fraction(turn < 4 ? 0.25 * turn : 1.0);
    const MortonCube cube(low_, high_, shift_of_turn(turn));
    std::vector<MortonCube::Code> codes;
    codes.reserve(state.cells.size());
    for (const CellRecord& cell : state.cells) codes.push_back(cube.code(state.centre(cell)));
    const Partition& partition = partition_.emplace(transport_, cube, codes, part_size);
    std::vector<index_t> leaf_of;
    leaf_of.reserve(codes.size());
    for (const MortonCube::Code code : codes) leaf_of.push_back(partition.leaf_at(code));
    if (transport_.n_ranks() > 1) {
      state = redistribute(transport_, partition, std::move(state), leaf_of);
      leaf_of.clear();
      for (const CellRecord& cell : state.cells) leaf_of.push_back(partition.leaf_at(state.centre(cell)));
    }
    work_on_leaves(state, partition, leaf_of, {options_, turn, defers && partition.size() > 1});
    match(partition);
    return partition.size();
  }

  void work_on_leaves(PartState& state, const Partition& partition, const std::vector<index_t>& leaf_of,
                      const TurnSettings& settings) {
    const auto [first, last] = partition.leaves_of(transport_.rank());
    const Csr<index_t> cells_of_leaf = make_csr(last - first, [&](auto&& put) {
      for (std::size_t i = 0; i < leaf_of.size(); ++i) put(leaf_of[i] - first, static_cast<index_t>(i));
    });
    std::vector<std::size_t> first_source(state.cells.size());
    std::size_t next = 0;
    for (std::size_t i = 0; i < state.cells.size(); ++i) {
      first_source[i] = next;
      next += state.cells[i].n_sources;
    }
    struct Result {
      PartState state;
      AssemblyStatistics statistics;
      std::vector<PartTurn::OpenFace> open_faces;
      bool kept = false;
    };
    std::vector<Result> results(cells_of_leaf.size());
    executor_(cells_of_leaf.size(), [&](std::size_t i, std::size_t) {
      if (thread_.stopped() || cells_of_leaf[i].empty()) return;
      PartTurn turn(state, cells_of_leaf[i], first_source, settings, first + static_cast<index_t>(i));
      results[i].state = turn.run(thread_.part("assembly"));
      results[i].statistics = turn.statistics;
      results[i].open_faces = std::move(turn.open_faces);
      results[i].kept = turn.kept;
    });
    if (thread_.stopped()) return;
    state = {};
    open_faces_.clear();
    leaf_of_cell_.clear();
    for (std::size_t i = 0; i < results.size(); ++i) {
      Result& result = results[i];
      leaf_of_cell_.resize(leaf_of_cell_.size() + result.state.cells.size(), first + static_cast<index_t>(i));
      state.append(std::move(result.state));
      result.state = {};
      open_faces_.insert(open_faces_.end(), result.open_faces.begin(), result.open_faces.end());
      add(result.statistics);
      n_kept += result.kept ? 1 : 0;
    }
    state.tidy();
  }

  void add(const AssemblyStatistics& s) {
    statistics.n_merged += s.n_merged;
    statistics.n_raised += s.n_raised;
    statistics.n_split += s.n_split;
    statistics.n_dissolved += s.n_dissolved;
  }

  /// Counts the faces whose other side no part has. Collective.
  void match(const Partition& partition) {
    using OpenFace = PartTurn::OpenFace;
    Rows<OpenFace> rows = make_rows<OpenFace>(transport_);
    for (const OpenFace& face : open_faces_)
      rows[static_cast<std::size_t>(partition.rank(partition.leaf_at(point_at(face.centre))))].push_back(face);
    open_faces_.clear();
    std::vector<OpenFace> faces = send_joined(transport_, std::move(rows));
    std::sort(faces.begin(), faces.end(), [](const OpenFace& a, const OpenFace& b) {
      return std::tie(a.vertices, a.side) < std::tie(b.vertices, b.side);
    });
    std::int64_t n = 0;
    unmatched_vertices_.clear();
    for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
      while (end < faces.size() && faces[end].vertices == faces[i].vertices) ++end;
      if (end - i == 2 && faces[i].side != faces[i + 1].side) continue;
      n += static_cast<std::int64_t>(end - i);
      for (const global_t v : faces[i].vertices)
        if (v >= 0 && v < first_new_vertex) unmatched_vertices_.push_back(v);
    }
    n_unmatched_ = sum_of(transport_, n);
  }

  const Tr& transport_;
  Vector3 low_, high_;
  const AssemblyOptions& options_;
  const E& executor_;
  CallingThread& thread_;
  std::optional<Partition> partition_;
  std::vector<index_t> leaf_of_cell_;
  std::vector<PartTurn::OpenFace> open_faces_;
  std::int64_t n_unmatched_ = 0;
  std::vector<global_t> unmatched_vertices_;
  std::size_t n_turns_ = 0;
};

}  // namespace framehex::detail
