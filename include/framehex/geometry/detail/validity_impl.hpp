// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/validity.hpp"

#include <vector>

namespace framehex::detail {

enum class Sign { positive, not_positive, undecided };

/// Looks for the sign of the Jacobian's minimum by halving; a value within `error` of 0 decides nothing.
///
/// Coefficients bound the function from below and those at a box's corners are its values. Boxes are visited depth
/// first, and grow in number only round a minimum near 0: `max_boxes` ends the search there.
template <class Number>
Sign sign_of_minimum(const JacobianBezier<Number>& coefficients, const Number& error, int max_depth,
                     std::size_t max_boxes) {
  constexpr std::array<std::size_t, 8> values{0, 2, 6, 8, 18, 20, 24, 26};
  struct Box {
    JacobianBezier<Number> b;
    Number error;
    int depth;
  };
  std::vector<Box> boxes{{coefficients, error, 0}};
  for (std::size_t visited = 0; !boxes.empty(); ++visited) {
    const Box box = std::move(boxes.back());
    boxes.pop_back();
    if (*std::min_element(box.b.begin(), box.b.end()) > box.error) continue;
    bool near_zero = box.depth == max_depth || visited == max_boxes;
    for (const std::size_t value : values) {
      if (box.b[value] < -box.error) return Sign::not_positive;
      near_zero |= !(box.b[value] > box.error);
    }
    if (near_zero) return Sign::undecided;
    // Halving multiplies by 64, exactly; the caller's error leaves room for its sums.
    for (const auto& child : subdivide(box.b)) boxes.push_back({child, Number(64 * box.error), box.depth + 1});
  }
  return Sign::positive;
}

FRAMEHEX_INLINE bool is_valid_hexahedron(std::span<const Vector3> corners) {
  const auto p = triples<8>(corners);
  const HexahedronEdges<double> edges(p);
  const double u = magnitude(edges.u), v = magnitude(edges.v), w = magnitude(edges.w);
  if (in_filter_range(u, v, w)) {
    const JacobianBezier<double> b = jacobian_bezier(edges);
    const double error = hexahedron_error(u * v * w);
    if (*std::min_element(b.begin(), b.end()) > error) return true;
    const Sign sign = sign_of_minimum(b, 5 * error, 16, 1000);
    if (sign != Sign::undecided) return sign == Sign::positive;
  }
  if (!has_positive_corners(CellKind::hexahedron, corners)) return false;
  constexpr int max_depth = 40;
  const BinaryPlaces places = binary_places(p);
  // 64 times six products of three differences, 64 times that for each halving, sums of up to eight, and a sign.
  return with_wide_integers(3 * (places.width() + 1) + 3 + 6 + 6 * max_depth + 3 + 1, [&]<std::size_t Limbs>() {
    const auto exact = jacobian_bezier(HexahedronEdges<WideInteger<Limbs>>(scaled<Limbs>(places, p)));
    return sign_of_minimum(exact, WideInteger<Limbs>(0), max_depth, 2000) == Sign::positive;
  });
}

/// Coefficients of the Jacobian along a prism's three edges between its triangles: first, twice the middle, last.
/// Within a triangle it is linear, so that these decide.
template <class Number>
std::array<std::array<Number, 3>, 3> jacobian_bezier(const std::array<Triple<Number>, 6>& p) {
  const Triple<Number> a0 = p[1] - p[0], b0 = p[2] - p[0], a1 = p[4] - p[3], b1 = p[5] - p[3];
  const Triple<Number> first = cross(a0, b0), middle = cross(a0, b1) + cross(a1, b0), last = cross(a1, b1);
  std::array<std::array<Number, 3>, 3> b;
  for (std::size_t i = 0; i < 3; ++i) {
    const Triple<Number> c = p[i + 3] - p[i];
    b[i] = {dot(first, c), dot(middle, c), dot(last, c)};
  }
  return b;
}

FRAMEHEX_INLINE bool is_valid_prism(std::span<const Vector3> corners) {
  const auto p = triples<6>(corners);
  const double in_plane = magnitude(std::array{p[1] - p[0], p[2] - p[0], p[4] - p[3], p[5] - p[3]});
  const double along = magnitude(std::array{p[3] - p[0], p[4] - p[1], p[5] - p[2]});
  const double error = 128 * 0x1p-53 * in_plane * in_plane * along;
  const auto is_clear = [error](const auto& b) { return b[0] > error && b[1] > error && b[2] > error; };
  if (in_filter_range(in_plane, in_plane, along) && std::ranges::all_of(jacobian_bezier(p), is_clear)) return true;
  if (!has_positive_corners(CellKind::prism, corners)) return false;
  const BinaryPlaces places = binary_places(p);
  // A product of two values of 12 products of three differences each, and a sign.
  return with_wide_integers(2 * (3 * (places.width() + 1) + 4) + 2, [&]<std::size_t Limbs>() {
    const auto exact = jacobian_bezier(scaled<Limbs>(places, p));
    return std::ranges::all_of(exact, [](const std::array<WideInteger<Limbs>, 3>& b) {
      return !b[1].is_negative() || b[1] * b[1] < 4 * (b[0] * b[2]);
    });
  });
}

}  // namespace framehex::detail
