// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/detail/tet_patch.hpp"

#include <span>

namespace framehex {

/// The part of a tetrahedral mesh that one rank brings. Each cell is brought by one rank; a vertex by every rank that has
/// a cell of it, at the same place to the last bit. Spans must outlive the call only.
struct PartInput {
  std::span<const Vector3> points{};               ///< of the vertices that the cells here use
  std::span<const std::array<index_t, 4>> tets{};  ///< positions in `points`, positively oriented
  std::span<const global_t> vertex_numbers{};      ///< of each point in the whole mesh, >= 0 and < 2^62
  std::span<const global_t> cell_numbers{};        ///< of each cell in the whole mesh, >= 0 and < 2^62
  std::span<const index_t> regions{};              ///< label of each cell, or empty on all ranks: one region
};

namespace detail {

inline Vector3 centre_of_tet(const PartInput& input, std::size_t tet) {
  const auto& t = input.tets[tet];
  return centre_of_tet(input.points[t[0]], input.points[t[1]], input.points[t[2]], input.points[t[3]]);
}

/// The box round the cells of all ranks. Collective. @return false when there is no cell anywhere.
template <Transport Tr>
bool find_box(const Tr& transport, const PartInput& input, Vector3& low, Vector3& high) {
  std::array<double, 6> least;
  least.fill(std::numeric_limits<double>::infinity());
  for (const auto& tet : input.tets)
    for (const index_t v : tet)
      for (std::size_t i = 0; i < 3; ++i) {
        const double x = input.points[v][static_cast<Eigen::Index>(i)];
        least[i] = std::min(least[i], x);
        least[i + 3] = std::min(least[i + 3], -x);
      }
  transport.least(std::span<double>(least));
  low = {least[0], least[1], least[2]};
  high = {-least[3], -least[4], -least[5]};
  return std::isfinite(least[0]);
}

/// Brings each cell to the rank of its leaf. Collective.
template <Transport Tr>
HeldTets distribute(const Tr& transport, const Partition& partition, const PartInput& input) {
  TetMail mail(transport.n_ranks(), input.points.size());
  for (std::size_t tet = 0; tet < input.tets.size(); ++tet) {
    TetRecord record{};
    for (std::size_t i = 0; i < 4; ++i) record.vertices[i] = input.vertex_numbers[input.tets[tet][i]];
    record.number = input.cell_numbers[tet];
    record.region = input.regions.empty() ? 0 : input.regions[tet];
    mail.put(partition.rank(partition.leaf_at(centre_of_tet(input, tet))), record, input.tets[tet], [&](index_t v) {
      return VertexRecord{input.vertex_numbers[v], place_of(input.points[v])};
    });
  }
  HeldTets held;
  mail.deliver(transport, held);
  return held;
}

}  // namespace detail

}  // namespace framehex
