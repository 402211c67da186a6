// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/detail/canonical_order.hpp"
#include "framehex/selection/selection.hpp"

#include <bit>
#include <iterator>

namespace framehex {

/// Cliques of an incompatibility graph that together hold every conflict: of each clique at most one member can be
/// selected. A candidate without conflicts is in none.
struct CliqueCover {
  Csr<index_t> cliques;            ///< members of each, ascending; each is a maximal clique
  Csr<index_t> cliques_of_vertex;  ///< ascending

  std::size_t size() const { return cliques.size(); }
};

namespace detail {

/// The neighbours of one candidate as a bit matrix, from which maximal cliques through that candidate are grown.
/// Neighbour i is number i + 1; bit 0 takes what is no neighbour, so that filling a row needs no branches. Rows are
/// filled when they are first read: most candidates have few conflicts left to cover, and those touch few rows.
class NeighbourhoodMatrix {
public:
  explicit NeighbourhoodMatrix(std::size_t n_vertices) : local_(n_vertices, 0) {}

  void assign(const IncompatibilityGraph& graph, index_t centre) {
    graph_ = &graph;
    for (const index_t u : members_) local_[u] = 0;
    const auto row = graph.neighbours(centre);
    members_.assign(row.begin(), row.end());
    n_words_ = members_.size() / 64 + 1;
    for (std::size_t i = 0; i < members_.size(); ++i) local_[members_[i]] = static_cast<index_t>(i + 1);
    bits_.resize((members_.size() + 1) * n_words_);
    filled_.assign(members_.size() + 1, 0);
  }

  index_t member(index_t number) const { return members_[number - 1]; }

  /// Grows a clique from the neighbour `seed`, preferring those with many common neighbours and, among these, `wanted`
  /// ones. `clique` receives numbers.
  void grow(index_t seed, std::span<const std::uint64_t> wanted, std::vector<index_t>& clique) {
    clique.assign(1, seed);
    const std::uint64_t* const neighbours = row(seed);
    open_.assign(neighbours, neighbours + n_words_);
    open_[0] &= ~std::uint64_t{1};
    scores_.resize(members_.size() + 1);
    for_each_open([&](std::size_t i) {
      const std::uint64_t* const bits = row(i);
      int common = 0;
      for (std::size_t w = 0; w < n_words_; ++w) common += std::popcount(open_[w] & bits[w]);
      scores_[i] = 4 * common + ((wanted[i / 64] >> (i % 64)) & 1U ? 3 : 0);
    });
    for (;;) {
      std::size_t best = 0;
      for_each_open([&](std::size_t i) {
        if (best == 0 || scores_[i] > scores_[best]) best = i;
      });
      if (best == 0) return;
      clique.push_back(static_cast<index_t>(best));
      const std::uint64_t* const bits = row(best);
      for (std::size_t w = 0; w < n_words_; ++w) open_[w] &= bits[w];
    }
  }

private:
  const std::uint64_t* row(std::size_t i) {
    std::uint64_t* const bits = bits_.data() + i * n_words_;
    if (filled_[i]) return bits;
    filled_[i] = 1;
    std::fill(bits, bits + n_words_, 0);
    for (const index_t u : graph_->neighbours(members_[i - 1])) {
      const index_t number = local_[u];
      bits[number / 64] |= std::uint64_t{1} << (number % 64);
    }
    return bits;
  }

  template <class Body>
  void for_each_open(Body&& body) const {
    for (std::size_t word = 0; word < n_words_; ++word)
      for (std::uint64_t rest = open_[word]; rest != 0; rest &= rest - 1)
        body(64 * word + static_cast<std::size_t>(std::countr_zero(rest)));
  }

  const IncompatibilityGraph* graph_ = nullptr;
  std::vector<index_t> local_, members_;
  std::vector<std::uint64_t> bits_, open_;
  std::vector<std::uint8_t> filled_;
  std::vector<int> scores_;
  std::size_t n_words_ = 0;
};

/// Which conflicts some clique holds already: a bit for each entry of the graph's rows.
class CoveredConflicts {
public:
  explicit CoveredConflicts(const IncompatibilityGraph& graph)
      : graph_(graph), bits_((graph.rows().values.size() + 63) / 64, 0) {}

  bool covered(offset_t entry) const { return (bits_[entry / 64] >> (entry % 64)) & 1U; }

