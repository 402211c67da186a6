// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/detail/held_tets.hpp"

#include <unordered_set>

namespace framehex::detail {

/// Fetches the tetrahedra round those of a rank that others hold, layer by layer: a layer is what shares a vertex with the
/// one before.
///
/// Every rank follows how far the others reach into its own tetrahedra, and hears of it from those with which it shares
/// a vertex; in the end it sends each its layers.
template <Transport Tr>
class HaloExchange {
public:
  HaloExchange(const Tr& transport, const Partition& partition, HeldTets& held)
      : transport_(transport), partition_(partition), held_(held) {}

  /// Appends the layers to the tetrahedra. Collective.
  void run(int n_layers) {
    if (transport_.n_ranks() == 1) return;
    number_corners();
    shared_ = find_sharers(transport_, partition_, border_vertices());
    for (const SharedVertices::Entry& entry : shared_.entries) reach(held_.local(entry.vertex), entry.rank);
    TetMail mail(transport_.n_ranks(), held_.vertices.size());
    for (int layer = 0; layer < n_layers; ++layer) grow(mail);
    mail.deliver(transport_, held_);
  }

private:
  struct Reach {
    index_t vertex;
    int rank;
  };
  using Entry = SharedVertices::Entry;

  void number_corners() {
    corners_.reserve(held_.tets.size());
    for (const TetRecord& tet : held_.tets) {
      auto& corners = corners_.emplace_back();
      for (std::size_t i = 0; i < 4; ++i) corners[i] = held_.local(tet.vertices[i]);
    }
    tets_of_vertex_ = incident_cells(held_.vertices.size(), corners_);
  }

  /// Vertices of facets that one tetrahedron has: all that others may have are among them.
  std::vector<VertexRecord> border_vertices() const {
    std::vector<std::array<index_t, 3>> facets;
    facets.reserve(4 * corners_.size());
    for (const auto& corners : corners_)
      for (int f = 0; f < 4; ++f) facets.push_back(sorted(facet(corners, f)));
    std::sort(facets.begin(), facets.end());
    std::vector<std::uint8_t> on_border(held_.vertices.size(), 0);
    for (std::size_t i = 0, end = 0; i < facets.size(); i = end) {
      while (end < facets.size() && facets[end] == facets[i]) ++end;
      if (end - i == 1)
        for (const index_t v : facets[i]) on_border[v] = 1;
    }
    std::vector<VertexRecord> border;
    for (std::size_t v = 0; v < on_border.size(); ++v)
      if (on_border[v]) border.push_back(held_.vertices[v]);
    return border;
  }

  bool reach(index_t vertex, int rank) {
    if (!reached_.insert(std::uint64_t{vertex} << 32 | static_cast<std::uint32_t>(rank)).second) return false;
    front_.push_back({vertex, rank});
    return true;
  }

  void grow(TetMail& mail) {
    const std::vector<Reach> front = std::exchange(front_, {});
    Rows<Entry> news = make_rows<Entry>(transport_);
    for (const auto& [vertex, rank] : front)
      for (const index_t tet : tets_of_vertex_[vertex]) {
        if (!sent_.insert(std::uint64_t{tet} << 32 | static_cast<std::uint32_t>(rank)).second) continue;
        mail.put(rank, held_.tets[tet], corners_[tet], [this](index_t v) { return held_.vertices[v]; });
        for (const index_t v : corners_[tet]) {
          if (!reach(v, rank)) continue;
          for (const Entry& entry : shared_.of(held_.vertices[v].number))
            if (entry.rank != rank)
              news[static_cast<std::size_t>(entry.rank)].push_back({held_.vertices[v].number, rank});
        }
      }
    for (const Entry& entry : send_joined(transport_, std::move(news))) reach(held_.local(entry.vertex), entry.rank);
  }

  const Tr& transport_;
  const Partition& partition_;
  HeldTets& held_;
  std::vector<std::array<index_t, 4>> corners_;
  Csr<index_t> tets_of_vertex_;
  SharedVertices shared_;
  std::unordered_set<std::uint64_t> reached_, sent_;  ///< (vertex, rank) and (tetrahedron, rank)
  std::vector<Reach> front_;
};

}  // namespace framehex::detail
