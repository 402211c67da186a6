// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/adjacency.hpp"
#include "framehex/parts/partition.hpp"

namespace framehex::detail {

/// Coordinates on their way.
using Place = std::array<double, 3>;
inline Place place_of(const Vector3& p) {
  return {p.x(), p.y(), p.z()};
}
inline Vector3 point_at(const Place& p) {
  return {p[0], p[1], p[2]};
}

struct VertexRecord {
  global_t number;
  Place place;
};

struct TetRecord {
  std::array<global_t, 4> vertices;
  global_t number;
  index_t region;
};

/// Coordinates first, numbers where two vertices lie at one place.
inline bool lies_before(const VertexRecord& a, const VertexRecord& b) {
  return a.place != b.place ? a.place < b.place : a.number < b.number;
}

inline bool lies_before(const Vector3& a, const Vector3& b) {
  return place_of(a) < place_of(b);
}

/// Centre of some points, the same to the last bit in whatever order they are given.
template <std::size_t N>
Vector3 centre_of(std::array<Vector3, N>& buffer, std::size_t n) {
  const auto first = buffer.begin(), last = first + static_cast<std::ptrdiff_t>(n);
  std::sort(first, last, [](const Vector3& a, const Vector3& b) { return lies_before(a, b); });
  Vector3 sum = Vector3::Zero();
  for (auto p = first; p != last; ++p) sum += *p;
  return sum / static_cast<double>(n);
}

inline Vector3 centre_of_tet(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  std::array<Vector3, 4> buffer{a, b, c, d};
  return centre_of(buffer, 4);
}

/// Tetrahedra that a rank holds, and their vertices by rising number.
struct HeldTets {
  std::vector<VertexRecord> vertices;
  std::vector<TetRecord> tets;

  std::size_t find(global_t vertex) const {
    const auto at = std::lower_bound(vertices.begin(), vertices.end(), vertex,
                                     [](const VertexRecord& v, global_t number) { return v.number < number; });
    return at != vertices.end() && at->number == vertex ? static_cast<std::size_t>(at - vertices.begin()) : no_vertex;
  }
  index_t local(global_t vertex) const { return static_cast<index_t>(find(vertex)); }
  static constexpr std::size_t no_vertex = static_cast<std::size_t>(-1);

  /// Puts vertices in order, each once.
  void tidy() {
    std::sort(vertices.begin(), vertices.end(),
              [](const VertexRecord& a, const VertexRecord& b) { return a.number < b.number; });
    vertices.erase(std::unique(vertices.begin(), vertices.end(),
                               [](const VertexRecord& a, const VertexRecord& b) { return a.number == b.number; }),
                   vertices.end());
  }
};

/// Tetrahedra on their way to ranks, each vertex once to each.
class TetMail {
public:
  explicit TetMail(int n_ranks, std::size_t n_vertices)
      : tets_(static_cast<std::size_t>(n_ranks)), vertices_(tets_.size()), n_vertices_(n_vertices) {}

  /// @param corners   numbers of its vertices here.
  /// @param vertex_at callable: number here -> VertexRecord.
  template <class VertexAt>
  void put(int rank, const TetRecord& tet, const std::array<index_t, 4>& corners, VertexAt&& vertex_at) {
    const auto r = static_cast<std::size_t>(rank);
    if (sent_.size() < tets_.size()) sent_.resize(tets_.size());
    if (sent_[r].empty()) sent_[r].assign(n_vertices_, 0);
    tets_[r].push_back(tet);
    for (const index_t v : corners)
      if (!std::exchange(sent_[r][v], std::uint8_t{1})) vertices_[r].push_back(vertex_at(v));
  }

  /// Adds what arrives. Collective.
  template <Transport Tr>
  void deliver(const Tr& transport, HeldTets& to) {
    sent_.clear();
    const auto append = []<class T>(std::vector<T>& list, std::vector<T>&& items) {
      if (list.empty())
        list = std::move(items);
      else
        list.insert(list.end(), items.begin(), items.end());
    };
    append(to.tets, send_joined(transport, std::move(tets_)));
    append(to.vertices, send_joined(transport, std::move(vertices_)));
    to.tidy();
  }

private:
  Rows<TetRecord> tets_;
  Rows<VertexRecord> vertices_;
  std::size_t n_vertices_;
  std::vector<std::vector<std::uint8_t>> sent_;
};

/// Vertices that several ranks have, and those ranks; by rising vertex, then rank. Without the own rank.
struct SharedVertices {
  struct Entry {
    global_t vertex;
    int rank;
    friend auto operator<=>(const Entry&, const Entry&) = default;
  };
  std::vector<Entry> entries;

  std::span<const Entry> of(global_t vertex) const {
    const auto range = std::equal_range(entries.begin(), entries.end(), Entry{vertex, 0},
                                        [](const Entry& a, const Entry& b) { return a.vertex < b.vertex; });
    return {entries.data() + (range.first - entries.begin()), static_cast<std::size_t>(range.second - range.first)};
  }
};

/// Finds who else has some vertices. Collective. The rank in whose leaf a vertex lies tells its holders of one another.
///
/// @param vertices  those that others may have; each once.
template <Transport Tr>
SharedVertices find_sharers(const Tr& transport, const Partition& partition, std::span<const VertexRecord> vertices) {
  using Entry = SharedVertices::Entry;
  SharedVertices shared;
  if (transport.n_ranks() == 1) return shared;
  const auto rows = [&] { return make_rows<Entry>(transport); };
  auto questions = rows();
  for (const VertexRecord& v : vertices)
    questions[static_cast<std::size_t>(partition.rank(partition.leaf_at(point_at(v.place))))].push_back(
        {v.number, transport.rank()});
  std::vector<Entry> holders = send_joined(transport, std::move(questions));
  std::sort(holders.begin(), holders.end());
  auto answers = rows();
  for (std::size_t i = 0, end = 0; i < holders.size(); i = end) {
    while (end < holders.size() && holders[end].vertex == holders[i].vertex) ++end;
    for (std::size_t j = i; j < end; ++j)
      for (std::size_t k = i; k < end; ++k)
        if (j != k) answers[static_cast<std::size_t>(holders[j].rank)].push_back(holders[k]);
  }
  shared.entries = send_joined(transport, std::move(answers));
  std::sort(shared.entries.begin(), shared.entries.end());
  return shared;
}

}  // namespace framehex::detail
