// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace framehex {

/// What greedy, dynamic greedy, local search and windows ask of the conflicts among n candidates, stored or found when
/// asked for. Models: `IncompatibilityGraph` (stored), `ImplicitIncompatibilityGraph` (from the candidates themselves).
///
/// - `g.size()`: n.
/// - `g.weights_in_units()`: n weights >= 0 as multiples of `g.unit()`; the sum of all is below 2^53.
/// - `g.for_each_conflict(v, f)`: calls `f(u)` once for each candidate u that cannot stand beside v, in any order.
/// - `g.conflicts(u, v)`: whether u and v exclude one another; false when they are the same.
template <class G>
concept ConflictSource = requires(const G& g, index_t v, void (*f)(index_t)) {
  { g.size() } -> std::convertible_to<std::size_t>;
  { g.weights_in_units() } -> std::convertible_to<std::span<const std::int64_t>>;
  { g.unit() } -> std::convertible_to<double>;
  g.for_each_conflict(v, f);
  { g.conflicts(v, v) } -> std::convertible_to<bool>;
};

}  // namespace framehex
