// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/detail/tet_patch.hpp"
#include "framehex/recombination/candidates.hpp"

#include <map>

namespace framehex::detail {

/// A candidate on its way to another rank. Its tetrahedra and vertices travel beside it.
struct CandidateRecord {
  std::array<global_t, 8> vertices;
  double weight;
  index_t index;  ///< among those of its rank
  int rank;
  std::uint32_t n_tets;
  std::uint32_t is_taken;
};

/// The candidates of a rank, and copies of those of other ranks that it has been told of: they share a vertex with one of
/// its own, as all do that these can be in conflict with.
///
/// Numbers of vertices and tetrahedra are those of the patch. Vertices that it has not are numbered after its own;
/// tetrahedra that it has not, none of the own candidates has, and copies are without them.
struct CandidatePool {
  CandidatePool(const TetPatch& of, PotentialHexahedra own, std::vector<double> own_weights)
      : patch(&of),
        candidates(std::move(own)),
        weights(std::move(own_weights)),
        n_own(candidates.size()),
        points(of.mesh.points),
        vertex_number(of.vertex_number) {}

  const TetPatch* patch;
  PotentialHexahedra candidates;  ///< own ones first
  std::vector<double> weights;
  std::size_t n_own = 0;
  std::vector<Vector3> points;          ///< by vertex
  std::vector<global_t> vertex_number;  ///< by vertex
  struct Copy {
    int rank;
    index_t home;   ///< index there
    index_t index;  ///< here
    friend auto operator<=>(const Copy&, const Copy&) = default;
  };
  std::vector<Copy> copies;  ///< ascending
  struct Holder {
    index_t index;
    int rank;
    friend auto operator<=>(const Holder&, const Holder&) = default;
  };
  std::vector<Holder> holders;  ///< who has copies of which own candidates, ascending

  std::size_t size() const { return candidates.size(); }

  index_t copy_of(int rank, index_t home) const {
    return std::lower_bound(copies.begin(), copies.end(), Copy{rank, home, 0})->index;
  }

  VertexRecord vertex(index_t v) const { return {vertex_number[v], place_of(points[v])}; }

  /// Heavier, or as heavy and before it by the coordinates of its corners: an order of all candidates of all ranks.
  bool is_before(index_t u, index_t v) const {
    if (weights[u] != weights[v]) return weights[u] > weights[v];
    const auto &a = candidates.vertices[u], &b = candidates.vertices[v];
    for (std::size_t i = 0; i < 8; ++i)
      if (a[i] != b[i]) return lies_before(vertex(a[i]), vertex(b[i]));
    return false;
  }
};

/// Candidates on their way to ranks, each vertex once to each.
class CandidateMail {
public:
  CandidateMail(int n_ranks, const CandidatePool& pool)
      : pool_(pool), records_(static_cast<std::size_t>(n_ranks)), tets_(records_.size()), vertices_(records_.size()) {
    sent_.resize(records_.size());
  }

  void put(index_t candidate, bool is_taken, int from, int to) {
    const auto r = static_cast<std::size_t>(to);
    if (sent_[r].empty()) sent_[r].assign(pool_.points.size(), 0);
    const auto tets = pool_.candidates.tets[candidate];
    CandidateRecord& record = records_[r].emplace_back();
    for (std::size_t k = 0; k < 8; ++k) {
      const index_t v = pool_.candidates.vertices[candidate][k];
      record.vertices[k] = pool_.vertex_number[v];
      if (!std::exchange(sent_[r][v], std::uint8_t{1})) vertices_[r].push_back(pool_.vertex(v));
    }
    record.weight = pool_.weights[candidate];
    record.index = candidate;
    record.rank = from;
    record.n_tets = static_cast<std::uint32_t>(tets.size());
    record.is_taken = is_taken ? 1 : 0;
    for (const index_t tet : tets) tets_[r].push_back(pool_.patch->tet_number[tet]);
  }

  /// What arrived, records by rising rank.
  struct Delivery {
    std::vector<CandidateRecord> records;
    std::vector<std::size_t> first_tet;  ///< of each record
    std::vector<global_t> tets;
    HeldTets held;  ///< the vertices

    std::span<const global_t> tets_of(std::size_t record) const {
      return {tets.data() + first_tet[record], records[record].n_tets};
    }
  };

