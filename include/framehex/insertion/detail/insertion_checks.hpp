// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/errors.hpp"

#include <cmath>
#include <span>
#include <sstream>
#include <string>

namespace framehex::detail {

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
