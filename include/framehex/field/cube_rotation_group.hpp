// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <type_traits>

namespace framehex {

/// How one frame turns into another by the least rotation.
template <class Scalar>
struct Matching {
  Eigen::Quaternion<Scalar> rotation;  ///< in space; takes the first frame to `second * inverse(symmetry)`; w >= 0
  Eigen::Matrix<Scalar, 3, 1> axis;    ///< unit; (1, 0, 0) when the frames coincide
  Scalar angle = 0;                    ///< radians, 0 to 1.0961 (62.8 degrees)
  int symmetry = 0;                    ///< element of the group
};

namespace detail {

/// Elements and tables of the group, computed by the compiler.
template <class Scalar>
struct CubeTables {
  using Components = std::array<Scalar, 4>;  // w, x, y, z

  /// The 24 elements, and again with the opposite sign: the same rotations.
  std::array<Components, 48> elements{};
  std::array<std::array<signed char, 24>, 24> products{};
  std::array<signed char, 24> inverses{};
  /// Which components of the nearest element are not zero, a bit each: by its kind (bit 0: two beat one, bit 1: four
  /// beat both) and by the outcome of the comparisons "is component j greater than i", a bit each for the pairs
  /// 01 02 03 12 13 23 from the highest to the lowest. Ties leave the earlier component ahead.
  std::array<std::array<unsigned char, 64>, 4> support{};
  /// The element, with the sign that makes it nearest as a quaternion, by its support and the signs of the components,
  /// a bit each from the highest to the lowest.
  std::array<std::array<unsigned char, 16>, 16> signed_element{};

  static constexpr Components product(const Components& a, const Components& b) {
    return {
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
  }

  static constexpr CubeTables make() {
    CubeTables t;
    t.make_elements();
    t.make_supports();
    // The element of a support whose signs are those of the components.
    for (std::size_t e = 0; e < 48; ++e) {
      const auto [support, negative] = pattern(t.elements[e]);
      for (std::size_t signs = 0; signs < 16; ++signs)
        if ((signs & support) == negative) t.signed_element[support][signs] = static_cast<unsigned char>(e);
    }
    for (std::size_t i = 0; i < 24; ++i)
      for (std::size_t j = 0; j < 24; ++j) {
        const auto [support, negative] = pattern(product(t.elements[i], t.elements[j]));
        const int k = t.signed_element[support][negative] % 24;
        t.products[i][j] = static_cast<signed char>(k);
        if (k == 0) t.inverses[i] = static_cast<signed char>(j);
      }
    return t;
  }

private:
  constexpr void make_elements() {
    constexpr Scalar root_half = std::numbers::sqrt2_v<Scalar> / 2, half = Scalar(1) / 2;
    for (std::size_t i = 0; i < 4; ++i) elements[i][i] = 1;
    std::size_t next = 4;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        for (const Scalar sign : {Scalar(1), Scalar(-1)}) {
          elements[next][i] = root_half;
          elements[next++][j] = sign * root_half;
        }
    for (unsigned bits = 0; bits < 8; ++bits)
      elements[next++] = {half, bits & 1U ? -half : half, bits & 2U ? -half : half, bits & 4U ? -half : half};
    for (; next < 48; ++next)
      for (std::size_t i = 0; i < 4; ++i)
        if (elements[next - 24][i] != 0) elements[next][i] = -elements[next - 24][i];
  }

  constexpr void make_supports() {
    for (std::size_t order = 0; order < 64; ++order) {
      std::array<int, 4> losses{};
      std::size_t bit = 6;
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j) ++losses[order >> --bit & 1U ? i : j];
      for (std::size_t kind = 0; kind < 4; ++kind) {
        const int n = kind > 1 ? 4 : kind == 1 ? 2 : 1;
        for (std::size_t i = 0; i < 4; ++i)
          support[kind][order] = static_cast<unsigned char>(2 * support[kind][order] + (losses[i] < n ? 1 : 0));
      }
    }
  }

