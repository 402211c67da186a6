// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/detail/whole_unknowns.hpp"
#include "framehex/lattice/lattice_graph.hpp"

#include <deque>

namespace framehex::detail {

/// The whole numbers by which the coordinates of neighbours differ from their steps, as sums of a few unknowns.
///
/// With jumps that add up to nothing round every regular facet there are no dislocations. Coordinates may be counted so
/// that the jumps along a tree of edges are zero; round regular facets others follow. What is left are sheets between
/// singular lines, through which all edges jump alike: an unknown for each axis and sheet.
class JumpSheets {
public:
  using Jump = std::array<WholeSum, 3>;  ///< along the axes of the first vertex

  /// A facet round which the frame makes a quarter turn, at one of its corners: u = turn(u) - jump leads round it.
  struct QuarterTurn {
    std::array<std::uint8_t, 3> axis;  ///< a of the frame becomes
    std::array<std::int8_t, 3> sign;
    std::uint8_t along;  ///< the axis that stays
    Jump jump;

    /// Minus twice the coordinate across that stays, (1 + turn) jump: that of the line itself.
    WholeSum twice_fixed(std::uint8_t across) const { return sum_of(jump[across], jump[axis[across]], sign[across]); }
  };

  explicit JumpSheets(const LatticeGraph& graph)
      : graph_(graph), place_of_edge_(graph.n_edges(), unknown), regular_facets_(facets_of_edges()) {}

  /// @param stop  asked now and then. @return false when it said so: then nothing may be asked for.
  template <class Stop>
  bool find(Stop&& stop) {
    cut_along_tree();
    if (!follow_facets(stop)) return false;
    for (index_t e = 0; e < graph_.n_edges(); ++e) {
      if (place_of_edge_[e] != unknown) continue;
      Jump jump;
      for (WholeSum& sum : jump) sum = {{unknowns.add(), 1}};
      set(e, std::move(jump));
      if (!follow_facets(stop)) return false;
    }
    return true;
  }

  /// From v to its neighbour w, in unknowns that are left.
  Jump along(index_t v, index_t w) {
    const index_t e = graph_.edge(v, w);
    if (place_of_edge_[e] == zero) return {};
    Jump& jump = jumps_[place_of_edge_[e]];
    for (WholeSum& sum : jump) sum = unknowns.reduced(sum);
    return v < w ? jump : negated(moved(graph_.matching(e), jump, false));
  }

  /// At the facet's first corner; nothing unless the frame makes a quarter turn.
  std::optional<QuarterTurn> quarter_turn(const std::array<index_t, 3>& facet) {
    QuarterTurn turn{{0, 1, 2}, {1, 1, 1}, 3, round(facet)};
    for (std::uint8_t a = 0; a < 3; ++a) {
      for (std::size_t i = 0; i < 3; ++i) {
        const AxisMatching& m = graph_.matching(facet[i], facet[(i + 1) % 3]);
        turn.sign[a] = static_cast<std::int8_t>(turn.sign[a] * m.sign[turn.axis[a]]);
        turn.axis[a] = m.axis[turn.axis[a]];
      }
      if (turn.axis[a] == a && turn.sign[a] > 0) turn.along = a;
    }
    const std::size_t across = (turn.along + 1U) % 3;
    if (turn.along == 3 || turn.axis[across] == across) return std::nullopt;
    return turn;
  }

  WholeUnknowns unknowns;

private:
  static constexpr index_t unknown = no_index, zero = no_index - 1;

  static Jump negated(Jump jump) {
    for (WholeSum& sum : jump)
      for (auto& term : sum) term.second = -term.second;
    return jump;
  }
  static Jump added(const Jump& a, const Jump& b) {
    return {sum_of(a[0], b[0]), sum_of(a[1], b[1]), sum_of(a[2], b[2])};
  }
  static Jump moved(const AxisMatching& m, const Jump& jump, bool to_first) {
    Jump result;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t from = to_first ? m.axis[a] : a, to = to_first ? a : m.axis[a];
      result[to] = sum_of({}, jump[from], m.sign[a]);
    }
    return result;
  }
  static bool is_zero(const Jump& jump) { return jump[0].empty() && jump[1].empty() && jump[2].empty(); }