  /// Only the entry in the smaller one's row is kept up to date.
  void cover(std::span<const index_t> clique) {
    for (std::size_t i = 0; i + 1 < clique.size(); ++i) {
      const auto row = graph_.neighbours(clique[i]);
      auto position = row.begin();
      for (std::size_t j = i + 1; j < clique.size(); ++j) {
        position = std::lower_bound(position, row.end(), clique[j]);
        const offset_t entry =
            graph_.rows().offsets[clique[i]] + static_cast<offset_t>(std::distance(row.begin(), position));
        bits_[entry / 64] |= std::uint64_t{1} << (entry % 64);
      }
    }
  }

private:
  const IncompatibilityGraph& graph_;
  std::vector<std::uint64_t> bits_;
};

/// Extends cliques to maximal ones.
class CliqueGrower {
public:
  explicit CliqueGrower(const IncompatibilityGraph& graph) : graph_(graph) {}

  /// Adds common neighbours of the members, always the one with the largest `score(v)` next, the smallest among equals.
  ///
  /// @param clique  not empty; receives the new members behind the old.
  template <class Score>
  void extend(std::vector<index_t>& clique, Score&& score) {
    extend(clique, score, [](index_t) { return true; });
  }

  /// @param allowed  only such candidates are added.
  template <class Score, class Allowed>
  void extend(std::vector<index_t>& clique, Score&& score, Allowed&& allowed) {
    open_.clear();
    for (const index_t v : graph_.neighbours(clique[0]))
      if (allowed(v)) open_.push_back(v);
    for (std::size_t i = 1; i < clique.size(); ++i) keep_neighbours_of(clique[i]);
    while (!open_.empty()) {
      clique.push_back(
          *std::max_element(open_.begin(), open_.end(), [&](index_t u, index_t v) { return score(u) < score(v); }));
      keep_neighbours_of(clique.back());
    }
  }

private:
  void keep_neighbours_of(index_t v) {
    const auto row = graph_.neighbours(v);
    if (16 * open_.size() < row.size()) {
      std::erase_if(open_, [&](index_t u) { return !std::binary_search(row.begin(), row.end(), u); });
      return;
    }
    kept_.resize(open_.size());
    std::size_t n = 0;
    // Steps both lists without branches: which one is behind cannot be foreseen.
    for (std::size_t i = 0, j = 0; i < open_.size() && j < row.size();) {
      const index_t u = open_[i], w = row[j];
      kept_[n] = u;
      n += u == w;
      i += u <= w;
      j += w <= u;
    }
    kept_.resize(n);
    open_.swap(kept_);
  }

