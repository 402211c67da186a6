// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/recombination/detail/cell_interior.hpp"
#include "framehex/recombination/detail/cell_values.hpp"

#include <memory>

namespace framehex::detail {

/// Applies the rules of one kind of cell to what its search proposes. Scratch memory for one thread.
template <int Corners, class Search>
class CellFinder {
public:
  explicit CellFinder(const FinderInput& input) : input_(&input), search_(input), interior_(input) {}

  /// Appends the cells with smallest vertex `a`.
  void find(index_t a, Candidates<Corners>& found) {
    search_.search(a, [&](const std::array<index_t, static_cast<std::size_t>(Corners)>& vertices) {
      std::array<Vector3, static_cast<std::size_t>(Corners)> corners;
      for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = input_->points()[vertices[i]];
      CellValues values;
      if (!evaluate<kind_with<Corners>>(corners, input_->options().quality_floor, values) || !interior_.fill(vertices))
        return;
      found.vertices.push_back(vertices);
      found.quality.push_back(static_cast<float>(values.quality));
      found.volume.push_back(values.volume);
      append(found.tets, interior_.tets);
      append(found.face_slivers, interior_.slivers);
    });
  }

private:
  static void append(Csr<index_t>& rows, const std::vector<index_t>& row) {
    rows.values.insert(rows.values.end(), row.begin(), row.end());
    rows.end_row();
  }

  const FinderInput* input_;
  Search search_;
  CellInterior<Corners> interior_;
};

/// Runs a search from every vertex, in blocks; the result is in the order of the vertices for any executor.
template <int Corners, class Search, Executor E>
Candidates<Corners> find_cells(const FinderInput& input, const E& executor) {
  constexpr std::size_t block_size = 64;
  const std::size_t n = input.adjacency().n_vertices();
  const std::size_t n_blocks = (n + block_size - 1) / block_size;
  std::vector<Candidates<Corners>> found(n_blocks);
  std::vector<std::unique_ptr<CellFinder<Corners, Search>>> finders(executor.workers());
  executor(n_blocks, [&](std::size_t block, std::size_t worker) {
    auto& finder = finders[worker];
    if (!finder) finder = std::make_unique<CellFinder<Corners, Search>>(input);
    for (std::size_t v = block * block_size; v < std::min(n, (block + 1) * block_size); ++v)
      finder->find(static_cast<index_t>(v), found[block]);
  });
  Candidates<Corners> all;
  for (auto& part : found) {
    const auto concatenate = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    const auto concatenate_rows = [](Csr<index_t>& to, const Csr<index_t>& from) {
      for (std::size_t i = 0; i < from.size(); ++i) {
        to.values.insert(to.values.end(), from[i].begin(), from[i].end());
        to.end_row();
      }
    };
    concatenate(all.vertices, part.vertices);
    concatenate(all.quality, part.quality);
    concatenate(all.volume, part.volume);
    concatenate_rows(all.tets, part.tets);
    concatenate_rows(all.face_slivers, part.face_slivers);
    part = {};
  }
  return all;
}

}  // namespace framehex::detail
