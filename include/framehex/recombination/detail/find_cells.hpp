// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/recombination/detail/cell_interior.hpp"
#include "framehex/recombination/detail/cell_values.hpp"

#include <atomic>
#include <memory>
#include <mutex>

namespace framehex::detail {

template <int Corners>
void reserve(Candidates<Corners>& c, std::size_t n, std::size_t n_tets, std::size_t n_slivers) {
  c.vertices.reserve(n);
  c.quality.reserve(n);
  c.volume.reserve(n);
  c.tets.offsets.reserve(n + 1);
  c.tets.values.reserve(n_tets);
  c.face_slivers.offsets.reserve(n + 1);
  c.face_slivers.values.reserve(n_slivers);
}

template <int Corners>
void clear(Candidates<Corners>& c) {
  c.vertices.clear();
  c.quality.clear();
  c.volume.clear();
  for (Csr<index_t>* rows : {&c.tets, &c.face_slivers}) {
    rows->offsets.resize(1);
    rows->values.clear();
  }
}

inline void append(Csr<index_t>& to, const Csr<index_t>& from) {
  const offset_t shift = to.values.size();
  to.values.insert(to.values.end(), from.values.begin(), from.values.end());
  for (std::size_t i = 1; i < from.offsets.size(); ++i) to.offsets.push_back(shift + from.offsets[i]);
}

template <int Corners>
void append(Candidates<Corners>& to, const Candidates<Corners>& from) {
  to.vertices.insert(to.vertices.end(), from.vertices.begin(), from.vertices.end());
  to.quality.insert(to.quality.end(), from.quality.begin(), from.quality.end());
  to.volume.insert(to.volume.end(), from.volume.begin(), from.volume.end());
  append(to.tets, from.tets);
  append(to.face_slivers, from.face_slivers);
}

/// Applies the rules of one kind of cell to what its search proposes. Scratch memory for one thread.
template <int Corners, class Search>
class CellFilter {
public:
  explicit CellFilter(const FinderInput& input) : input_(&input), search_(input), interior_(input) {}

  /// Appends the cells that the search finds at vertex `a`.
  void find(index_t a, Candidates<Corners>& found) {
    interior_.start_from(a);
    proposals_.clear();
    search_.search(a, [this](const Cell& vertices) { proposals_.push_back(vertices); });
    // The order of the cells depends on the numbers of the vertices, not on those of the tetrahedra.
    std::sort(proposals_.begin(), proposals_.end());
    for (const Cell& vertices : proposals_) {
      std::array<Vector3, static_cast<std::size_t>(Corners)> corners;
      for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = input_->points()[vertices[i]];
      CellValues values{};
      if (!evaluate<kind_with<Corners>>(corners, input_->options().quality_floor, values) || !interior_.fill(vertices))
        continue;
      found.vertices.push_back(vertices);
      found.quality.push_back(static_cast<float>(values.quality));
      found.volume.push_back(values.volume);
      append_row(found.tets, interior_.tets);
      append_row(found.face_slivers, interior_.slivers);
    }
  }

private:
  using Cell = std::array<index_t, static_cast<std::size_t>(Corners)>;

  static void append_row(Csr<index_t>& rows, const std::vector<index_t>& row) {
    rows.values.insert(rows.values.end(), row.begin(), row.end());
    rows.end_row();
  }

  const FinderInput* input_;
  Search search_;
  CellInterior<Corners> interior_;
  std::vector<Cell> proposals_;
};

/// Runs a search from every vertex in blocks, by any executor, into one result in the order of the vertices.
///
/// A block's cells go straight to the end of the result when all blocks before have, and wait otherwise: no second copy
/// of the result is ever held. It is reserved from a count at one vertex of each block, so that it need not move.
template <int Corners, class Search>
class BlockwiseSearch {
public:
  explicit BlockwiseSearch(const FinderInput& input)
      : input_(&input),
        n_vertices_(input.adjacency().n_vertices()),
        n_blocks_((n_vertices_ + block_size - 1) / block_size) {}

  template <Executor E>
  Candidates<Corners> run(const E& executor) {
    workers_.resize(executor.workers());
    waiting_.resize(n_blocks_);
    const StoppableExecutor watched(executor, [this] {
      const double done = static_cast<double>(next_) / static_cast<double>(n_blocks_);
      return cancelled_ = !keep_going(input_->options().observer, "recombination", done);
    });
    if (n_blocks_ >= 16) reserve_from_sample(watched);
    if (!cancelled_) search_blocks(watched);
    if (cancelled_) result_.status = Status::cancelled;
    return std::move(result_);
  }

private:
  static constexpr std::size_t block_size = 64;

