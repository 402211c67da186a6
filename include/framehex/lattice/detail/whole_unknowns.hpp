// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace framehex::detail {

/// A sum of unknowns with whole coefficients, by ascending unknown; none is zero.
using WholeSum = std::vector<std::pair<index_t, int>>;

/// a + factor b.
inline WholeSum sum_of(const WholeSum& a, const WholeSum& b, int factor = 1) {
  WholeSum result;
  result.reserve(a.size() + b.size());
  auto i = a.begin();
  for (const auto& [unknown, coefficient] : b) {
    while (i != a.end() && i->first < unknown) result.push_back(*i++);
    const int other = i != a.end() && i->first == unknown ? (i++)->second : 0;
    if (const int c = other + factor * coefficient; c != 0) result.push_back({unknown, c});
  }
  result.insert(result.end(), i, a.end());
  return result;
}

/// Unknown whole numbers, and what is known of sums of them.
///
/// Each relation expresses an unknown that it has once, or once negated, by the others, so that what is left can be
/// chosen freely.
class WholeUnknowns {
public:
  index_t add() {
    expressions_.emplace_back();
    return static_cast<index_t>(expressions_.size() - 1);
  }

  /// How many can be chosen freely.
  std::size_t n_free() const {
    return static_cast<std::size_t>(std::count(expressions_.begin(), expressions_.end(), std::nullopt));
  }

  /// The sum in unknowns that are left.
  WholeSum reduced(const WholeSum& sum) {
    const auto is_expressed = [this](const auto& term) { return expressions_[term.first].has_value(); };
    if (std::none_of(sum.begin(), sum.end(), is_expressed)) return sum;
    WholeSum result;
    for (const auto& [unknown, coefficient] : sum) {
      if (expressions_[unknown]) {
        expressions_[unknown] = reduced(*expressions_[unknown]);
        result = sum_of(result, *expressions_[unknown], coefficient);
      } else {
        result = sum_of(result, {{unknown, 1}}, coefficient);
      }
    }
    return result;
  }

  /// Lets a sum be zero. @param first_kept  from here on unknowns stay, if others can go.
  /// @return false when there is none to express: then the relation is forgotten.
  bool set_zero(const WholeSum& sum, index_t first_kept = no_index) {
    WholeSum left = reduced(sum);
    if (left.empty()) return true;
    int divisor = 0;
    for (const auto& term : left) divisor = std::gcd(divisor, term.second);
    for (auto& term : left) term.second /= divisor;
    return express(left, first_kept) || express(left, no_index);
  }

private:
  /// By the last unknown that can be expressed by the others.
  bool express(const WholeSum& zero, index_t end) {
    for (std::size_t i = zero.size(); i-- > 0;) {
      const auto [unknown, sign] = zero[i];
      if (unknown >= end || std::abs(sign) != 1) continue;
      expressions_[unknown] = sum_of({}, sum_of(zero, {{unknown, sign}}, -1), -sign);
      return true;
    }
    return false;
  }

  std::vector<std::optional<WholeSum>> expressions_;  // per unknown
};

}  // namespace framehex::detail
