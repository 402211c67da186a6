// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

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

  std::array<Components, 24> elements{};
  std::array<std::array<signed char, 24>, 24> products{};
  std::array<signed char, 24> inverses{};

  static constexpr Scalar magnitude(Scalar x) { return x < 0 ? -x : x; }

  static constexpr int nearest_of(const std::array<Scalar, 4>& q) {
    constexpr Scalar root_half = std::numbers::sqrt2_v<Scalar> / 2;
    const Components m{magnitude(q[0]), magnitude(q[1]), magnitude(q[2]), magnitude(q[3])};
    std::size_t first = 0, second = 1;
    if (m[1] > m[0]) first = 1, second = 0;
    for (std::size_t i = 2; i < 4; ++i) {
      if (m[i] > m[first]) {
        second = first;
        first = i;
      } else if (m[i] > m[second]) {
        second = i;
      }
    }
    const Scalar one = m[first], two = (m[first] + m[second]) * root_half, four = (m[0] + m[1] + m[2] + m[3]) / 2;
    if (one >= two && one >= four) return static_cast<int>(first);
    if (two >= four) {
      // Pairs in the order wx wy wz xy xz yz, each with equal signs first.
      constexpr int pair_of[4][4] = {{0, 0, 1, 2}, {0, 0, 3, 4}, {1, 3, 0, 5}, {2, 4, 5, 0}};
      return 4 + 2 * pair_of[first][second] + ((q[first] < 0) != (q[second] < 0) ? 1 : 0);
    }
    const bool flip = q[0] < 0;
    return 16 + ((q[1] < 0) != flip ? 1 : 0) + ((q[2] < 0) != flip ? 2 : 0) + ((q[3] < 0) != flip ? 4 : 0);
  }

  static constexpr Components product(const Components& a, const Components& b) {
    return {
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
  }

  static constexpr CubeTables make() {
    constexpr Scalar root_half = std::numbers::sqrt2_v<Scalar> / 2, half = Scalar(1) / 2;
    CubeTables t;
    for (std::size_t i = 0; i < 4; ++i) t.elements[i][i] = 1;
    std::size_t next = 4;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        for (const Scalar sign : {Scalar(1), Scalar(-1)}) {
          t.elements[next][i] = root_half;
          t.elements[next++][j] = sign * root_half;
        }
    for (unsigned bits = 0; bits < 8; ++bits)
      t.elements[next++] = {half, bits & 1U ? -half : half, bits & 2U ? -half : half, bits & 4U ? -half : half};
    for (std::size_t i = 0; i < 24; ++i)
      for (std::size_t j = 0; j < 24; ++j) {
        const int k = nearest_of(product(t.elements[i], t.elements[j]));
        t.products[i][j] = static_cast<signed char>(k);
        if (k == 0) t.inverses[i] = static_cast<signed char>(j);
      }
    return t;
  }
};

template <class Scalar>
inline constexpr CubeTables<Scalar> cube_tables = CubeTables<Scalar>::make();

}  // namespace detail

/// The 24 rotations of the cube, and frames modulo them.
///
/// A frame is a unit quaternion p whose axes are the columns of its matrix; p and p g are the same frame for every
/// element g. Elements are numbered by kind: 0 the identity, 1 to 3 the half turns about x, y, z, 4 to 9 the
/// quarter turns about x, -x, y, -y, z, -z, 10 to 15 the half turns about the cube's edges, 16 to 23 the third turns.
///
/// Everything is O(1), stateless and safe to call from any thread. Ties (frames at equal distance) go to the element
/// with fewer non-zero components, then to the earlier component: the same on every platform.
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
  static int nearest(const Rotation& q) { return detail::CubeTables<Scalar>::nearest_of({q.w(), q.x(), q.y(), q.z()}); }

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
    const std::array<Scalar, 4> r = residual(from, to);
    const Scalar factor = angle_per_sine(r), w = from.w(), x = from.x(), y = from.y(), z = from.z();
    const Scalar a = factor * r[1], b = factor * r[2], c = factor * r[3];
    // The vector (a, b, c) turned by `from`.
    const Scalar s = 2 * (y * c - z * b), t = 2 * (z * a - x * c), u = 2 * (x * b - y * a);
    return Vector(a + w * s + (y * u - z * t), b + w * t + (z * s - x * u), c + w * u + (x * t - y * s));
  }

  /// Angle of the least rotation from one frame to another, radians.
  static Scalar angle(const Rotation& from, const Rotation& to) {
    const std::array<Scalar, 4> r = residual(from, to);
    return std::abs(angle_per_sine(r)) * std::sqrt(r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
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
  static constexpr const detail::CubeTables<Scalar>& tables = detail::cube_tables<Scalar>;

  /// The least rotation in the axes of `from`, up to sign. In plain components: Eigen's products, which pack two
  /// numbers, take half as long again under gcc.
  static std::array<Scalar, 4> residual(const Rotation& from, const Rotation& to) {
    using Tables = detail::CubeTables<Scalar>;
    const auto between = Tables::product({from.w(), -from.x(), -from.y(), -from.z()}, {to.w(), to.x(), to.y(), to.z()});
    const auto& g = tables.elements[at(Tables::nearest_of(between))];
    return Tables::product(between, {g[0], -g[1], -g[2], -g[3]});
  }

  /// Angle over sine of half the angle, with the sign of w, of a rotation by at most 62.8 degrees: 4 atan(t) / sin with
  /// t the tangent of a quarter of the angle, at most 0.282, by its series to 1e-16. The library's inverse functions
  /// would take half of the time of a matching.
  static Scalar angle_per_sine(const std::array<Scalar, 4>& r) {
    const Scalar w = r[0] < 0 ? r[0] - 1 : r[0] + 1;
    const Scalar x = (r[1] * r[1] + r[2] * r[2] + r[3] * r[3]) / (w * w), x2 = x * x, x4 = x2 * x2;
    const auto pair = [x](int k) { return Scalar(1.0 / (2 * k + 1)) - x * Scalar(1.0 / (2 * k + 3)); };
    const Scalar low = (pair(0) + x2 * pair(2)) + x4 * (pair(4) + x2 * pair(6));
    const Scalar high = (pair(8) + x2 * pair(10)) + x4 * pair(12);
    return 4 * (low + x4 * x4 * high) / w;
  }

  static constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }
  static Rotation positive(Rotation q) {
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    return q;
  }
};

}  // namespace framehex