  struct Worker {
    explicit Worker(const FinderInput& input) : filter(input) {}
    CellFilter<Corners, Search> filter;
    Candidates<Corners> found;
  };

  Worker& at(std::size_t worker) {
    if (!workers_[worker]) workers_[worker] = std::make_unique<Worker>(*input_);
    return *workers_[worker];
  }

  template <Executor E>
  void search_blocks(const E& executor) {
    executor(n_blocks_, [&](std::size_t block, std::size_t worker) {
      Worker& w = at(worker);
      for (std::size_t v = block * block_size; v < std::min(n_vertices_, (block + 1) * block_size); ++v)
        w.filter.find(static_cast<index_t>(v), w.found);
      deliver(block, w);
    });
  }

  template <Executor E>
  void reserve_from_sample(const E& executor) {
    std::atomic<std::size_t> n{0}, n_tets{0}, n_slivers{0};
    executor(n_blocks_, [&](std::size_t block, std::size_t worker) {
      Worker& w = at(worker);
      clear(w.found);
      // A place that wanders from block to block, lest all lie on one side of a lattice.
      const std::size_t v = block * block_size + block * 37 % block_size;
      if (v < n_vertices_) w.filter.find(static_cast<index_t>(v), w.found);
      n += w.found.size();
      n_tets += w.found.tets.values.size();
      n_slivers += w.found.face_slivers.values.size();
      clear(w.found);
    });
    // Two standard deviations more than the estimate; what is not needed is never touched.
    const double scale = static_cast<double>(block_size) * (1 + 2 / std::sqrt(static_cast<double>(n_blocks_)));
    const auto scaled = [scale](std::size_t count) {
      return static_cast<std::size_t>(scale * static_cast<double>(count));
    };
    reserve(result_, scaled(n), scaled(n_tets), scaled(n_slivers));
  }

  void deliver(std::size_t block, Worker& worker) {
    const std::lock_guard lock(delivery_);
    if (block != next_) {
      waiting_[block] = std::make_unique<Candidates<Corners>>(std::move(worker.found));
      worker.found = {};
    } else {
      append(result_, worker.found);
      clear(worker.found);
      for (++next_; next_ < n_blocks_ && waiting_[next_]; ++next_) {
        append(result_, *waiting_[next_]);
        waiting_[next_].reset();
      }
    }
  }

  const FinderInput* input_;
  std::size_t n_vertices_, n_blocks_, next_ = 0;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::vector<std::unique_ptr<Candidates<Corners>>> waiting_;
  std::mutex delivery_;
  bool cancelled_ = false;
  Candidates<Corners> result_;
};

/// Filters that wait for the next vertex to be searched: making one takes memory in proportion to the mesh.
template <class Filter>
class FilterPool {
public:
  FilterPool() = default;
  // Filters refer to the input of their finder: a copy of it starts with none.
  FilterPool(const FilterPool&) {}
  FilterPool& operator=(const FilterPool&) {
    idle_.clear();
    return *this;
  }

  /// Calls `use` with a filter that nobody else uses.
  template <class Use>
  void with(const FinderInput& input, Use&& use) {
    std::unique_ptr<Filter> filter;
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        filter = std::move(idle_.back());
        idle_.pop_back();
      }
    }
    if (!filter) filter = std::make_unique<Filter>(input);
    use(*filter);
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(filter));
  }

private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Filter>> idle_;
};

/// What the public finders have in common.
template <int Corners, class Search>
class PotentialCellFinder {
public:
  template <TetMesh Mesh>
  PotentialCellFinder(const Mesh& mesh, const FinderOptions& options) : input_(mesh, options) {}

  /// All cells, in the order of their first vertices.
  template <Executor E = SerialExecutor>
  Candidates<Corners> find(const E& executor = {}) const {
    return search(ExecutorRef(executor));
  }

  /// The cells whose first vertex is `v`: a part of what `find` gives. Safe from several threads at once.
  /// @par Complexity   that of the tetrahedra round `v`; the first call (of a thread, at the same time) O(n_vertices).
  Candidates<Corners> find_at(index_t v) const {
    Candidates<Corners> found;
    filters_.with(input_, [&](auto& filter) { filter.find(v, found); });
    return found;
  }

  const TetAdjacency& adjacency() const { return input_.adjacency(); }

private:
  Candidates<Corners> search(ExecutorRef executor) const {
    return BlockwiseSearch<Corners, Search>(input_).run(executor);
  }

  FinderInput input_;
  mutable FilterPool<CellFilter<Corners, Search>> filters_;
};

}  // namespace framehex::detail