  /// Which components of an element are not zero, and which are negative, but for rounding; a bit each from the highest
  /// to the lowest.
  static constexpr std::array<std::size_t, 2> pattern(const Components& q) {
    std::size_t support = 0, negative = 0;
    for (const Scalar x : q) {
      support = 2 * support + (x > Scalar(0.25) || x < Scalar(-0.25) ? 1 : 0);
      negative = 2 * negative + (x < Scalar(-0.25) ? 1 : 0);
    }
    return {support, negative};
  }
};

template <class Scalar>
inline constexpr CubeTables<Scalar> cube_tables = CubeTables<Scalar>::make();

/// Appends the sign bit of x to a number as its lowest bit: whether x < 0, unless x is -0.
template <class Scalar>
std::size_t with_sign(std::size_t number, Scalar x) {
  using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
  return 2 * number + static_cast<std::size_t>(std::bit_cast<Bits>(x) >> (8 * sizeof(Bits) - 1));
}

}  // namespace detail

/// The 24 rotations of the cube, and frames modulo them.
///
/// A frame is a unit quaternion p whose axes are the columns of its matrix; p and p g are the same frame for every
/// element g. Elements are numbered by kind: 0 the identity, 1 to 3 the half turns about x, y, z, 4 to 9 the
/// quarter turns about x, -x, y, -y, z, -z, 10 to 15 the half turns about the cube's edges, 16 to 23 the third turns.
///
/// Everything is O(1), stateless and safe to call from any thread. Ties (frames at equal distance) go to the element
/// with fewer non-zero components, then to the earlier component, and 0 counts as positive: the same on every platform.
///
/// @tparam Scalar  float or double.
template <class Scalar = double>
class CubeRotationGroup {
public:
  using Rotation = Eigen::Quaternion<Scalar>;
  using Vector = Eigen::Matrix<Scalar, 3, 1>;

  static constexpr int size() { return 24; }

  /// @pre 0 <= element < 24, here and below.
  static Rotation element(int g) {
    const std::array<Scalar, 4>& q = tables.elements[at(g)];
    return Rotation(q[0], q[1], q[2], q[3]);
  }

  /// The element that does `second` first, then `first`: element(first) * element(second).
  static constexpr int compose(int first, int second) { return tables.products[at(first)][at(second)]; }
  static constexpr int inverse(int g) { return tables.inverses[at(g)]; }

  /// 1, 2, 3 or 4: how often an element is to be repeated to give the identity.
  static constexpr int order(int g) {
    int n = 1;
    for (int power = g; power != 0; power = compose(power, g)) ++n;
    return n;
  }

  /// The element nearest to a rotation.
  ///
  /// Its distance follows from the sorted absolute components a >= b >= c >= d of q: the cosine of half the angle is
  /// the largest of a, (a+b)/sqrt 2 and (a+b+c+d)/2, and which one it is names the element.
  static int nearest(const Rotation& q) {
    return static_cast<int>(nearest_element({q.w(), q.x(), q.y(), q.z()}).number % 24);
  }

  /// The representative p g of frame `p` that is the least rotation, with w >= 0 (the fundamental zone).
  static Rotation representative(const Rotation& p) { return positive(p * element(inverse(nearest(p)))); }

  /// The representative of frame `p` that is nearest to `reference`, on the same side of the sphere of quaternions.
  static Rotation aligned(const Rotation& reference, const Rotation& p) {
    Rotation result = p * element(inverse(nearest(reference.conjugate() * p)));
    if (result.dot(reference) < 0) result.coeffs() = -result.coeffs();
    return result;
  }

  /// Least rotation from one frame to another.
  ///
  /// @param from, to  unit quaternions.
  /// @par Source  The paper, section 3.3, which tries the 24 in turn.
  static Matching<Scalar> matching(const Rotation& from, const Rotation& to) {
    Matching<Scalar> m;
    m.symmetry = nearest(from.conjugate() * to);
    m.rotation = positive(to * element(inverse(m.symmetry)) * from.conjugate());
    const Scalar sine = m.rotation.vec().norm();
    m.angle = 2 * std::atan2(sine, m.rotation.w());
    m.axis = sine > 0 ? Vector(m.rotation.vec() / sine) : Vector::UnitX();
    return m;
  }

  /// Axis times angle of the least rotation from one frame to another; the zero vector when they coincide.
  static Vector rotation_vector(const Rotation& from, const Rotation& to) {
    const Scalar w = from.w(), x = from.x(), y = from.y(), z = from.z();
    const auto [cosine, number] = nearest_element(between(from, to));
    const Components& g = tables.elements[number];
    // The form of `to` nearest to `from` is p = to * conj(g); the rotation is p * conj(from).
    const Components p = Tables::product({to.w(), to.x(), to.y(), to.z()}, {g[0], -g[1], -g[2], -g[3]});
    const Scalar factor = angle_per_sine(cosine);
    return Vector(factor * ((p[1] * w - p[0] * x) + (p[3] * y - p[2] * z)),
                  factor * ((p[2] * w - p[0] * y) + (p[1] * z - p[3] * x)),
                  factor * ((p[3] * w - p[0] * z) + (p[2] * x - p[1] * y)));
  }

