// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/option_ranges.hpp"

#include <span>
#include <string>

namespace framehex::detail {

/// The same values, refused when they are not one for each of `n` entities.
template <class T>
std::span<const T> one_each(std::span<const T> values, std::size_t n, const char* values_name, const char* entities) {
  if (values.size() == n) return values;
  throw invalid_option("there are " + std::to_string(values.size()) + " " + values_name + " for " + std::to_string(n) +
                       " " + entities);
}

inline void check_link_distance(double link_distance, double rejection) {
  RangeCheck{}("link_distance", link_distance, 0, rejection);
}

}  // namespace framehex::detail
