// SPDX-License-Identifier: BSL-1.0
#include "framehex/geometry/validity.hpp"
#include "support/cells.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace framehex;
using test::SampledJacobian;

namespace {

/// From the unit cube towards a shaken one: stops near the first cell whose sampled Jacobian is not positive.
std::array<Vector3, 8> near_degenerate(std::mt19937_64& engine) {
  boost::random::uniform_real_distribution<> unit(0, 1);
  const auto target = test::shaken_cube(1.5, engine);
  const auto at = [&](double t) {
    auto p = test::unit_cube;
    for (std::size_t i = 0; i < 8; ++i) p[i] += t * (target[i] - p[i]);
    return p;
  };
  double low = 0, high = 1;
  for (int step = 0; step < 40; ++step) {
    const double middle = (low + high) / 2;
    (SampledJacobian(at(middle)).least<9>().value > 0 ? low : high) = middle;
  }
  const double distance = std::pow(10, -1 - 7 * unit(engine));
  return at(low * (unit(engine) < 0.5 ? 1 - distance : 1 + distance));
}

/// The least value of the Jacobian, from 10^6 samples and finer ones where they are least.
double sampled_minimum(const std::array<Vector3, 8>& p) {
  const SampledJacobian jacobian(p);
  auto best = jacobian.least<100>();
  double reach = 0.02;
  for (int zoom = 0; zoom < 4 && best.value > 0; ++zoom, reach /= 10) {
    const Vector3 low = (best.at.array() - reach).max(0), high = (best.at.array() + reach).min(1);
    const auto finer = jacobian.least<21>(low, high);
    if (finer.value < best.value) best = finer;
  }
  return best.value;
}

bool is_valid_hexahedron(const std::array<Vector3, 8>& p) {
  return is_valid(CellKind::hexahedron, p);
}

}  // namespace

TEST_CASE("Validity of hexahedra agrees with a million samples near degeneracy") {
#ifdef NDEBUG
  const int n = 10000;
#else
  const int n = 300;
#endif
  std::mt19937_64 engine(3);
  int n_valid = 0;
  for (int sample = 0; sample < n; ++sample) {
    const auto p = near_degenerate(engine);
    const double minimum = sampled_minimum(p);
    CAPTURE(sample, minimum);
    // Within the sampling's own rounding there is nothing to compare.
    if (std::abs(minimum) < 1e-11) continue;
    const bool valid = is_valid_hexahedron(p);
    n_valid += valid;
    if (valid != (minimum > 0)) CHECK(valid == (minimum > 0));
  }
  CHECK(n_valid > n / 4);
  CHECK(n_valid < 3 * n / 4);
}

TEST_CASE("Validity is decided for the coordinates as stored") {
  // Corner 6 in the plane of its three neighbours.
  auto p = test::unit_cube;
  for (Vector3& x : p) x *= 3;
  p[6] = {2, 2, 2};
  CHECK_FALSE(is_valid_hexahedron(p));
  p[6].z() = std::nextafter(2, 3);
  CHECK(is_valid_hexahedron(p));
  p[6].z() = std::nextafter(2, 0);
  CHECK_FALSE(is_valid_hexahedron(p));
}

TEST_CASE("Valid corners do not make a valid hexahedron") {
  // Half a turn of the top: at the corners the Jacobian is positive, at the centre it is null.
  auto p = test::unit_cube;
  std::rotate(p.begin() + 4, p.begin() + 6, p.end());
  CHECK_FALSE(is_valid_hexahedron(p));
  // An edge along which the Jacobian dips below 0 between two positive ends, from the definition.
  std::mt19937_64 engine(5);
  int n = 0;
  for (int sample = 0; sample < 20000; ++sample) {
    const auto q = test::shaken_cube(0.6, engine);
    bool corners = true;
    for (int i = 0; i < 8; ++i) corners &= test::trilinear_jacobian(q, i & 1, i >> 1 & 1, i >> 2) > 1e-6;
    if (!corners || SampledJacobian(q).least<20>().value > -1e-6) continue;
    ++n;
    CHECK_FALSE(is_valid_hexahedron(q));
  }
  CHECK(n > 10);
}

