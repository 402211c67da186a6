// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/mesh/csr.hpp"
#include "framehex/selection/conflict_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace framehex {

namespace detail {
struct GraphAccess;
}

/// Which candidates exclude one another, and what each is worth.
///
/// An undirected graph in compressed rows: candidate v's row lists, ascending, every candidate that cannot stand in one
/// mesh with v. Models Boost.Graph's VertexListGraph, AdjacencyGraph, IncidenceGraph and AdjacencyMatrix through
/// selection/boost_graph_adaptor.hpp.
///
/// Weights are kept as 64-bit multiples of one power of two, `unit()`, chosen so that the sum of all of them is exact
/// in a double: totals do not depend on the order of summation, and a bound that equals a weight is a proof. Integer
/// weights whose sum is below 2^52 have the unit 1 and are kept as they are; others are rounded to about 2^-51 of n
/// times the largest.
///
/// @par Complexity  8 bytes a conflict, 16 bytes a candidate.
/// @par Source      Paper, section 2.2, graph G'.
class IncompatibilityGraph {
public:
  IncompatibilityGraph() = default;

  /// @param neighbours  a row per candidate, each strictly ascending; u is in v's row when v is in u's.
  /// @param weights     a weight per candidate, dimensionless, finite, >= 0.
  /// @throws invalid_graph   with the candidate whose row is out of range, out of order, holds the candidate itself, or
  ///                         is not mirrored by the rows it names; or when the sizes differ.
  /// @throws invalid_weight  with the candidate.
  /// @par Complexity   O(n + conflicts).
  IncompatibilityGraph(Csr<index_t> neighbours, std::span<const double> weights);

  std::size_t size() const { return weights_.size(); }
  bool empty() const { return weights_.empty(); }
  /// Number of conflicts: each counted once.
  std::size_t n_conflicts() const { return neighbours_.values.size() / 2; }
  std::span<const index_t> neighbours(index_t v) const { return neighbours_[v]; }
  std::size_t degree(index_t v) const { return neighbours_[v].size(); }
  /// @par Complexity  O(log degree).
  bool adjacent(index_t u, index_t v) const {
    const auto row = neighbours_[u];
    return std::binary_search(row.begin(), row.end(), v);
  }

  bool conflicts(index_t u, index_t v) const { return adjacent(u, v); }
  /// Ascending.
  template <class Found>
  void for_each_conflict(index_t v, Found&& found) const {
    for (const index_t u : neighbours(v)) found(u);
  }

  double weight(index_t v) const { return static_cast<double>(weights_[v]) * unit_; }
  /// The weight of one step: a power of two.
  double unit() const { return unit_; }
  /// Weights in units; the sum of all is below 2^53.
  std::span<const std::int64_t> weights_in_units() const { return weights_; }
  const Csr<index_t>& rows() const { return neighbours_; }

private:
  friend struct detail::GraphAccess;
  Csr<index_t> neighbours_;
  std::vector<std::int64_t> weights_;
  double unit_ = 1.0;
};

static_assert(ConflictSource<IncompatibilityGraph>);

namespace detail {

/// Weights as multiples of a power of two whose sum is exact in a double.
struct QuantisedWeights {
  std::vector<std::int64_t> values;
  double unit = 1.0;
};

/// @throws invalid_weight  with the candidate.
inline QuantisedWeights quantise(std::span<const double> weights) {
  double largest = 0;
  bool integral = true;
  for (std::size_t v = 0; v < weights.size(); ++v) {
    const double w = weights[v];
    if (!(w >= 0) || !std::isfinite(w))
      throw invalid_weight("candidate " + std::to_string(v) + " has the weight " + std::to_string(w) +
                               "; a finite weight >= 0 is needed",
                           Entity::candidate, {v});
    largest = std::max(largest, w);
    integral = integral && w == std::floor(w);
  }
  QuantisedWeights result;
  // The number of candidates times the largest weight, not the sum, which depends on the numbering in its last bit.
  const int n_bits = std::ilogb(static_cast<double>(weights.size()) + 1.0) + 1;
  const int weight_bits = largest > 0 ? std::ilogb(largest) + 1 : 0;
  if (!integral || n_bits + weight_bits > 52) result.unit = std::ldexp(1.0, std::max(n_bits + weight_bits - 52, -1000));
  result.values.reserve(weights.size());
  for (const double w : weights) result.values.push_back(std::llround(w / result.unit));
  return result;
}

[[noreturn]] inline void refuse_graph(std::size_t v, const std::string& why) {
  throw invalid_graph("candidate " + std::to_string(v) + " " + why, Entity::candidate, {v});
}

inline void check_rows(const Csr<index_t>& rows) {
  const std::size_t n = rows.size();
  for (std::size_t v = 0; v < n; ++v) {
    const auto row = rows[v];
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (row[i] >= n) refuse_graph(v, "is in conflict with candidate " + std::to_string(row[i]) + ", out of range");
      if (row[i] == v) refuse_graph(v, "is in conflict with itself");
      if (i > 0 && row[i - 1] >= row[i]) refuse_graph(v, "has a row that does not ascend");
    }
  }
  // Rows that ascend mirror one another exactly when a sweep over v meets each row's entries in order.
  std::vector<offset_t> next(rows.offsets.begin(), rows.offsets.end() - 1);
  for (std::size_t v = 0; v < n; ++v)
    for (const index_t u : rows[v]) {
      if (next[u] >= rows.offsets[u + 1] || rows.values[next[u]] != v)
        refuse_graph(v, "names candidate " + std::to_string(u) + ", which does not name it");
      ++next[u];
    }
}

