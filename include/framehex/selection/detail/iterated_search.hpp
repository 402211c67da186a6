// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/detail/bitset_search.hpp"
#include "framehex/selection/detail/local_search.hpp"

#include <boost/random/uniform_int_distribution.hpp>

#include <memory>
#include <random>

namespace framehex {

/// Local search that escapes from where it is stuck, by random forced changes and by exact windows.
///
/// A perturbation forces a few candidates in near one place, lets the local search repair, and is taken back when
/// weight was lost. A window opens the members of the set nearest to one place together with all that only they keep
/// out, and solves that exactly.
///
/// @par Determinism  Serial; from the seed.
template <ConflictSource G>
class IteratedSearch {
public:
  IteratedSearch(const G& graph, std::span<const index_t> members, std::uint64_t seed = 1)
      : graph_(graph),
        search_(graph),
        random_(seed),
        local_(graph.size(), no_index),
        n_freed_owners_(graph.size(), 0),
        reached_(graph.size(), 0) {
    search_.assign(members);
    search_.improve();
    search_.commit();
  }

  std::int64_t weight_in_units() const { return search_.weight_in_units(); }
  std::vector<index_t> members() const { return search_.members(); }
  std::size_t iterations() const { return n_iterations_; }
  bool contains(index_t v) const { return search_.contains(v); }

  /// Goes over to another selection, after local search, when that is heavier. @pre independent.
  void offer(std::span<const index_t> members) {
    if (!other_) other_ = std::make_unique<LocalSearch<G>>(graph_);
    other_->assign(members);
    other_->improve();
    if (other_->weight_in_units() <= search_.weight_in_units()) return;
    search_.assign(other_->members());
    search_.improve();
    search_.commit();
  }

  /// Tries `n` perturbations at random places among `places`.
  ///
  /// @param stop  asked now and then.
  template <class Stop>
  void perturb(std::span<const index_t> places, std::size_t n, Stop&& stop) {
    if (places.empty()) return;
    for (std::size_t i = 0; i < n && !(i % 256 == 0 && stop()); ++i) {
      ++n_iterations_;
      const std::int64_t before = search_.weight_in_units();
      index_t v = places[pick(places.size())];
      const std::size_t n_forced = 1 + (pick(4) == 0 ? 1 + pick(3) : 0);
      for (std::size_t k = 0; k < n_forced; ++k) {
        search_.force_and_lock(v);
        // Two steps away lies a candidate that can stand beside the first.
        if (!step(v)) break;
        step(v);
      }
      search_.improve();
      search_.unlock();
      search_.improve();
      if (search_.weight_in_units() < before)
        search_.roll_back();
      else
        search_.commit();
    }
  }

  /// Opens a window of about `n_free` candidates at `centre` and solves it.
  /// @return true when the set has become heavier.
  bool solve_window(index_t centre, std::size_t n_free, std::size_t max_nodes) {
    ++n_iterations_;
    open_window(centre, n_free);
    const auto weights = graph_.weights_in_units();
    std::int64_t inside = 0;
    window_weights_.clear();
    for (const index_t v : window_) {
      local_[v] = static_cast<index_t>(window_weights_.size());
      window_weights_.push_back(weights[v]);
      if (search_.contains(v)) inside += weights[v];
    }
    exact_.assign(window_weights_);
    for (const index_t v : window_)
      graph_.for_each_conflict(v, [&](index_t u) {
        if (u < v && local_[u] != no_index) exact_.add_conflict(local_[u], local_[v]);
      });
    for (const index_t v : window_) local_[v] = no_index;
    exact_.solve(inside, max_nodes);
    if (exact_.members().empty()) return false;
    for (const index_t v : window_)
      if (search_.contains(v)) search_.drop(v);
    for (const index_t i : exact_.members()) search_.force(window_[i]);
    search_.improve();
    search_.commit();
    return true;
  }

  /// Solves windows of about `n_free` candidates all over the set.
  template <class Stop>
  void solve_windows(std::size_t n_free, std::size_t max_nodes, Stop&& stop) {
    const std::vector<index_t> centres = members();
    // Each window opens several members, so that every other one is enough.
    for (std::size_t i = 0; i < centres.size() && !(i % 64 == 0 && stop()); i += 2)
      solve_window(centres[i], n_free, max_nodes);
  }

private:
  std::size_t pick(std::size_t n) { return boost::random::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }

  /// Goes to a random neighbour. @return false when there is none.
  bool step(index_t& v) {
    row_.clear();
    graph_.for_each_conflict(v, [this](index_t u) { row_.push_back(u); });
    if (row_.empty()) return false;
    v = row_[pick(row_.size())];
    return true;
  }

  /// Members of the set in breadth-first order round the centre, until those that only they keep out are enough.
  void open_window(index_t centre, std::size_t n_free) {
    ++stamp_;
    window_.clear();
    front_.assign(1, centre);
    reached_[centre] = stamp_;
    freed_.clear();
    for (std::size_t next = 0; next < front_.size() && window_.size() < n_free; ++next) {
      const index_t v = front_[next];
      if (search_.contains(v)) open_member(v);
      graph_.for_each_conflict(v, [this](index_t u) {
        if (reached_[u] == stamp_) return;
        reached_[u] = stamp_;
        front_.push_back(u);
      });
    }
    for (const index_t v : freed_) n_freed_owners_[v] = 0;
  }

  void open_member(index_t member) {
    window_.push_back(member);
    graph_.for_each_conflict(member, [this](index_t u) {
      if (n_freed_owners_[u] == 0) freed_.push_back(u);
      ++n_freed_owners_[u];
      if (n_freed_owners_[u] == search_.n_owners(u)) window_.push_back(u);
    });
  }

  const G& graph_;
  LocalSearch<G> search_;
  std::unique_ptr<LocalSearch<G>> other_;
  std::mt19937_64 random_;
  detail::BitsetSearch exact_;
  std::vector<index_t> local_, n_freed_owners_, window_, front_, freed_, row_;
  std::vector<std::int64_t> window_weights_;
  std::vector<std::uint32_t> reached_;
  std::uint32_t stamp_ = 0;
  std::size_t n_iterations_ = 0;
};

namespace detail {

/// Where a selection and its relaxation do not agree.
template <ConflictSource G>
std::vector<index_t> doubtful(const IteratedSearch<G>& search, std::span<const float> primal) {
  std::vector<index_t> places;
  for (index_t v = 0; v < primal.size(); ++v)
    if (search.contains(v) ? primal[v] < 0.9F : primal[v] > 0.1F) places.push_back(v);
  return places;
}

/// A selection from a relaxed one: largest shares first.
inline std::vector<index_t> round_relaxation(const IncompatibilityGraph& graph, std::span<const float> primal) {
  std::vector<index_t> order(graph.size());
  std::iota(order.begin(), order.end(), index_t{0});
  const auto heavier = heavier_first(graph, by_number);
  std::sort(order.begin(), order.end(),
            [&](index_t u, index_t v) { return primal[u] != primal[v] ? primal[u] > primal[v] : heavier(u, v); });
  Occupancy<IncompatibilityGraph> occupied(graph);
  std::vector<index_t> members;
  for (const index_t v : order)
    if (!occupied.blocks(v)) occupied.add(v), members.push_back(v);
  return members;
}

}  // namespace detail

}  // namespace framehex
