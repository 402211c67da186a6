// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

namespace framehex {

/// A point of a triangulated surface, usually the nearest to some query.
struct SurfacePoint {
  index_t triangle;     ///< that holds the point; the smallest of several
  Vector3 barycentric;  ///< weights of its corners, >= 0, sum 1
  Vector3 point;        ///< the same in space
  double distance;      ///< from the query
};

}  // namespace framehex
