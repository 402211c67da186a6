// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/incompatibility_graph.hpp"

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
/// Neighbour i is number i + 1; bit 0 takes what is no neighbour, so that filling the matrix needs no branches.
class NeighbourhoodMatrix {
public:
  explicit NeighbourhoodMatrix(std::size_t n_vertices) : local_(n_vertices, 0) {}

  void assign(const IncompatibilityGraph& graph, index_t centre) {
    for (const index_t u : members_) local_[u] = 0;
    const auto row = graph.neighbours(centre);
    members_.assign(row.begin(), row.end());
    n_words_ = members_.size() / 64 + 1;
    for (std::size_t i = 0; i < members_.size(); ++i) local_[members_[i]] = static_cast<index_t>(i + 1);
    bits_.assign((members_.size() + 1) * n_words_, 0);
    for (std::size_t i = 0; i < members_.size(); ++i) {
      std::uint64_t* const bits = bits_.data() + (i + 1) * n_words_;
      for (const index_t u : graph.neighbours(members_[i])) {
        const index_t number = local_[u];
        bits[number / 64] |= std::uint64_t{1} << (number % 64);
      }
    }
  }

  index_t member(index_t number) const { return members_[number - 1]; }

  /// Grows a clique from the neighbour `seed`, preferring those with many common neighbours and, among these, `wanted`
  /// ones. `clique` receives numbers.
  void grow(index_t seed, std::span<const std::uint64_t> wanted, std::vector<index_t>& clique) {
    clique.assign(1, seed);
    open_.assign(row(seed), row(seed) + n_words_);
    open_[0] &= ~std::uint64_t{1};
    scores_.resize(members_.size() + 1);
    for_each_open([&](std::size_t i) {
      int common = 0;
      for (std::size_t w = 0; w < n_words_; ++w) common += std::popcount(open_[w] & row(i)[w]);
      scores_[i] = 4 * common + ((wanted[i / 64] >> (i % 64)) & 1U ? 3 : 0);
    });
    for (;;) {
      std::size_t best = 0;
      for_each_open([&](std::size_t i) {
        if (best == 0 || scores_[i] > scores_[best]) best = i;
      });
      if (best == 0) return;
      clique.push_back(static_cast<index_t>(best));
      for (std::size_t w = 0; w < n_words_; ++w) open_[w] &= row(best)[w];
    }
  }

private:
  const std::uint64_t* row(std::size_t i) const { return bits_.data() + i * n_words_; }

  template <class Body>
  void for_each_open(Body&& body) const {
    for (std::size_t word = 0; word < n_words_; ++word)
      for (std::uint64_t rest = open_[word]; rest != 0; rest &= rest - 1)
        body(64 * word + static_cast<std::size_t>(std::countr_zero(rest)));
  }

  std::vector<index_t> local_, members_;
  std::vector<std::uint64_t> bits_, open_;
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

/// Rough upper bound on every selection, in units: the candidates are parted into cliques, each of which pays for its
/// dearest member.
///
/// @par Complexity  O(n d) for the mean degree d.
inline std::int64_t partition_bound(const IncompatibilityGraph& graph) {
  std::vector<std::uint8_t> used(graph.size(), 0);
  std::vector<index_t> open, kept;
  std::int64_t bound = 0;
  const auto weights = graph.weights_in_units();
  for (index_t v = 0; v < graph.size(); ++v) {
    if (used[v]) continue;
    std::int64_t dearest = weights[v];
    open.clear();
    for (const index_t u : graph.neighbours(v))
      if (!used[u]) open.push_back(u);
    while (!open.empty()) {
      const index_t u = open.front();
      used[u] = 1;
      dearest = std::max(dearest, weights[u]);
      const auto row = graph.neighbours(u);
      kept.clear();
      std::set_intersection(open.begin(), open.end(), row.begin(), row.end(), std::back_inserter(kept));
      open.swap(kept);
    }
    bound += dearest;
  }
  return bound;
}

}  // namespace framehex