  /// Collective; once.
  template <Transport Tr>
  Delivery deliver(const Tr& transport) {
    sent_.clear();
    Delivery d;
    d.records = send_joined(transport, std::move(records_));
    d.tets = send_joined(transport, std::move(tets_));
    d.held.vertices = send_joined(transport, std::move(vertices_));
    d.held.tidy();
    std::size_t next = 0;
    for (const CandidateRecord& r : d.records) {
      d.first_tet.push_back(next);
      next += r.n_tets;
    }
    return d;
  }

private:
  const CandidatePool& pool_;
  Rows<CandidateRecord> records_;
  Rows<global_t> tets_;
  Rows<VertexRecord> vertices_;
  Rows<std::uint8_t> sent_;
};

/// Tells ranks of those candidates of others that theirs can be in conflict with: which have a vertex in common.
///
/// Ranks are told who has candidates at which vertex; then each sends its own to those. Most never need to be sent: see
/// GreedyRounds.
template <Transport Tr>
class BorderExchange {
public:
  /// @param pool  is added to. Collective.
  BorderExchange(const Tr& transport, const Partition& partition, CandidatePool& pool)
      : transport_(transport), pool_(pool), is_told_(pool.n_own, 0) {
    std::vector<std::uint8_t> is_used(pool.points.size(), 0);
    for (index_t i = 0; i < pool.n_own; ++i)
      for (const index_t v : pool.candidates.vertices[i]) is_used[v] = 1;
    std::vector<VertexRecord> used;
    for (index_t v = 0; v < is_used.size(); ++v)
      if (is_used[v]) used.push_back(pool.vertex(v));
    const SharedVertices shared = find_sharers(transport, partition, used);
    std::vector<std::array<index_t, 2>> entries;
    for (const auto& entry : shared.entries)
      entries.push_back({pool.patch->vertex(entry.vertex), static_cast<index_t>(entry.rank)});
    std::sort(entries.begin(), entries.end());
    ranks_at_ = make_csr(is_used.size(), [&](auto&& put) {
      for (const auto& [v, rank] : entries) put(v, rank);
    });
  }

  /// Whether another rank has candidates at a corner of an own one.
  bool is_at_border(index_t own) const {
    return std::ranges::any_of(pool_.candidates.vertices[own], [this](index_t v) { return !ranks_at_[v].empty(); });
  }

  /// Sends own candidates to those who may compete with them, unless they know them. Collective.
  /// @param is_taken  callable: candidate -> whether it is; said in the records only.
  void tell(std::span<const index_t> own) {
    if (transport_.n_ranks() == 1) return;
    CandidateMail mail(transport_.n_ranks(), pool_);
    std::vector<index_t> ranks;
    for (const index_t i : own) {
      if (std::exchange(is_told_[i], std::uint8_t{1})) continue;
      ranks.clear();
      for (const index_t v : pool_.candidates.vertices[i])
        ranks.insert(ranks.end(), ranks_at_[v].begin(), ranks_at_[v].end());
      std::sort(ranks.begin(), ranks.end());
      ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
      for (const index_t rank : ranks) {
        mail.put(i, false, transport_.rank(), static_cast<int>(rank));
        pool_.holders.push_back({i, static_cast<int>(rank)});
      }
    }
    std::sort(pool_.holders.begin(), pool_.holders.end());
    add_copies(mail.deliver(transport_));
  }

  /// Flags of vertices that own candidates have, raised where another rank with candidates there raised them. Collective.
  void join_flags(std::vector<std::uint8_t>& flags) const {
    if (transport_.n_ranks() == 1) return;
    Rows<global_t> rows = make_rows<global_t>(transport_);
    for (index_t v = 0; v < ranks_at_.size(); ++v)
      if (flags[v])
        for (const index_t rank : ranks_at_[v]) rows[rank].push_back(pool_.vertex_number[v]);
    for (const global_t number : send_joined(transport_, std::move(rows))) flags[pool_.patch->vertex(number)] = 1;
  }

private:
  void add_copies(const CandidateMail::Delivery& delivery) {
    const TetPatch& patch = *pool_.patch;
    for (std::size_t n = 0; n < delivery.records.size(); ++n) {
      const CandidateRecord& r = delivery.records[n];
      pool_.copies.push_back({r.rank, r.index, static_cast<index_t>(pool_.size())});
      auto& vertices = pool_.candidates.vertices.emplace_back();
      for (std::size_t k = 0; k < 8; ++k) {
        vertices[k] = patch.vertex(r.vertices[k]);
        if (vertices[k] == no_index) vertices[k] = number_beyond(delivery.held, r.vertices[k]);
      }
      Csr<index_t>& tets = pool_.candidates.tets;
      for (const global_t number : delivery.tets_of(n))
        if (const index_t tet = patch.tet(number); tet != no_index) tets.values.push_back(tet);
      std::sort(tets.values.begin() + static_cast<std::ptrdiff_t>(tets.offsets.back()), tets.values.end());
      tets.end_row();
      pool_.candidates.face_slivers.end_row();
      pool_.candidates.quality.push_back(0);
      pool_.candidates.volume.push_back(0);
      pool_.weights.push_back(r.weight);
    }
    std::sort(pool_.copies.begin(), pool_.copies.end());
  }

  /// Of a vertex that the patch has not.
  index_t number_beyond(const HeldTets& held, global_t number) {
    const auto [at, is_new] = beyond_.try_emplace(number, static_cast<index_t>(pool_.points.size()));
    if (is_new) {
      pool_.points.push_back(point_at(held.vertices[held.find(number)].place));
      pool_.vertex_number.push_back(number);
    }
    return at->second;
  }

  const Tr& transport_;
  CandidatePool& pool_;
  std::vector<std::uint8_t> is_told_;  ///< by own candidate
  Csr<index_t> ranks_at_;              ///< by vertex of the patch: other ranks that have candidates there
  std::map<global_t, index_t> beyond_;
};

}  // namespace framehex::detail