/// Makes a graph whose rows are known to be sound; for builders that have just made them.
struct GraphAccess {
  static IncompatibilityGraph unchecked(Csr<index_t> neighbours, QuantisedWeights weights) {
    IncompatibilityGraph graph;
    graph.neighbours_ = std::move(neighbours);
    graph.weights_ = std::move(weights.values);
    graph.unit_ = weights.unit;
    return graph;
  }
};

}  // namespace detail

inline IncompatibilityGraph::IncompatibilityGraph(Csr<index_t> neighbours, std::span<const double> weights)
    : neighbours_(std::move(neighbours)) {
  if (neighbours_.size() != weights.size())
    throw invalid_graph("a graph of " + std::to_string(neighbours_.size()) + " rows has " +
                        std::to_string(weights.size()) + " weights");
  detail::check_rows(neighbours_);
  auto quantised = detail::quantise(weights);
  weights_ = std::move(quantised.values);
  unit_ = quantised.unit;
}

/// Graph of a list of conflicts, for hosts that have their own rules.
///
/// @param weights    one per candidate, finite, >= 0.
/// @param conflicts  pairs of candidates in any order; a pair given twice, or both ways, counts once.
/// @throws invalid_graph   with the candidate, when an id is out of range or a pair names one candidate twice.
/// @throws invalid_weight  with the candidate.
/// @par Complexity   O(n + conflicts log degree).
inline IncompatibilityGraph make_incompatibility_graph(std::span<const double> weights,
                                                       std::span<const std::array<index_t, 2>> conflicts) {
  for (const auto& [u, v] : conflicts) {
    if (u >= weights.size()) detail::refuse_graph(u, "of a conflict is out of range");
    if (v >= weights.size()) detail::refuse_graph(v, "of a conflict is out of range");
    if (u == v) detail::refuse_graph(u, "is in conflict with itself");
  }
  auto quantised = detail::quantise(weights);
  Csr<index_t> all = make_csr(weights.size(), [&](auto&& put) {
    for (const auto& [u, v] : conflicts) {
      put(u, v);
      put(v, u);
    }
  });
  Csr<index_t> rows;
  rows.offsets.reserve(all.offsets.size());
  rows.values.reserve(all.values.size());
  for (std::size_t v = 0; v < all.size(); ++v) {
    auto row = all[v];
    std::sort(row.begin(), row.end());
    rows.values.insert(rows.values.end(), row.begin(), std::unique(row.begin(), row.end()));
    rows.end_row();
  }
  return detail::GraphAccess::unchecked(std::move(rows), std::move(quantised));
}

/// A row of the paper's Table 1.
struct GraphStatistics {
  std::size_t n_candidates = 0;
  std::size_t n_conflicts = 0;
  double mean_degree = 0;  ///< the paper's C(G')
  std::size_t largest_degree = 0;
  std::size_t n_components = 0;
  std::size_t largest_component = 0;
};

/// @param graph  stored, or implicit, which takes some 50 microseconds a candidate.
/// @par Complexity  O(n + conflicts); 4 bytes a candidate.
template <ConflictSource G>
GraphStatistics statistics(const G& graph) {
  GraphStatistics s;
  s.n_candidates = graph.size();
  if (s.n_candidates == 0) return s;
  std::vector<std::uint8_t> reached(graph.size(), 0);
  std::vector<index_t> stack;
  for (index_t root = 0; root < graph.size(); ++root) {
    if (reached[root]) continue;
    ++s.n_components;
    std::size_t n = 0;
    stack.assign(1, root);
    reached[root] = 1;
    while (!stack.empty()) {
      const index_t v = stack.back();
      stack.pop_back();
      ++n;
      std::size_t degree = 0;
      graph.for_each_conflict(v, [&](index_t u) {
        ++degree;
        if (reached[u]) return;
        reached[u] = 1;
        stack.push_back(u);
      });
      s.n_conflicts += degree;
      s.largest_degree = std::max(s.largest_degree, degree);
    }
    s.largest_component = std::max(s.largest_component, n);
  }
  s.mean_degree = static_cast<double>(s.n_conflicts) / static_cast<double>(s.n_candidates);
  s.n_conflicts /= 2;
  return s;
}

}  // namespace framehex
