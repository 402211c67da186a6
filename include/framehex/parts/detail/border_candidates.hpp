// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/detail/tet_patch.hpp"
#include "framehex/recombination/candidates.hpp"

#include <map>

namespace framehex::detail {

/// A candidate on its way to another rank. Its tetrahedra travel beside it.
struct CandidateRecord {
  std::array<global_t, 8> vertices;
  std::array<Place, 8> places;
  double weight;
  index_t index;  ///< among those of its rank
  int rank;
  std::uint32_t n_tets;
};

/// The candidates of a rank, and copies of those of other ranks that share a vertex with one of them: all that they can be
/// in conflict with.
///
/// Numbers of vertices and tetrahedra are those of the patch; what it has not is numbered after it.
struct CandidatePool {
  PotentialHexahedra candidates;  ///< own ones first
  std::vector<double> weights;
  std::size_t n_own = 0;
  std::vector<Vector3> points;               ///< by vertex
  std::vector<global_t> vertex_number;       ///< by vertex
  std::vector<std::array<index_t, 2>> home;  ///< of the copies: rank, index there; ascending
  struct Holder {
    index_t index;
    int rank;
    friend auto operator<=>(const Holder&, const Holder&) = default;
  };
  std::vector<Holder> holders;  ///< who has copies of which own candidates, ascending

  std::vector<global_t> tet_number;  ///< by tetrahedron

  std::size_t size() const { return candidates.size(); }

  CandidateRecord record(index_t i, int rank) const {
    CandidateRecord r{};
    for (std::size_t k = 0; k < 8; ++k) {
      const index_t v = candidates.vertices[i][k];
      r.vertices[k] = vertex_number[v];
      r.places[k] = place_of(points[v]);
    }
    r.weight = weights[i];
    r.index = i;
    r.rank = rank;
    r.n_tets = static_cast<std::uint32_t>(candidates.tets[i].size());
    return r;
  }

  /// Heavier, or as heavy and before it by the coordinates of its corners: an order of all candidates of all ranks.
  bool is_before(index_t u, index_t v) const {
    if (weights[u] != weights[v]) return weights[u] > weights[v];
    const auto &a = candidates.vertices[u], &b = candidates.vertices[v];
    for (std::size_t i = 0; i < 8; ++i) {
      if (a[i] == b[i]) continue;
      return lies_before(VertexRecord{vertex_number[a[i]], place_of(points[a[i]])},
                         {vertex_number[b[i]], place_of(points[b[i]])});
    }
    return false;
  }
};

/// Brings the candidates of other ranks to those in conflict with which they can be.
///
/// Each candidate is shown to the ranks of its vertices; there all that meet at a vertex are known, and are sent to one
/// another.
template <Transport Tr>
class BorderExchange {
public:
  BorderExchange(const Tr& transport, const Partition& partition, const TetPatch& patch)
      : transport_(transport), partition_(partition), patch_(patch) {}

  /// @param weights  of the candidates. Collective.
  CandidatePool run(PotentialHexahedra candidates, std::vector<double> weights) {
    CandidatePool pool;
    pool.n_own = candidates.size();
    pool.candidates = std::move(candidates);
    pool.weights = std::move(weights);
    pool.points = patch_.mesh.points;
    pool.vertex_number = patch_.vertex_number;
    pool.tet_number = patch_.tet_number;
    if (transport_.n_ranks() == 1) return pool;
    show(pool);
    introduce(pool);
    return pool;
  }

private:
  /// Candidates and their tetrahedra.
  struct Shown {
    std::vector<CandidateRecord> records;
    std::vector<global_t> tets;
    std::vector<std::size_t> first_tet;
  };

  int rank_of(index_t vertex) const { return partition_.rank(patch_.leaf_of_vertex[vertex]); }

  Shown send(Rows<CandidateRecord> records, Rows<global_t> tets) const {
    Shown shown;
    shown.records = send_joined(transport_, std::move(records));
    shown.tets = send_joined(transport_, std::move(tets));
    std::size_t next = 0;
    for (const CandidateRecord& r : shown.records) {
      shown.first_tet.push_back(next);
      next += r.n_tets;
    }
    return shown;
  }

  void put(const CandidatePool& pool, index_t i, int rank, Rows<CandidateRecord>& records, Rows<global_t>& tets) const {
    records[static_cast<std::size_t>(rank)].push_back(pool.record(i, transport_.rank()));
    for (const index_t tet : pool.candidates.tets[i])
      tets[static_cast<std::size_t>(rank)].push_back(pool.tet_number[tet]);
  }

  void show(const CandidatePool& pool) {
    Rows<CandidateRecord> records = make_rows<CandidateRecord>(transport_);
    Rows<global_t> tets = make_rows<global_t>(transport_);
    std::vector<int> ranks;
    for (index_t i = 0; i < pool.n_own; ++i) {
      ranks.clear();
      for (const index_t v : pool.candidates.vertices[i]) ranks.push_back(rank_of(v));
      std::sort(ranks.begin(), ranks.end());
      ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
      for (const int rank : ranks)
        if (rank != transport_.rank()) put(pool, i, rank, records, tets);
    }
    shown_ = send(std::move(records), std::move(tets));
  }