  bool is_known(index_t v, index_t w) const { return place_of_edge_[graph_.edge(v, w)] != unknown; }
  bool is_zero(index_t v, index_t w) const { return place_of_edge_[graph_.edge(v, w)] == zero; }

  /// @param jump  along the axes of the edge's lower vertex.
  void set(index_t e, Jump jump) {
    place_of_edge_[e] = is_zero(jump) ? zero : static_cast<index_t>(jumps_.size());
    if (place_of_edge_[e] != zero) jumps_.push_back(std::move(jump));
    for (const index_t f : regular_facets_[e]) waiting_.push_back(f);
  }

  Csr<index_t> facets_of_edges() {
    for (index_t tet = 0; tet < graph_.tets().size(); ++tet)
      for (int face = 0; face < 4; ++face) {
        const index_t other = graph_.adjacency().neighbours[tet][static_cast<std::size_t>(face)];
        const std::array<index_t, 3> f = facet(graph_.tets()[tet], face);
        if ((other == no_index || other > tet) && graph_.is_regular(f)) facets_.push_back(f);
      }
    return make_csr<index_t>(graph_.n_edges(), [&](auto&& put) {
      for (index_t f = 0; f < facets_.size(); ++f)
        for (std::size_t i = 0; i < 3; ++i) put(graph_.edge(facets_[f][i], facets_[f][(i + 1) % 3]), f);
    });
  }

  void cut_along_tree() {
    std::vector<std::uint8_t> reached(graph_.n_vertices(), 0);
    std::vector<index_t> queue;
    for (index_t seed = 0; seed < reached.size(); ++seed) {
      if (std::exchange(reached[seed], 1)) continue;
      queue.assign(1, seed);
      for (std::size_t i = 0; i < queue.size(); ++i)
        for (const index_t w : graph_.adjacency().vertices_of_vertex[queue[i]]) {
          if (std::exchange(reached[w], 1)) continue;
          set(graph_.edge(queue[i], w), {});
          queue.push_back(w);
        }
    }
  }

  /// Of two jumps round a facet the third follows; three are a relation.
  template <class Stop>
  bool follow_facets(const Stop& stop) {
    for (std::size_t n = 0; !waiting_.empty(); waiting_.pop_front()) {
      if (++n % 8192 == 0 && stop()) return false;
      const std::array<index_t, 3>& f = facets_[waiting_.front()];
      std::size_t n_known = 0, missing = 0;
      for (std::size_t i = 0; i < 3; ++i)
        if (is_known(f[i], f[(i + 1) % 3]))
          ++n_known;
        else
          missing = i;
      if (n_known == 2) {
        const index_t v = f[missing], w = f[(missing + 1) % 3];
        const Jump jump = negated(rest({v, w, f[(missing + 2) % 3]}));
        const index_t e = graph_.edge(v, w);
        set(e, v < w ? jump : negated(moved(graph_.matching(e), jump, true)));
      } else if (n_known == 3) {
        for (const WholeSum& sum : round(f)) unknowns.set_zero(sum);
      }
    }
    return true;
  }

  /// Sum of the jumps round a facet, at its first corner.
  Jump round(const std::array<index_t, 3>& f) {
    const Jump others = rest(f);
    return is_zero(f[0], f[1]) ? others : added(along(f[0], f[1]), others);
  }
  /// The same without the first edge.
  Jump rest(const std::array<index_t, 3>& f) {
    if (is_zero(f[1], f[2]) && is_zero(f[2], f[0])) return {};
    const Jump last = moved(graph_.matching(f[1], f[2]), along(f[2], f[0]), true);
    return moved(graph_.matching(f[0], f[1]), added(along(f[1], f[2]), last), true);
  }

  const LatticeGraph& graph_;
  std::vector<index_t> place_of_edge_;
  std::vector<Jump> jumps_;                     // those that are not zero, along the axes of their edge's lower vertex
  std::vector<std::array<index_t, 3>> facets_;  // the regular ones
  Csr<index_t> regular_facets_;                 // of each edge
  std::deque<index_t> waiting_;                 // facets of which an edge has become known
};

}  // namespace framehex::detail
