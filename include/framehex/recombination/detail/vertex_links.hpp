// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/adjacency.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace framehex::detail {

/// "Is (v, w, x) a facet of the mesh", and which x are, in a few instructions.
///
/// The link of a vertex v is a graph on its neighbours: w and x are linked when (v, w, x) is a facet. Neighbours are
/// named by their position in the ascending list; a row of the graph is one 64-bit word for valences up to 64 and an
/// ascending list of positions beyond, so that memory stays linear whatever the valence.
class VertexLinks {
public:
  /// @param reach  how far apart the two triangles of a quadrilateral may be, in tetrahedra round its diagonal. Matters
  ///               round edges with very many tetrahedra, where any two triangles would make one otherwise.
  explicit VertexLinks(const TetAdjacency& adjacency, std::size_t reach = static_cast<std::size_t>(-1))
      : neighbours_(&adjacency.vertices_of_vertex), reach_(reach) {
    bits_.assign(neighbours_->values.size(), 0);
    std::vector<std::pair<index_t, index_t>> links;
    for (index_t v = 0; v < adjacency.n_vertices(); ++v) {
      const bool heavy = is_heavy(v);
      links.clear();
      for (const index_t tet : adjacency.tets_of_vertex[v]) {
        std::array<index_t, 3> p{};
        std::size_t n = 0;
        for (const index_t w : adjacency.tets[tet])
          if (w != v) p[n++] = position(v, w);
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j) {
            if (i == j) continue;
            if (heavy)
              links.emplace_back(p[i], p[j]);
            else
              bits_[row(v, p[i])] |= std::uint64_t{1} << p[j];
          }
      }
      if (heavy) store_heavy(v, links);
    }
  }

  std::span<const index_t> neighbours(index_t v) const { return (*neighbours_)[v]; }
  bool is_heavy(index_t v) const { return neighbours(v).size() > 64; }

  /// Position of w among the neighbours of v, or `no_index`.
  index_t position(index_t v, index_t w) const {
    const auto ring = neighbours(v);
    const index_t* first = ring.data();
    std::size_t n = ring.size();
    while (n > 1) {
      const std::size_t half = n / 2;
      first += first[half] <= w ? half : 0;
      n -= half;
    }
    return n == 1 && *first == w ? static_cast<index_t>(first - ring.data()) : no_index;
  }

  bool are_linked(index_t v, index_t i, index_t j) const {
    if (!is_heavy(v)) return bits_[row(v, i)] >> j & 1;
    const auto links = heavy_row(v, i);
    return std::binary_search(links.begin(), links.end(), j);
  }

  /// Calls f(j) for the positions j linked to i.
  template <class F>
  void for_each_link(index_t v, index_t i, F&& f) const {
    if (is_heavy(v))
      for (const index_t j : heavy_row(v, i)) f(j);
    else
      for_each_bit(bits_[row(v, i)], f);
  }

  /// Calls f(j) for the positions j linked to i: on a crowded edge only for those within reach of position `start`, and
  /// for `start`.
  template <class F>
  void for_each_link_in_reach(index_t v, index_t i, index_t start, F&& f) const {
    if (!is_heavy(v) || heavy_row(v, i).size() <= crowded) return for_each_link(v, i, f);
    std::vector<index_t> reached{start};
    std::size_t next = 0;
    for (std::size_t step = 0; step < reach_ && next < reached.size(); ++step)
      for (const std::size_t end = reached.size(); next < end; ++next)
        for_each_common_link(v, i, reached[next], [&reached](index_t k) {
          if (std::ranges::find(reached, k) == reached.end()) reached.push_back(k);
        });
    for (const index_t j : reached) f(j);
  }

  /// Calls f(k) for the positions k linked to both i and j.
  template <class F>
  void for_each_common_link(index_t v, index_t i, index_t j, F&& f) const {
    if (!is_heavy(v)) return for_each_bit(bits_[row(v, i)] & bits_[row(v, j)], f);
    auto few = heavy_row(v, i), many = heavy_row(v, j);
    if (few.size() > many.size()) std::swap(few, many);
    for (const index_t k : few)
      if (std::ranges::binary_search(many, k)) f(k);
  }

  bool is_facet(index_t u, index_t v, index_t w) const {
    const index_t i = position(u, v), j = position(u, w);
    return i != no_index && j != no_index && are_linked(u, i, j);
  }

  /// Whether for_each_opposite(v, i, j) would give that vertex, reach or not.
  bool is_opposite(index_t v, index_t i, index_t j, index_t opposite) const {
    const index_t known = position(v, opposite);
    if (known != no_index && are_linked(v, i, known) && are_linked(v, j, known)) return true;
    return are_linked(v, i, j) && is_facet(neighbours(v)[i], neighbours(v)[j], opposite);
  }

  /// Calls f(opposite) for each vertex that makes a quadrilateral with v between its neighbours at i and j: for one of
  /// the two diagonals, both triangles are facets, in reach of one another. Each vertex once.
  template <class F>
  void for_each_opposite(index_t v, index_t i, index_t j, F&& f) const {
    const auto ring = neighbours(v);
    for_each_common_link(v, i, j, [&](index_t k) { f(ring[k]); });
    if (!are_linked(v, i, j)) return;
    const index_t w = ring[i], x = ring[j];
    const auto others = neighbours(w);
    for_each_link_in_reach(w, position(w, x), position(w, v), [&](index_t k) {
      const index_t opposite = others[k];
      if (opposite == v) return;
      const index_t known = position(v, opposite);
      if (known == no_index || !are_linked(v, i, known) || !are_linked(v, j, known)) f(opposite);
    });
  }

private:
  std::size_t row(index_t v, index_t i) const { return neighbours_->offsets[v] + i; }

  template <class F>
  static void for_each_bit(std::uint64_t word, F&& f) {
    for (; word != 0; word &= word - 1) f(static_cast<index_t>(std::countr_zero(word)));
  }

  void store_heavy(index_t v, std::vector<std::pair<index_t, index_t>>& links) {
    std::sort(links.begin(), links.end());
    links.erase(std::unique(links.begin(), links.end()), links.end());
    // The word of a heavy row holds where its list is.
    std::size_t next = 0;
    for (index_t i = 0; i < neighbours(v).size(); ++i) {
      bits_[row(v, i)] = heavy_.size();
      for (; next < links.size() && links[next].first == i; ++next) heavy_.values.push_back(links[next].second);
      heavy_.end_row();
    }
  }

  std::span<const index_t> heavy_row(index_t v, index_t i) const { return heavy_[bits_[row(v, i)]]; }

  static constexpr std::size_t crowded = 16;

  const Csr<index_t>* neighbours_;
  std::size_t reach_;
  std::vector<std::uint64_t> bits_;
  Csr<index_t> heavy_;
};

}  // namespace framehex::detail
