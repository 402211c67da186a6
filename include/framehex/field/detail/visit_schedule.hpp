// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/csr.hpp"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace framehex::detail {

/// Cuts an order of visits into stages that hold no two neighbours, such that every vertex comes after those of its
/// neighbours that precede it in the order, and before those that follow: visiting stage by stage, in parallel within
/// each, gives to the bit what visiting one by one in the order gives.
///
/// Vertices of the order that are visited elsewhere are waited for, until `arrived`.
class VisitSchedule {
public:
  /// @param ring    neighbours of each vertex.
  /// @param is_own  `is_own(v)`: whether the vertex is visited here.
  /// @par Complexity  O(edges) for the whole.
  template <class IsOwn>
  VisitSchedule(const Csr<index_t>& ring, std::span<const index_t> order, const IsOwn& is_own)
      : ring_(ring), place_(ring.size(), not_due), n_waits_(ring.size(), 0) {
    for (std::size_t i = 0; i < order.size(); ++i) place_[order[i]] = static_cast<index_t>(i);
    for (const index_t v : order) {
      if (!is_own(v)) {
        n_waits_[v] = elsewhere;
        continue;
      }
      ++n_left_;
      for (const index_t w : ring[v]) n_waits_[v] += place_[w] < place_[v];
      if (n_waits_[v] == 0) ready_.push_back(v);
    }
  }

  /// Takes the vertices that wait for nobody as the next stage. @return false when there are none.
  bool next_stage() {
    for (const index_t v : stage_) release_after(v);
    stage_.swap(ready_);
    ready_.clear();
    n_left_ -= static_cast<std::int64_t>(stage_.size());
    return !stage_.empty();
  }

  std::span<const index_t> stage() const { return stage_; }
  std::int64_t n_left() const { return n_left_; }  ///< of those to be visited here

  /// A vertex was visited elsewhere.
  void arrived(index_t v) { release_after(v); }

private:
  static constexpr index_t not_due = no_index;
  static constexpr index_t elsewhere = no_index;

  void release_after(index_t v) {
    for (const index_t w : ring_[v])
      if (place_[w] != not_due && place_[w] > place_[v] && n_waits_[w] != elsewhere && --n_waits_[w] == 0)
        ready_.push_back(w);
  }

  const Csr<index_t>& ring_;
  std::vector<index_t> place_, n_waits_;
  std::vector<index_t> ready_, stage_;
  std::int64_t n_left_ = 0;
};

}  // namespace framehex::detail
