// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace framehex {

/// Two vertices of a graph that may be joined, and what that costs.
struct MatchingEdge {
  index_t a, b;       ///< different vertices
  std::int64_t cost;  ///< >= 0; whole numbers, so that sums are exact
};

/// Joins the vertices of a graph in pairs.
///
/// `matcher(n_vertices, edges)` returns the mate of each vertex, `no_index` for those left alone. One that is called
/// exact joins as many vertices as can be, and of all ways to do so takes one of the least total cost.
template <class M>
concept Matcher = requires(const M& matcher, std::size_t n, std::span<const MatchingEdge> edges) {
  { matcher(n, edges) } -> std::same_as<std::vector<index_t>>;
};

/// Any matcher, by reference: what takes it is compiled once for all of them. It must outlive the reference.
class MatcherRef {
public:
  template <Matcher M>
  requires(!std::same_as<M, MatcherRef>)
      MatcherRef(const M& matcher)  // NOLINT: whoever takes any matcher is meant to be called with that
      : matcher_(&matcher), call_([](const void* m, std::size_t n, std::span<const MatchingEdge> edges) {
          return (*static_cast<const M*>(m))(n, edges);
        }) {}

  std::vector<index_t> operator()(std::size_t n, std::span<const MatchingEdge> edges) const {
    return call_(matcher_, n, edges);
  }

private:
  const void* matcher_;
  std::vector<index_t> (*call_)(const void* matcher, std::size_t n, std::span<const MatchingEdge> edges);
};

namespace detail {

/// Positions of edges, the cheapest first, equal ones in their order.
inline std::vector<std::size_t> by_cost(std::span<const MatchingEdge> edges) {
  std::vector<std::size_t> order(edges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return edges[i].cost < edges[j].cost; });
  return order;
}

}  // namespace detail

/// Joins the cheapest pair first; leaves vertices alone whose neighbours are all taken. Not exact.
///
/// @par Complexity   O(n log n).
/// @par Determinism  Ties go to the edge that comes first.
struct GreedyMatcher {
  std::vector<index_t> operator()(std::size_t n_vertices, std::span<const MatchingEdge> edges) const {
    std::vector<index_t> mate(n_vertices, no_index);
    for (const std::size_t i : detail::by_cost(edges)) {
      const auto [a, b, cost] = edges[i];
      if (mate[a] != no_index || mate[b] != no_index) continue;
      mate[a] = b;
      mate[b] = a;
    }
    return mate;
  }
};

static_assert(Matcher<GreedyMatcher>);

}  // namespace framehex