TEST_CASE("Validity does not depend on the scale, down to denormal numbers and up to the largest") {
  std::mt19937_64 engine(7);
  for (int sample = 0; sample < 200; ++sample) {
    const auto p = test::shaken_cube(0.45, engine);
    const bool expected = is_valid_hexahedron(p);
    for (const int exponent : {-1000, -400, -90, 90, 400, 1000}) {
      auto scaled = p;
      for (Vector3& x : scaled)
        for (double& value : x) value = std::ldexp(value, exponent);
      CHECK(is_valid_hexahedron(scaled) == expected);
    }
  }
}

TEST_CASE("Flat and null hexahedra are invalid") {
  auto p = test::unit_cube;
  for (Vector3& x : p) x.z() = 0;
  CHECK_FALSE(is_valid_hexahedron(p));
  for (Vector3& x : p) x = {1, 2, 3};
  CHECK_FALSE(is_valid_hexahedron(p));
  p = test::unit_cube;
  p[1] = p[0];
  CHECK_FALSE(is_valid_hexahedron(p));
}

TEST_CASE("A prism can be twisted by less than half a turn") {
  const auto twisted = [](double degrees) {
    std::array<Vector3, 6> p;
    for (std::size_t i = 0; i < 3; ++i) {
      const double angle = static_cast<double>(i) * 2 * std::numbers::pi / 3, turn = degrees / 180 * std::numbers::pi;
      p[i] = {std::cos(angle), std::sin(angle), 0};
      p[i + 3] = degrees == 180 ? Vector3(-p[i].x(), -p[i].y(), 1)
                                : Vector3(std::cos(angle + turn), std::sin(angle + turn), 1);
    }
    return p;
  };
  for (const double degrees : {0.0, 60.0, 90.0, 150.0, 179.0, 179.999}) {
    CAPTURE(degrees);
    CHECK(is_valid(CellKind::prism, twisted(degrees)));
    CHECK(is_valid(CellKind::prism, twisted(-degrees)));
  }
  CHECK_FALSE(is_valid(CellKind::prism, twisted(180)));
  auto flat = twisted(0);
  flat[4] = flat[1];
  CHECK_FALSE(is_valid(CellKind::prism, flat));
}

TEST_CASE("Prisms and pyramids agree with samples of their maps") {
  std::mt19937_64 engine(11);
  std::array<int, 2> n_valid{};
  for (int sample = 0; sample < 3000; ++sample) {
    const auto q = test::shaken_cube(0.5, engine);
    const std::array<Vector3, 6> prism{q[0], q[1], q[3], q[4], q[5], q[7]};
    const std::array<Vector3, 5> pyramid{q[0], q[1], q[2], q[3], q[6]};
    double least_prism = 1e300, least_pyramid = 1e300;
    for (int i = 0; i <= 20; ++i)
      for (int j = 0; j <= 20; ++j) {
        const double s = i / 20.0, t = j / 20.0;
        for (std::size_t edge = 0; edge < 3; ++edge) {
          const Vector3 x = (1 - s) * (prism[1] - prism[0]) + s * (prism[4] - prism[3]);
          const Vector3 y = (1 - s) * (prism[2] - prism[0]) + s * (prism[5] - prism[3]);
          least_prism = std::min(least_prism, x.cross(y).dot(prism[edge + 3] - prism[edge]));
        }
        const auto& b = pyramid;
        const Vector3 at = (1 - s) * ((1 - t) * b[0] + t * b[3]) + s * ((1 - t) * b[1] + t * b[2]);
        const Vector3 x = (1 - t) * (b[1] - b[0]) + t * (b[2] - b[3]), y = (1 - s) * (b[3] - b[0]) + s * (b[2] - b[1]);
        least_pyramid = std::min(least_pyramid, x.cross(y).dot(b[4] - at));
      }
    n_valid[0] += is_valid(CellKind::prism, prism);
    n_valid[1] += is_valid(CellKind::pyramid, pyramid);
    if (std::abs(least_prism) > 1e-3) CHECK(is_valid(CellKind::prism, prism) == (least_prism > 0));
    if (std::abs(least_pyramid) > 1e-12) CHECK(is_valid(CellKind::pyramid, pyramid) == (least_pyramid > 0));
  }
  for (const int n : n_valid) {
    CHECK(n > 300);
    CHECK(n < 2700);
  }
}
