// SPDX-License-Identifier: BSL-1.0
// Compiled twice: as everything else, and with fused multiply-adds wherever the compiler can use them.
#include "framehex/geometry/predicates.hpp"
#include "framehex/geometry/validity.hpp"

#include <rapidcheck.h>
#include <catch2/catch.hpp>

#include <boost/multiprecision/cpp_int.hpp>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>

using namespace framehex;

namespace {

using Rational = boost::multiprecision::cpp_rational;
using Point = std::array<Rational, 3>;

Point difference(const Vector3& a, const Vector3& b) {
  Point d;
  for (int i = 0; i < 3; ++i) d[static_cast<std::size_t>(i)] = Rational(a[i]) - Rational(b[i]);
  return d;
}

Point cross_product(const Point& u, const Point& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

int rational_orientation(const std::array<Vector3, 4>& p) {
  const Point n = cross_product(difference(p[1], p[0]), difference(p[2], p[0])), w = difference(p[3], p[0]);
  return Rational(n[0] * w[0] + n[1] * w[1] + n[2] * w[2]).sign();
}

int rational_turn(int axis, const std::array<Vector3, 4>& p) {
  return cross_product(difference(p[1], p[0]), difference(p[2], p[0]))[static_cast<std::size_t>(axis)].sign();
}

/// Any finite number.
double any_bits() {
  for (;;) {
    const auto bits = *rc::gen::arbitrary<std::uint64_t>();
    double x;
    std::memcpy(&x, &bits, sizeof x);
    if (std::isfinite(x)) return x;
  }
}

double uniform() {
  return std::ldexp(static_cast<double>(*rc::gen::inRange<std::int64_t>(-(1ll << 53), (1ll << 53) + 1)), -53);
}

Vector3 point(const std::function<double()>& number) {
  const double x = number(), y = number(), z = number();
  return {x, y, z};
}

/// Four points that a filter cannot decide: in one plane but for rounding, on a lattice, alike, or of any size.
std::array<Vector3, 4> awkward_points() {
  std::array<Vector3, 4> p;
  const int kind = *rc::gen::inRange(0, 6);
  const int exponent = *rc::gen::inRange(-100, 100);
  const auto number = [&]() -> double {
    switch (kind) {
      case 0: return any_bits();
      case 1: return *rc::gen::inRange(-3, 4);
      case 2: return std::ldexp(uniform(), *rc::gen::inRange(-100, 100));
      case 3: return std::ldexp(uniform(), *rc::gen::inRange(-1074, 1000));
      default: return std::ldexp(uniform(), exponent);
    }
  };
  for (Vector3& x : p) x = point(number);
  if (kind == 4) p[3] = p[0] + uniform() * (p[1] - p[0]) + uniform() * (p[2] - p[0]);
  if (kind == 5) p[2] = p[0] + uniform() * (p[1] - p[0]);
  const int last_bit = *rc::gen::inRange(0, 4);
  if (last_bit < 3) p[3][last_bit] = std::nextafter(p[3][last_bit], 0.0);
  if (*rc::gen::inRange(0, 8) == 0) p[3] = p[static_cast<std::size_t>(*rc::gen::inRange(0, 3))];
  return p;
}

}  // namespace

TEST_CASE("Orientation is the sign that rational numbers give", "[regression]") {
  std::array<int, 3> met{};
  CHECK(rc::check([&met] {
    for (int i = 0; i < 20; ++i) {
      const auto p = awkward_points();
      const int sign = orientation(p[0], p[1], p[2], p[3]);
      ++met[static_cast<std::size_t>(sign + 1)];
      RC_ASSERT(sign == rational_orientation(p));
      RC_ASSERT(orientation(p[1], p[0], p[2], p[3]) == -sign);
      RC_ASSERT(orientation(p[1], p[2], p[3], p[0]) == -sign);
    }
  }));
  for (const int n : met) CHECK(n > 50);
}

TEST_CASE("Projected orientation is the sign that rational numbers give") {
  std::array<int, 3> met{};
  CHECK(rc::check([&met] {
    for (int i = 0; i < 20; ++i) {
      const auto p = awkward_points();
      for (int axis = 0; axis < 3; ++axis) {
        const int sign = projected_orientation(axis, p[0], p[1], p[2]);
        ++met[static_cast<std::size_t>(sign + 1)];
        RC_ASSERT(sign == rational_turn(axis, p));
        RC_ASSERT(projected_orientation(axis, p[0], p[2], p[1]) == -sign);
      }
    }
  }));
  for (const int n : met) CHECK(n > 50);
}

TEST_CASE("A filter that lets an underflow pass decides nothing", "[regression]") {
  // The minor of u and v underflows (it is -2^-1080 + 2^-1081), and w is large: what the products of doubles say is not
  // the sign.
  const double tiny = 0x1p-540;
  const Vector3 a(0, 0, 0), b(tiny, tiny, 0), c(tiny, tiny / 2, 0), d(0, 0, 0x1p900);
  CHECK(orientation(a, b, c, d) == rational_orientation({a, b, c, d}));
  // The same with a filter that would be content: a second, larger term of the other sign, cancelled but for that.
  CHECK(orientation(a, b, c, d) == -1);
  CHECK(orientation(a, c, b, d) == 1);
}

TEST_CASE("Wide integers compute as integers of any length do") {
  using Big = boost::multiprecision::cpp_int;
  using Wide = detail::WideInteger<8>;
  CHECK(rc::check([] {
    const auto draw = [](std::uint64_t& digits, std::size_t& shift, bool& negative) {
      digits = *rc::gen::arbitrary<std::uint64_t>() >> *rc::gen::inRange(0, 64);
      shift = static_cast<std::size_t>(*rc::gen::inRange(0, 170));
      negative = *rc::gen::inRange(0, 2) == 1;
    };
    std::array<Wide, 3> w;
    std::array<Big, 3> b;
    for (std::size_t i = 0; i < 3; ++i) {
      std::uint64_t digits;
      std::size_t shift;
      bool negative;
      draw(digits, shift, negative);
      w[i] = Wide::shifted(digits, shift);
      b[i] = Big(digits) << static_cast<unsigned>(shift);
      if (negative) {
        w[i] = -w[i];
        b[i] = -b[i];
      }
    }
    const auto same = [](const Wide& x, const Big& y) { return x.sign() == y.sign(); };
    const int factor = *rc::gen::inRange(-64, 65);
    // (w0 w1 - w2) against its parts: equal numbers differ by 0, others by what the integers differ by.
    const Wide p = w[0] * w[1] - w[2] + factor * w[1];
    const Big q = b[0] * b[1] - b[2] + factor * b[1];
    RC_ASSERT(same(p, q));
    RC_ASSERT((w[0] < w[1]) == (b[0] < b[1]));
    RC_ASSERT((w[0] == w[1]) == (b[0] == b[1]));
    RC_ASSERT(quarter(4 * p) == p);
    RC_ASSERT(p - w[0] * w[1] == factor * w[1] - w[2]);
    RC_ASSERT(Wide(factor) * w[2] == factor * w[2]);
  }));
}
