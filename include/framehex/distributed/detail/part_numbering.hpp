// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/concepts.hpp"
#include "framehex/distributed/detail/packing.hpp"

#include <bit>

namespace framehex::distributed::detail {

/// Numbers of its own in the whole mesh, and owners, for the vertices of a part of which no more is known than where they
/// are.
///
/// Vertices at one place, to the last bit, are one: it has the least of the numbers under which it was brought. The first
/// rank that has it owns it. Collective.
/// @param part  its `vertex_ids` are numbers that no two ranks have in common, or, `known`, those of the whole mesh.
inline void agree_on_vertices(const MpiTransport& transport, IndexedPart& part, bool known) {
  struct Question {
    std::array<double, 3> point;
    std::int64_t id;
  };
  struct Answer {
    std::int64_t id;
    int owner;
  };
  const auto n_ranks = static_cast<std::size_t>(transport.n_ranks());
  const auto clerk = [&](const Question& q) {
    std::uint64_t hash = known ? static_cast<std::uint64_t>(q.id) : 0;
    if (!known)
      for (const double x : q.point) hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(((hash * 0x9e3779b97f4a7c15u) >> 32) % n_ranks);
  };
  std::vector<std::vector<Question>> questions(n_ranks);
  std::vector<std::size_t> asked(part.vertex_ids.size());
  for (std::size_t v = 0; v < part.vertex_ids.size(); ++v) {
    const Vector3 p = part.mesh.points[v] + Vector3::Zero();  // no zero is negative
    const Question q{{p.x(), p.y(), p.z()}, part.vertex_ids[v]};
    asked[v] = clerk(q);
    questions[asked[v]].push_back(q);
  }
  struct Entry {
    Question question;
    int rank;
    std::size_t place;
  };
  std::vector<Entry> entries;
  std::vector<std::vector<Answer>> answers(n_ranks);
  for (const Parcel& p : transport.exchange(parcels_of(questions))) {
    const auto arrived = Unpacker(p.bytes).take<Question>();
    for (std::size_t i = 0; i < arrived.size(); ++i) entries.push_back({arrived[i], p.rank, i});
    answers[static_cast<std::size_t>(p.rank)].resize(arrived.size());
  }
  const auto same = [&](const Entry& a, const Entry& b) {
    return known ? a.question.id == b.question.id : a.question.point == b.question.point;
  };
  std::sort(entries.begin(), entries.end(), [&](const Entry& a, const Entry& b) {
    const auto key = [&](const Entry& e) {
      return std::tuple(known ? std::array<double, 3>{} : e.question.point, e.question.id, e.rank, e.place);
    };
    return key(a) < key(b);
  });
  for (std::size_t i = 0, end = 0; i < entries.size(); i = end) {
    int owner = entries[i].rank;
    for (end = i; end < entries.size() && same(entries[i], entries[end]); ++end)
      owner = std::min(owner, entries[end].rank);
    for (std::size_t j = i; j < end; ++j)
      answers[static_cast<std::size_t>(entries[j].rank)][entries[j].place] = {entries[i].question.id, owner};
  }
  std::vector<std::vector<Answer>> replies(n_ranks);
  for (const Parcel& p : transport.exchange(parcels_of(answers)))
    replies[static_cast<std::size_t>(p.rank)] = Unpacker(p.bytes).take<Answer>();
  std::vector<std::size_t> next(n_ranks, 0);
  part.owners.resize(part.vertex_ids.size());
  for (std::size_t v = 0; v < part.vertex_ids.size(); ++v) {
    const Answer& answer = replies[asked[v]][next[asked[v]]++];
    part.vertex_ids[v] = answer.id;
    part.owners[v] = answer.owner;
  }
}

/// Joins vertices of this rank that have come out as one, and leaves out those without a cell.
inline void join_vertices(IndexedPart& part) {
  std::vector<index_t> order(part.vertex_ids.size());
  std::vector<index_t> number(part.vertex_ids.size(), no_index);
  std::vector<char> is_used(order.size(), 0);
  for (const auto& tet : part.mesh.tets)
    for (const index_t v : tet) is_used[v] = 1;
  for (index_t v = 0; v < order.size(); ++v) order[v] = v;
  std::ranges::sort(order, {}, [&](index_t v) { return std::pair(part.vertex_ids[v], v); });
  IndexedPart joined{{{}, std::move(part.mesh.tets)}, {}, std::move(part.cell_ids), {}};
  for (const index_t v : order) {
    if (!is_used[v]) continue;
    if (joined.vertex_ids.empty() || joined.vertex_ids.back() != part.vertex_ids[v]) {
      joined.vertex_ids.push_back(part.vertex_ids[v]);
      joined.owners.push_back(part.owners[v]);
      joined.mesh.points.push_back(part.mesh.points[v]);
    }
    number[v] = static_cast<index_t>(joined.vertex_ids.size() - 1);
  }
  for (auto& tet : joined.mesh.tets)
    for (index_t& v : tet) v = number[v];
  part = std::move(joined);
}

}  // namespace framehex::distributed::detail