  /// Sends each candidate at one of this rank's vertices to the ranks of the others there.
  void introduce(CandidatePool& pool) {
    // Ranks and candidates that meet at a vertex: own ones are numbered from 0, those shown after them.
    struct Guest {
      index_t vertex;
      int rank;
      index_t candidate;
    };
    std::vector<Guest> guests;
    std::vector<std::uint8_t> has_guests(patch_.vertex_number.size(), 0);
    for (std::size_t n = 0; n < shown_.records.size(); ++n)
      for (const global_t number : shown_.records[n].vertices) {
        const index_t v = patch_.vertex(number);
        if (v == no_index || rank_of(v) != transport_.rank()) continue;
        has_guests[v] = 1;
        guests.push_back({v, shown_.records[n].rank, static_cast<index_t>(pool.n_own + n)});
      }
    for (index_t i = 0; i < pool.n_own; ++i)
      for (const index_t v : pool.candidates.vertices[i])
        if (has_guests[v]) guests.push_back({v, transport_.rank(), i});
    std::sort(guests.begin(), guests.end(), [](const Guest& a, const Guest& b) {
      return std::tie(a.vertex, a.rank, a.candidate) < std::tie(b.vertex, b.rank, b.candidate);
    });
    std::vector<std::array<index_t, 2>> meetings;  // candidate, rank
    for (std::size_t i = 0, end = 0; i < guests.size(); i = end) {
      while (end < guests.size() && guests[end].vertex == guests[i].vertex) ++end;
      for (std::size_t j = i; j < end; ++j)
        for (std::size_t k = i; k < end; ++k)
          if (guests[k].rank != guests[j].rank && (k == i || guests[k].rank != guests[k - 1].rank))
            meetings.push_back({guests[j].candidate, static_cast<index_t>(guests[k].rank)});
    }
    std::sort(meetings.begin(), meetings.end());
    meetings.erase(std::unique(meetings.begin(), meetings.end()), meetings.end());
    deliver(pool, meetings);
  }

  void deliver(CandidatePool& pool, const std::vector<std::array<index_t, 2>>& meetings) {
    Rows<CandidateRecord> records = make_rows<CandidateRecord>(transport_);
    Rows<global_t> tets = make_rows<global_t>(transport_);
    Rows<CandidatePool::Holder> holders = make_rows<CandidatePool::Holder>(transport_);
    for (const auto& [candidate, rank] : meetings) {
      const int to = static_cast<int>(rank);
      if (candidate < pool.n_own) {
        put(pool, candidate, to, records, tets);
        pool.holders.push_back({candidate, to});
        continue;
      }
      const std::size_t n = candidate - pool.n_own;
      const CandidateRecord& r = shown_.records[n];
      records[rank].push_back(r);
      const auto first = shown_.tets.begin() + static_cast<std::ptrdiff_t>(shown_.first_tet[n]);
      tets[rank].insert(tets[rank].end(), first, first + r.n_tets);
      holders[static_cast<std::size_t>(r.rank)].push_back({r.index, to});
    }
    shown_ = send(std::move(records), std::move(tets));
    for (const CandidatePool::Holder& h : send_joined(transport_, std::move(holders))) pool.holders.push_back(h);
    std::sort(pool.holders.begin(), pool.holders.end());
    pool.holders.erase(std::unique(pool.holders.begin(), pool.holders.end()), pool.holders.end());
    add_copies(pool);
  }

  /// Appends what was delivered, each once, by home.
  void add_copies(CandidatePool& pool) {
    std::vector<std::size_t> order(shown_.records.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto home = [&](std::size_t i) {
      return std::array<index_t, 2>{static_cast<index_t>(shown_.records[i].rank), shown_.records[i].index};
    };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return home(a) < home(b); });
    order.erase(
        std::unique(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return home(a) == home(b); }),
        order.end());
    std::map<global_t, index_t> new_vertex, new_tet;
    for (const std::size_t n : order) {
      const CandidateRecord& r = shown_.records[n];
      auto& vertices = pool.candidates.vertices.emplace_back();
      for (std::size_t k = 0; k < 8; ++k) {
        vertices[k] = patch_.vertex(r.vertices[k]);
        if (vertices[k] != no_index) continue;
        const auto [at, is_new] = new_vertex.try_emplace(r.vertices[k], static_cast<index_t>(pool.points.size()));
        vertices[k] = at->second;
        if (!is_new) continue;
        pool.points.push_back(point_at(r.places[k]));
        pool.vertex_number.push_back(r.vertices[k]);
      }
      Csr<index_t>& tets = pool.candidates.tets;
      for (std::size_t k = 0; k < r.n_tets; ++k) {
        const global_t number = shown_.tets[shown_.first_tet[n] + k];
        index_t tet = patch_.tet(number);
        if (tet == no_index) {
          const auto [at, is_new] = new_tet.try_emplace(number, static_cast<index_t>(pool.tet_number.size()));
          tet = at->second;
          if (is_new) pool.tet_number.push_back(number);
        }
        tets.values.push_back(tet);
      }
      std::sort(tets.values.begin() + static_cast<std::ptrdiff_t>(tets.offsets.back()), tets.values.end());
      tets.end_row();
      pool.candidates.face_slivers.end_row();
      pool.candidates.quality.push_back(0);
      pool.candidates.volume.push_back(0);
      pool.weights.push_back(r.weight);
      pool.home.push_back(home(n));
    }
    shown_ = {};
  }

  const Tr& transport_;
  const Partition& partition_;
  const TetPatch& patch_;
  Shown shown_;
};

}  // namespace framehex::detail
