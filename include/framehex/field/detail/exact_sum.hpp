// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace framehex::detail {

/// Sum of doubles without rounding: the same in whatever order, and by whomever, its terms are added.
///
/// A fixed-point number over the whole range of doubles, in digits of 32 bits with room for carries. Two sums are added
/// digit by digit.
/// @par Complexity   A few integer additions a term; O(digits), about 70, for `value`.
class ExactSum {
public:
  static constexpr std::size_t n_digits = 68;

  /// At most 2^30 terms between two calls of `normalize`.
  void add(double x) {
    if (x == 0) return;
    if (!std::isfinite(x)) {
      ++digits_[n_digits];
      return;
    }
    int exponent = 0;
    const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 53));
    const bool negative = mantissa < 0;
    auto rest = static_cast<std::uint64_t>(negative ? -mantissa : mantissa);
    // The last bit of the mantissa of the smallest number stands for 2^(lowest_exponent).
    auto place = static_cast<std::size_t>(exponent - 53 - lowest_exponent);
    std::size_t digit = place / 32;
    const std::size_t shift = place % 32;
    const std::uint64_t low = (rest << shift) & digit_mask;
    rest >>= 32 - shift;
    const std::array<std::uint64_t, 3> parts{low, rest & digit_mask, rest >> 32};
    for (const std::uint64_t part : parts)
      digits_[digit++] += negative ? -static_cast<std::int64_t>(part) : static_cast<std::int64_t>(part);
  }

  /// Carries: afterwards all digits but the first are in [0, 2^32).
  void normalize() {
    for (std::size_t i = 0; i + 1 < n_digits; ++i) {
      const std::int64_t carry = digits_[i] >> 32;
      digits_[i] -= carry * (std::int64_t{1} << 32);
      digits_[i + 1] += carry;
    }
  }

  /// The digits, lowest first, and the number of terms that were not finite: to be added to those of another sum.
  std::span<std::int64_t> digits() { return digits_; }

  /// The sum, rounded; NaN when a term was not finite.
  double value() const {
    if (digits_[n_digits] != 0) return std::numeric_limits<double>::quiet_NaN();
    ExactSum sum = *this;
    sum.normalize();
    const bool negative = sum.digits_[n_digits - 1] < 0;
    if (negative) {
      for (std::size_t i = 0; i < n_digits; ++i) sum.digits_[i] = -sum.digits_[i];
      sum.normalize();
    }
    std::size_t top = n_digits;
    while (top > 0 && sum.digits_[top - 1] == 0) --top;
    double result = 0;
    for (std::size_t i = top > 3 ? top - 3 : 0; i < top; ++i)
      result += std::ldexp(static_cast<double>(sum.digits_[i]), static_cast<int>(32 * i) + lowest_exponent);
    return negative ? -result : result;
  }

private:
  static constexpr int lowest_exponent = -1126;  ///< below that of the smallest number, with all its 53 bits
  static constexpr std::uint64_t digit_mask = 0xffffffffu;

  std::array<std::int64_t, n_digits + 1> digits_{};
};

}  // namespace framehex::detail
