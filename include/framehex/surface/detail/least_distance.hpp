// SPDX-License-Identifier: BSL-1.0
#pragma once

namespace framehex::detail {

/// Distances between what curves have to tell apart, over the diagonal of all, that are too small to mesh by coordinates
/// that round.
inline constexpr double least_curve_distance = 1e-8;

}  // namespace framehex::detail
