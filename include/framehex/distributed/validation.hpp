// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/concepts.hpp"
#include "framehex/distributed/detail/packing.hpp"
#include "framehex/distributed/run_collectively.hpp"
#include "framehex/mesh/validation.hpp"

namespace framehex::distributed {

namespace detail {

/// A host's part in flat arrays.
template <DistributedTetMesh M>
IndexedPart read_part(const M& mesh) {
  using Distribution = distribution_traits<M>;
  IndexedPart part{{positions(mesh), tetrahedra(mesh)}, {}, {}, {}};
  for (const auto vertex : mesh_traits<M>::vertices(mesh)) {
    part.vertex_ids.push_back(Distribution::global_vertex(mesh, vertex));
    part.owners.push_back(Distribution::owner(mesh, vertex));
  }
  for (const auto cell : mesh_traits<M>::cells(mesh)) part.cell_ids.push_back(Distribution::global_cell(mesh, cell));
  return part;
}

inline std::string vertex_name(std::size_t v, std::int64_t id) {
  return "vertex " + std::to_string(v) + " (" + std::to_string(id) + " of the whole mesh)";
}

/// @throws invalid_connectivity  for what is wrong with the numbers without a look at other ranks.
inline void check_own_numbers(const IndexedPart& part, int n_ranks) {
  framehex::detail::check_numbers(part.vertex_ids, Entity::vertex);
  framehex::detail::check_numbers(part.cell_ids, Entity::cell);
  for (std::size_t v = 0; v < part.vertex_ids.size(); ++v) {
    if (part.owners[v] < 0 || part.owners[v] >= n_ranks)
      throw invalid_connectivity(vertex_name(v, part.vertex_ids[v]) + " has the owner " +
                                     std::to_string(part.owners[v]) + " of " + std::to_string(n_ranks) + " ranks",
                                 Entity::vertex, {v});
  }
}

/// Checks numbers against those of other ranks, at a rank that follows from the number.
class NumberChecker {
public:
  NumberChecker(const MpiTransport& transport, const IndexedPart& part) : transport_(transport), part_(part) {}

  void check_cells() const {
    struct Entry {
      std::int64_t id;
      index_t index;
      int rank;
    };
    std::vector<Entry> entries;
    for (index_t c = 0; c < part_.cell_ids.size(); ++c) entries.push_back({part_.cell_ids[c], c, transport_.rank()});
    report(entries, [](std::span<const Entry> same, auto&& fault) {
      if (same.size() > 1) fault(same[1], 0, same[0].rank);
    });
  }

  void check_vertices() const {
    struct Entry {
      std::int64_t id;
      index_t index;
      int rank, owner;
      std::array<double, 3> point;
    };
    std::vector<Entry> entries;
    for (index_t v = 0; v < part_.vertex_ids.size(); ++v) {
      const Vector3& p = part_.mesh.points[v];
      entries.push_back({part_.vertex_ids[v], v, transport_.rank(), part_.owners[v], {p.x(), p.y(), p.z()}});
    }
    report(entries, [](std::span<const Entry> same, auto&& fault) {
      for (std::size_t i = 1; i < same.size(); ++i)  // by rank
        if (same[i].rank == same[i - 1].rank) return fault(same[i], 1, same[i].rank);
      for (std::size_t i = 1; i < same.size(); ++i) {
        if (same[i].owner != same[0].owner) return fault(same[i], 2, same[0].rank);
        if (same[i].point != same[0].point) return fault(same[i], 3, same[0].rank);
      }
      const auto holds = [&](const Entry& e) { return e.rank == same[0].owner; };
      if (std::none_of(same.begin(), same.end(), holds)) fault(same[0], 4, same[0].owner);
    });
  }

private:
  struct Fault {
    index_t index;
    int what, other;
  };

  /// Brings entries of equal numbers together and throws where a fault is that they show.
  template <class Entry, class Check>
  void report(const std::vector<Entry>& entries, const Check& check) const {
    const auto n_ranks = static_cast<std::size_t>(transport_.n_ranks());
    std::array<double, 1> last{0};
    for (const Entry& e : entries) last[0] = std::min(last[0], -static_cast<double>(e.id));
    transport_.least(last);
    // Consecutive numbers lie together: a rank has few others to speak to when the numbers follow the parts.
    const std::int64_t share = static_cast<std::int64_t>(-last[0]) / transport_.n_ranks() + 1;
    std::vector<std::vector<Entry>> by_rank(n_ranks);
    for (const Entry& e : entries) by_rank[std::min(static_cast<std::size_t>(e.id / share), n_ranks - 1)].push_back(e);
    std::vector<Entry> here = send_joined(transport_, std::move(by_rank));
    std::stable_sort(here.begin(), here.end(), [](const Entry& a, const Entry& b) { return a.id < b.id; });
    std::vector<std::vector<Fault>> faults(n_ranks);
    for (std::size_t i = 0, end = 0; i < here.size(); i = end) {
      while (end < here.size() && here[end].id == here[i].id) ++end;
      check(std::span<const Entry>(here).subspan(i, end - i), [&](const Entry& e, int what, int other) {
        faults[static_cast<std::size_t>(e.rank)].push_back({e.index, what, other});
      });
    }
    if (const std::vector<Fault> mine = send_joined(transport_, std::move(faults)); !mine.empty()) fail(mine.front());
  }

  [[noreturn]] void fail(const Fault& fault) const {
    const std::string other = std::to_string(fault.other);
    if (fault.what == 0)
      throw invalid_connectivity("cell " + std::to_string(fault.index) + " has the global number " +
                                     std::to_string(part_.cell_ids[fault.index]) + ", as has a cell of rank " + other,
                                 Entity::cell, {fault.index});
    const std::string name = vertex_name(fault.index, part_.vertex_ids[fault.index]);
    if (fault.what == 3)
      throw invalid_coordinate(name + " has other coordinates than on rank " + other, Entity::vertex, {fault.index});
    const std::string owner = std::to_string(part_.owners[fault.index]);
    const std::array<std::string, 5> texts{"", " has the number of another vertex of this rank",
                                           " has the owner " + owner + ", but another on rank " + other, "",
                                           " has the owner " + owner + ", which does not have it"};
    throw invalid_connectivity(name + texts[static_cast<std::size_t>(fault.what)], Entity::vertex, {fault.index});
  }

  const MpiTransport& transport_;
  const IndexedPart& part_;
};

/// @throws as `validate`.
template <DistributedTetMesh M>
IndexedPart validated_part(const M& mesh, const MpiTransport& transport) {
  framehex::validate(mesh);
  IndexedPart part = read_part(mesh);
  check_own_numbers(part, transport.n_ranks());
  const NumberChecker checker(transport, part);
  checker.check_cells();
  checker.check_vertices();
  return part;
}

}  // namespace detail

/// Checks all that is assumed of a distributed mesh: each part as `framehex::validate` does, and that the parts agree on
/// numbers, owners and coordinates. Collective.
///
/// @throws remote_error  on all ranks, with the vertex or cell in the numbers of the rank it names: what
///         `framehex::validate` throws there; a number that is negative, 2^62 or more, or given twice; an owner that is no rank, does
///         not have the vertex, or is another on another rank; coordinates that differ between ranks.
/// @par Complexity   O(n) of the part; each vertex and cell is sent to one rank, in two exchanges.
template <DistributedTetMesh M>
void validate(const M& mesh, const MpiTransport& transport) {
  run_collectively(transport, [&] { detail::validated_part(mesh, transport); });
}

}  // namespace framehex::distributed
