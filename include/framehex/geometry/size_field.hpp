// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/errors.hpp"

#include <cmath>
#include <concepts>
#include <sstream>

namespace framehex {

/// A size field: the edge length wanted at a point, in the host's unit. Any callable will do.
template <class S>
concept SizeField = requires(const S& size, const Vector3& p) {
  { size(p) } -> std::convertible_to<double>;
};

/// The same length everywhere.
struct ConstantSize {
  double length = 1;
  double operator()(const Vector3&) const { return length; }
};

namespace detail {

/// Size at a point, refused when nothing can be built on it.
///
/// @throws invalid_field  when the size is not a positive finite number.
template <SizeField S>
double checked_size(const S& size, const Vector3& p) {
  const double h = size(p);
  // A size below the resolution of the coordinates would never move a point.
  if (std::isfinite(h) && h > 0x1p-40 * p.cwiseAbs().maxCoeff() && h > 0) return h;
  std::ostringstream message;
  message << "the size field is " << h << " at (" << p.x() << ", " << p.y() << ", " << p.z()
          << "); it must be positive, finite and within the precision of the coordinates";
  throw invalid_field(message.str());
}

}  // namespace detail

}  // namespace framehex