  const IncompatibilityGraph& graph_;
  std::vector<index_t> open_, kept_;
};

inline Csr<index_t> transpose(const Csr<index_t>& rows, std::size_t n_columns) {
  return make_csr(n_columns, [&](auto&& put) {
    for (std::size_t row = 0; row < rows.size(); ++row)
      for (const index_t column : rows[row]) put(column, static_cast<index_t>(row));
  });
}

}  // namespace detail

/// Covers the conflicts by maximal cliques, one grown greedily for each conflict that no earlier one holds.
///
/// @return 1.5 to 2.5 cliques a candidate on graphs of potential hexahedra, of 12 to 24 members.
/// @par Complexity   O(n d^2) for the mean degree d; an eighth of a byte an entry of the graph besides the result.
/// @param stop  asked for each candidate; when it says so, conflicts are left uncovered (which a bound can do with).
/// @par Determinism  Serial, by number.
template <class Stop>
CliqueCover cover_by_cliques(const IncompatibilityGraph& graph, Stop&& stop) {
  CliqueCover cover;
  detail::NeighbourhoodMatrix matrix(graph.size());
  detail::CoveredConflicts conflicts(graph);
  std::vector<index_t> clique;
  std::vector<std::uint64_t> wanted;
  for (index_t v = 0; v < graph.size() && !(v % 64 == 0 && stop()); ++v) {
    const auto row = graph.neighbours(v);
    const offset_t first = graph.rows().offsets[v];
    wanted.assign(row.size() / 64 + 1, 0);
    bool any = false;
    for (std::size_t i = 0; i < row.size(); ++i)
      if (row[i] > v && !conflicts.covered(first + i)) {
        wanted[(i + 1) / 64] |= std::uint64_t{1} << ((i + 1) % 64);
        any = true;
      }
    if (!any) continue;
    matrix.assign(graph, v);
    for (std::size_t word = 0; word < wanted.size(); ++word)
      while (wanted[word] != 0) {
        matrix.grow(static_cast<index_t>(64 * word) + static_cast<index_t>(std::countr_zero(wanted[word])), wanted,
                    clique);
        for (index_t& u : clique) {
          wanted[u / 64] &= ~(std::uint64_t{1} << (u % 64));
          u = matrix.member(u);
        }
        clique.push_back(v);
        std::sort(clique.begin(), clique.end());
        conflicts.cover(clique);
        cover.cliques.values.insert(cover.cliques.values.end(), clique.begin(), clique.end());
        cover.cliques.end_row();
      }
  }
  cover.cliques_of_vertex = detail::transpose(cover.cliques, graph.size());
  return cover;
}

inline CliqueCover cover_by_cliques(const IncompatibilityGraph& graph) {
  return cover_by_cliques(graph, [] { return false; });
}

/// Parts the candidates into cliques, `n_partitions` times over and at random.
///
/// A lean start for a relaxation of a large graph: most conflicts are in no clique, and those that matter are found by
/// what the relaxation overfills.
///
/// @par Complexity   O(n d) a partition, for the mean degree d; n entries a partition.
/// @param stop  asked now and then; when it says so, the rest is left out.
/// @par Determinism  Serial; the random order is that of the numbers, scrambled.
template <class Stop>
CliqueCover cover_by_partitions(const IncompatibilityGraph& graph, std::uint64_t n_partitions, Stop&& stop) {
  CliqueCover cover;
  detail::CliqueGrower grower(graph);
  std::vector<std::uint64_t> key(graph.size());
  std::vector<index_t> order(graph.size()), clique;
  std::vector<std::uint8_t> used;
  for (std::uint64_t partition = 0; partition < n_partitions; ++partition) {
    for (index_t v = 0; v < graph.size(); ++v) key[v] = detail::scramble(n_partitions * v + partition);
    std::iota(order.begin(), order.end(), index_t{0});
    std::sort(order.begin(), order.end(), [&](index_t u, index_t v) { return key[u] > key[v]; });
    used.assign(graph.size(), 0);
    for (const index_t v : order) {
      if (v % 64 == 0 && stop()) break;
      if (used[v]) continue;
      clique.assign(1, v);
      grower.extend(
          clique, [&](index_t u) { return key[u]; }, [&](index_t u) { return !used[u]; });
      for (const index_t u : clique) used[u] = 1;
      if (clique.size() == 1) continue;
      std::sort(clique.begin(), clique.end());
      cover.cliques.values.insert(cover.cliques.values.end(), clique.begin(), clique.end());
      cover.cliques.end_row();
    }
  }
  cover.cliques_of_vertex = detail::transpose(cover.cliques, graph.size());
  return cover;
}

/// Rough upper bound on every selection, in units: the candidates are parted into cliques, each of which pays for its
/// dearest member.
///
/// @param key  breaks ties: the bound depends on the numbers of the candidates only where keys are equal.
/// @par Complexity  O(n d) for the mean degree d.
template <class Key>
std::int64_t partition_bound(const IncompatibilityGraph& graph, Key&& key) {
  std::vector<index_t> order(graph.size()), rank(graph.size()), clique;
  std::iota(order.begin(), order.end(), index_t{0});
  std::sort(order.begin(), order.end(), detail::heavier_first(graph, key));
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<index_t>(i);
  detail::CliqueGrower grower(graph);
  std::vector<std::uint8_t> used(graph.size(), 0);
  std::int64_t bound = 0;
  for (const index_t v : order) {
    if (used[v]) continue;
    clique.assign(1, v);
    // Dear ones are best paid for by one still dearer.
    grower.extend(
        clique, [&](index_t u) { return ~rank[u]; }, [&](index_t u) { return !used[u]; });
    for (const index_t u : clique) used[u] = 1;
    bound += graph.weights_in_units()[v];
  }
  return bound;
}

inline std::int64_t partition_bound(const IncompatibilityGraph& graph) {
  return partition_bound(graph, [](index_t v) { return v; });
}

}  // namespace framehex
