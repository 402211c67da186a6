// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/errors.hpp"

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <queue>
#include <vector>

namespace framehex {

/// Which accepted point proposes its neighbours next: the queue of a front.
///
/// `push(index, smoothness, generation)` adds a point (generation: steps from the seeds; smoothness: 1 where the frame
/// field is constant), `pop()` takes the next index out, `empty()` says whether there is one. `default_rejection` is
/// the least distance between points in the infinity norm, in units of the size, that suits the order;
/// `default_surface_rejection`, where there is one, the same for surfaces, and `default_least_move` the least
/// correction of a relaxation, in sizes.
template <class Q>
concept InsertionOrder = std::copyable<Q> && requires(Q queue, const Q& constant, index_t i, double smoothness) {
  queue.push(i, smoothness, i);
  { queue.pop() } -> std::same_as<index_t>;
  { constant.empty() } -> std::convertible_to<bool>;
  { Q::default_rejection } -> std::convertible_to<double>;
};

/// First in, first out: layer by layer from the seeds.
///
/// @par Source  Carrier Baudouin, Remacle, Marchandise, Henrotte, Geuzaine, "A frontal approach to hex-dominant mesh
///              generation", Adv. Model. Simul. Eng. Sci. 1:8 (2014).
class FifoOrder {
public:
  static constexpr double default_rejection = 0.7;

  void push(index_t index, double /*smoothness*/, index_t /*generation*/) { queue_.push(index); }
  index_t pop() {
    const index_t index = queue_.front();
    queue_.pop();
    return index;
  }
  bool empty() const { return queue_.empty(); }

private:
  std::queue<index_t> queue_;
};

/// Smoothest first, so that fronts meet near the singularities of the frame field and not on the medial axis.
///
/// The key is (binned smoothness, generation, index). Without the bins the last digits of the smoothness would decide
/// where the field is equally smooth; with them the front advances there layer by layer, and the order does not depend
/// on rounding.
///
/// @par Complexity   O(log n) a call; 8 bytes an entry.
/// @par Source       the paper, section 3.2. Departs: the bins and the generation.
class SmoothnessOrder {
public:
  static constexpr double default_rejection = 0.6;
  static constexpr double default_surface_rejection = 0.65;
  static constexpr double default_least_move = 0.015;

  /// @param n_bins  bins of the smoothness interval [0, 1], 1 to 255; a negative smoothness falls into the lowest.
  /// @throws invalid_option  when `n_bins` is out of range.
  explicit SmoothnessOrder(int n_bins = 20) : n_bins_(n_bins) {
    if (n_bins < 1 || n_bins > 255) throw invalid_option("the number of smoothness bins must be 1 to 255");
  }

  void push(index_t index, double smoothness, index_t generation) {
    // Written so that a NaN falls into the roughest bin.
    const double scaled = smoothness > 0 ? std::min(smoothness, 1.0) * n_bins_ : 0.0;
    const auto roughness = static_cast<std::uint64_t>(n_bins_ - std::min(static_cast<int>(scaled), n_bins_ - 1));
    queue_.push(roughness << 56 | std::uint64_t{std::min(generation, max_generation)} << 32 | index);
  }
  index_t pop() {
    const auto index = static_cast<index_t>(queue_.top());
    queue_.pop();
    return index;
  }
  bool empty() const { return queue_.empty(); }

private:
  static constexpr index_t max_generation = (index_t{1} << 24) - 1;
  int n_bins_;
  std::priority_queue<std::uint64_t, std::vector<std::uint64_t>, std::greater<>> queue_;
};

namespace detail {

template <InsertionOrder Order>
constexpr double surface_rejection() {
  if constexpr (requires { Order::default_surface_rejection; }) {
    return Order::default_surface_rejection;
  } else {
    return Order::default_rejection;
  }
}

template <InsertionOrder Order>
constexpr double least_move() {
  if constexpr (requires { Order::default_least_move; }) {
    return Order::default_least_move;
  } else {
    return 0.005;
  }
}

}  // namespace detail

static_assert(InsertionOrder<FifoOrder>);
static_assert(InsertionOrder<SmoothnessOrder>);

}  // namespace framehex
