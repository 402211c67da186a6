// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"

#include <limits>
#include <optional>
#include <sstream>

namespace framehex {

/// Bounds for numbers of which only the sign matters.
/// @{
inline constexpr double least_positive = std::numeric_limits<double>::min();
inline constexpr double largest_finite = std::numeric_limits<double>::max();
inline constexpr double unbounded = std::numeric_limits<double>::infinity();
/// @}

namespace detail {

/// Refuses a number outside its range, NaN included; a number that is not given is within any.
struct RangeCheck {
  template <class T>
  void operator()(const char* name, const T& value, double least, double most) const {
    const auto x = static_cast<double>(value);
    if (x >= least && x <= most) return;
    std::ostringstream message;
    message << name << " is " << value << " but must be from " << least << " to " << most;
    throw invalid_option(message.str());
  }
  template <class T>
  void operator()(const char* name, const std::optional<T>& value, double least, double most) const {
    if (value) (*this)(name, *value, least, most);
  }
};

}  // namespace detail

/// Checks every number of an options struct, those of the structs inside it too, against its documented range.
///
/// Every options struct lists its numbers once, in a static `each_number(options, visit)` that calls
/// `visit(name, number, least, most)` for each, both bounds included. All stages check theirs by this before any work.
///
/// @throws invalid_option  with the name of the number, its value and its range.
template <class Options>
void check_options(const Options& options) {
  Options::each_number(options, detail::RangeCheck{});
}

}  // namespace framehex
