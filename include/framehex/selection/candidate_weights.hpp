// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/recombination/candidates.hpp"

#include <algorithm>
#include <span>

namespace framehex {

/// What a candidate is worth: a callable from its number to a finite number >= 0. The three here refer to the
/// candidates, which must outlive them; a host passes any other callable.

/// Volume times least scaled Jacobian (the default): fills the domain with good hexahedra.
template <int Corners>
auto volume_times_quality(const Candidates<Corners>& candidates) {
  return [&candidates](index_t i) {
    return std::max(0.0, candidates.volume[i]) * std::max(0.0, static_cast<double>(candidates.quality[i]));
  };
}

/// One, and a little more for quality: counts cells. The small term breaks the ties of bare counting, which is several
/// times harder to prove.
///
/// @param quality_term  worth of a perfect cell above a worthless one; below 1/n never costs a cell.
template <int Corners>
auto count_with_quality(const Candidates<Corners>& candidates, double quality_term = 0.1) {
  return [&candidates, quality_term](index_t i) {
    return 1.0 + quality_term * std::max(0.0, static_cast<double>(candidates.quality[i]));
  };
}

/// Quality blended with nearness to the boundary.
///
/// @param on_boundary  by vertex: not zero when it lies on the boundary.
/// @param blend        0: quality alone; 1: share of the corners on the boundary alone.
/// @par Source   Paper, section 2.2: "a weighted sum including the element quality and the boundary proximity". It
///               gives no numbers; the share of corners and the blend of 0.5 are ours.
template <int Corners>
auto quality_and_boundary(const Candidates<Corners>& candidates, std::span<const std::uint8_t> on_boundary,
                          double blend = 0.5) {
  return [&candidates, on_boundary, blend](index_t i) {
    int n = 0;
    for (const index_t v : candidates.vertices[i]) n += on_boundary[v] != 0;
    return (1 - blend) * std::max(0.0, static_cast<double>(candidates.quality[i])) + blend * n / Corners;
  };
}

}  // namespace framehex
