// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <limits>

/// Exact arithmetic on coordinates: integers of a width that is known beforehand, all times one power of two.
///
/// No floating-point operation takes part, so that neither fused multiply-adds nor rounding, underflow or overflow can
/// touch a sign; and there is no memory to allocate.
namespace framehex::detail {

/// Integer modulo 2^(64 Limbs), negative when its highest bit is set. Whoever computes with it chooses the width such
/// that nothing is cut off.
template <std::size_t Limbs>
class WideInteger {
public:
  WideInteger() : limbs_{} {}
  WideInteger(int value) {  // NOLINT: a number among numbers
    limbs_.fill(value < 0 ? ~std::uint64_t{0} : 0);
    limbs_[0] = static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
  }

  /// value * 2^shift
  static WideInteger shifted(std::uint64_t value, std::size_t shift) {
    WideInteger result;
    const std::size_t limb = shift / 64, rest = shift % 64;
    result.limbs_[limb] = value << rest;
    if (rest != 0 && limb + 1 < Limbs) result.limbs_[limb + 1] = value >> (64 - rest);
    return result;
  }

  bool is_negative() const { return limbs_[Limbs - 1] >> 63 != 0; }

  int sign() const {
    if (is_negative()) return -1;
    for (const std::uint64_t limb : limbs_)
      if (limb != 0) return 1;
    return 0;
  }

  friend WideInteger operator+(const WideInteger& a, const WideInteger& b) {
    WideInteger sum;
    Double carry = 0;
    for (std::size_t i = 0; i < Limbs; ++i) {
      carry += Double{a.limbs_[i]} + b.limbs_[i];
      sum.limbs_[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    return sum;
  }

  friend WideInteger operator-(const WideInteger& a, const WideInteger& b) {
    WideInteger difference;
    Double carry = 1;
    for (std::size_t i = 0; i < Limbs; ++i) {
      carry += Double{a.limbs_[i]} + ~b.limbs_[i];
      difference.limbs_[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    return difference;
  }

  friend WideInteger operator-(const WideInteger& a) { return WideInteger() - a; }

  friend WideInteger operator*(const WideInteger& a, const WideInteger& b) {
    WideInteger product;
    for (std::size_t i = 0; i < Limbs; ++i) product.add_multiple(b, a.limbs_[i], i);
    return product;
  }

  friend WideInteger operator*(int factor, const WideInteger& a) {
    WideInteger product;
    product.add_multiple(a, static_cast<std::uint64_t>(factor < 0 ? -factor : factor), 0);
    return factor < 0 ? -product : product;
  }

  /// A quarter of a multiple of 4.
  friend WideInteger quarter(const WideInteger& a) {
    WideInteger result;
    for (std::size_t i = 0; i + 1 < Limbs; ++i) result.limbs_[i] = a.limbs_[i] >> 2 | a.limbs_[i + 1] << 62;
    result.limbs_[Limbs - 1] = static_cast<std::uint64_t>(static_cast<std::int64_t>(a.limbs_[Limbs - 1]) >> 2);
    return result;
  }

  friend std::strong_ordering operator<=>(const WideInteger& a, const WideInteger& b) {
    if (a.is_negative() != b.is_negative()) return b.is_negative() <=> a.is_negative();
    for (std::size_t i = Limbs; i-- > 0;)
      if (a.limbs_[i] != b.limbs_[i]) return a.limbs_[i] <=> b.limbs_[i];
    return std::strong_ordering::equal;
  }
  friend bool operator==(const WideInteger& a, const WideInteger& b) = default;

private:
  __extension__ using Double = unsigned __int128;

  /// Adds b * factor * 2^(64 place).
  void add_multiple(const WideInteger& b, std::uint64_t factor, std::size_t place) {
    std::uint64_t carry = 0;
    for (std::size_t i = 0; i + place < Limbs; ++i) {
      const Double sum = Double{factor} * b.limbs_[i] + limbs_[i + place] + carry;
      limbs_[i + place] = static_cast<std::uint64_t>(sum);
      carry = static_cast<std::uint64_t>(sum >> 64);
    }
  }

  std::array<std::uint64_t, Limbs> limbs_;  ///< least significant first
};

/// A finite number as sign * digits * 2^exponent, with `digits` odd or 0.
struct BinaryNumber {
  explicit BinaryNumber(double x) {
    const auto bits = std::bit_cast<std::uint64_t>(x);
    const int biased = static_cast<int>(bits >> 52 & 0x7ff);
    is_negative = bits >> 63 != 0;
    digits = (bits & 0xfffffffffffff) | std::uint64_t{biased != 0} << 52;
    if (digits == 0) return;
    const int zeros = std::countr_zero(digits);
    digits >>= zeros;
    exponent = (biased == 0 ? 1 : biased) - 1075 + zeros;
  }

  std::uint64_t digits;
  int exponent = 0;
  bool is_negative;
};

/// The binary places that some numbers use: with 2^-lowest as the common factor each is an integer of `width()` bits.
class BinaryPlaces {
public:
  void add(double x) {
    const BinaryNumber number(x);
    if (number.digits == 0) return;
    lowest_ = std::min(lowest_, number.exponent);
    end_ = std::max(end_, number.exponent + static_cast<int>(std::bit_width(number.digits)));
  }

  std::size_t width() const { return end_ > lowest_ ? static_cast<std::size_t>(end_ - lowest_) : 0; }

  /// x times the common factor.
  template <std::size_t Limbs>
  WideInteger<Limbs> scaled(double x) const {
    const BinaryNumber number(x);
    if (number.digits == 0) return {};
    const auto magnitude =
        WideInteger<Limbs>::shifted(number.digits, static_cast<std::size_t>(number.exponent - lowest_));
    return number.is_negative ? -magnitude : magnitude;
  }

private:
  int lowest_ = std::numeric_limits<int>::max(), end_ = std::numeric_limits<int>::min();
};

/// Calls `f.operator()<Limbs>()` for the least of some widths that hold `bits` bits. The widest holds polynomials of
/// degree 6 in coordinates that reach from the least denormal number to the largest.
template <class F>
auto with_wide_integers(std::size_t bits, F&& f) {
  if (bits <= 64 * 4) return f.template operator()<4>();
  if (bits <= 64 * 8) return f.template operator()<8>();
  if (bits <= 64 * 32) return f.template operator()<32>();
  return f.template operator()<208>();
}

}  // namespace framehex::detail
