// SPDX-License-Identifier: BSL-1.0
// Prints matching problems of random meshes and what LEMON finds: n_vertices, n_edges, n_pairs, cost, then a, b, cost of
// each edge.
#include "framehex/adapters/boost_matcher.hpp"
#include "framehex/adapters/lemon_matcher.hpp"
#include "framehex/quads/detail/pairing_graph.hpp"

#include "support/flat_delaunay.hpp"

#include <cstdio>

using namespace framehex;

int main() {
  std::mt19937_64 engine(7);
  for (std::size_t i = 0; i < 12; ++i) {
    const Surface surface(test::flat_delaunay(test::random_flat_points(15 + 3 * i, engine)));
    const detail::PatchSides sides(surface);
    detail::PairingGraph graph(surface, sides, {}, 0);
    if (i % 3 > 0) graph.add_openings_on_curves(2);
    if (i % 3 > 1) graph.add_openings_everywhere(3);
    const std::size_t n = surface.triangles().size();
    const auto& edges = graph.edges();
    const std::vector<index_t> mate = LemonMatcher{}(n, edges), other = BoostMatcher{}(n, edges);
    std::size_t n_pairs = 0, n_other = 0;
    long long cost = 0;
    for (const MatchingEdge& e : edges) {
      n_pairs += mate[e.a] == e.b;
      n_other += other[e.a] == e.b;
      cost += mate[e.a] == e.b ? e.cost : 0;
    }
    if (n_pairs != n_other) return 1;
    std::printf("%zu %zu %zu %lld\n", n, edges.size(), n_pairs, cost);
    for (const MatchingEdge& e : edges) std::printf("%u %u %lld\n", e.a, e.b, static_cast<long long>(e.cost));
  }
  return 0;
}
