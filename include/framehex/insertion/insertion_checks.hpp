// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/errors.hpp"

#include <cmath>
#include <sstream>
#include <string>
#include <type_traits>

namespace framehex::detail {

/// A callable that gives the wished distance between neighbours at a point.
template <class S>
concept SizeCallable = std::is_invocable_r_v<double, const S&, const Vector3&>;

/// Size at a point, refused when nothing can be built on it.
///
/// @throws invalid_field  when the size is not a positive finite number.
template <SizeCallable S>
double checked_size(const S& size, const Vector3& p) {
  const double h = size(p);
  // A size below the resolution of the coordinates would never move a point.
  if (std::isfinite(h) && h > 0x1p-40 * p.cwiseAbs().maxCoeff() && h > 0) return h;
  std::ostringstream message;
  message << "the size field is " << h << " at (" << p.x() << ", " << p.y() << ", " << p.z()
          << "); it must be positive, finite and within the precision of the coordinates";
  throw invalid_field(message.str());
}

inline void check_factor(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  std::ostringstream message;
  message << name << " is " << value << " but must be from " << low << " to " << high;
  throw invalid_option(message.str());
}

}  // namespace framehex::detail
