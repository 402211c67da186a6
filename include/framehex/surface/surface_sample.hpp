// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <cstdint>

namespace framehex {

/// What part of a feature graph a sample lies on.
enum class SampleKind : std::uint8_t { corner, curve, surface };

/// A point chosen on a surface: a vertex of the surface to be.
struct SurfaceSample {
  Vector3 point;    ///< on the surface, within rounding
  SampleKind kind;  ///< says what `entity` counts
  index_t entity;  ///< corner: position in FeatureGraph::corners; curve: row of FeatureGraph::curves; surface: triangle
  double arc;      ///< curve: arc length from the curve's first vertex along its edges; otherwise unused
};

}  // namespace framehex