  /// Angle of the least rotation from one frame to another, radians.
  static Scalar angle(const Rotation& from, const Rotation& to) {
    const Components q = between(from, to);
    const auto [cosine, number] = nearest_element(q);
    const Components& g = tables.elements[number];
    const Scalar x = (q[1] * g[0] - q[0] * g[1]) + (q[3] * g[2] - q[2] * g[3]);
    const Scalar y = (q[2] * g[0] - q[0] * g[2]) + (q[1] * g[3] - q[3] * g[1]);
    const Scalar z = (q[3] * g[0] - q[0] * g[3]) + (q[2] * g[1] - q[1] * g[2]);
    return angle_per_sine(cosine) * std::sqrt(x * x + y * y + z * z);
  }

  /// Axis times angle of a rotation with w >= 0.
  static Vector logarithm(const Rotation& q) {
    const Scalar sine = q.vec().norm();
    if (sine < Scalar(1e-12)) return 2 * q.vec();
    return q.vec() * (2 * std::atan2(sine, q.w()) / sine);
  }

  /// The rotation by |v| radians about v.
  static Rotation exponential(const Vector& v) {
    const Scalar half = v.norm() / 2;
    const Scalar factor = half < Scalar(1e-6) ? Scalar(0.5) : std::sin(half) / (2 * half);
    Rotation q;
    q.w() = std::cos(half);
    q.vec() = factor * v;
    return q;
  }

private:
  using Tables = detail::CubeTables<Scalar>;
  using Components = typename Tables::Components;
  static constexpr const Tables& tables = detail::cube_tables<Scalar>;

  struct NearestElement {
    Scalar cosine;       ///< of half the angle between, >= 0
    std::size_t number;  ///< in `tables.elements`, with the sign that makes the cosine positive
  };

  /// Without a branch, which random rotations would mislead: the outcomes of comparisons are looked up.
  static NearestElement nearest_element(const Components& q) {
    const Scalar a = std::abs(q[0]), b = std::abs(q[1]), c = std::abs(q[2]), d = std::abs(q[3]);
    const Scalar first = std::max(std::max(a, b), std::max(c, d));
    const Scalar high = std::min(std::max(a, b), std::max(c, d)), low = std::max(std::min(a, b), std::min(c, d));
    const Scalar two = (first + std::max(high, low)) * (std::numbers::sqrt2_v<Scalar> / 2), four = (a + b + c + d) / 2;
    const Scalar cosine = std::max(std::max(first, two), four);
    using detail::with_sign;
    const std::size_t kind = with_sign(with_sign(std::size_t{0}, std::max(first, two) - four), first - two);
    std::size_t order = with_sign(with_sign(with_sign(std::size_t{0}, a - b), a - c), a - d);
    order = with_sign(with_sign(with_sign(order, b - c), b - d), c - d);
    // Adding 0 makes 0 of -0: which zero it is must not decide.
    const std::size_t half = with_sign(with_sign(std::size_t{0}, q[0] + 0), q[1] + 0);
    const std::size_t signs = with_sign(with_sign(half, q[2] + 0), q[3] + 0);
    return {cosine, tables.signed_element[tables.support[kind][order]][signs]};
  }

  static Components between(const Rotation& from, const Rotation& to) {
    return Tables::product({from.w(), -from.x(), -from.y(), -from.z()}, {to.w(), to.x(), to.y(), to.z()});
  }

  /// Angle over sine of half the angle, by the cosine w of half the angle, of a rotation by at most 62.8 degrees: 2
  /// acos(w) / sqrt(1 - w^2) as the polynomial in 1 - w that is exact at 0 and at the Chebyshev points of [0, 0.15],
  /// within 4e-17. The library's inverse functions would take half of the time of a matching.
  static Scalar angle_per_sine(Scalar w) {
    const Scalar e = 1 - w, e2 = e * e, e4 = e2 * e2;
    const Scalar low = (2 + e * Scalar(0.6666666666666668742)) +
                       e2 * (Scalar(0.2666666666664416681) + e * Scalar(0.114285714325791256));
    const Scalar high = (Scalar(0.05079364805092290552) + e * Scalar(0.0230881168649357621)) +
                        e2 * (Scalar(0.0106542165348718333) + e * Scalar(0.004992838037330164992));
    return low + e4 * (high + e4 * (Scalar(0.00221140883239304201) + e * Scalar(0.001540742843397663048)));
  }

  static constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }
  static Rotation positive(Rotation q) {
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    return q;
  }
};

}  // namespace framehex
