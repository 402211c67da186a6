// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/errors.hpp"

#include <cmath>
#include <span>
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

/// The same values, refused when they are not one for each of `n` entities.
template <class T>
std::span<const T> one_each(std::span<const T> values, std::size_t n, const char* values_name, const char* entities) {
  if (values.size() == n) return values;
  throw invalid_option("there are " + std::to_string(values.size()) + " " + values_name + " for " + std::to_string(n) +
                       " " + entities);
}

inline void check_factor(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  std::ostringstream message;
  message << name << " is " << value << " but must be from " << low << " to " << high;
  throw invalid_option(message.str());
}

}  // namespace framehex::detail
