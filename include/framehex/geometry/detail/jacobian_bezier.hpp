// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/detail/triple.hpp"

#include <array>
#include <cstddef>

/// Bezier coefficients of the Jacobian of a trilinear hexahedron, over any ring of numbers.
namespace framehex::detail {

inline double quarter(double x) {
  return x / 4;
}

/// Coefficient (i, j, k) of degree 2 in each direction is entry i + 3 j + 9 k.
template <class Number>
using JacobianBezier = std::array<Number, 27>;

/// The twelve edges of a hexahedron by direction: along[axis][p + 2 q], p and q the two other coordinates in the order
/// of the axes.
template <class Number>
struct HexahedronEdges {
  std::array<Triple<Number>, 4> u, v, w;

  explicit HexahedronEdges(const std::array<Triple<Number>, 8>& p)
      : u{p[1] - p[0], p[2] - p[3], p[5] - p[4], p[6] - p[7]},
        v{p[3] - p[0], p[2] - p[1], p[7] - p[4], p[6] - p[5]},
        w{p[4] - p[0], p[5] - p[1], p[7] - p[3], p[6] - p[2]} {}
};

/// Eight times the coefficients (integers stay integers).
///
/// Only the 8 corners and 12 edges need determinants: the Jacobian has no term with two squares, so that the second
/// difference in two directions is null and gives the faces and the centre.
/// @par Source  Johnen, Weill, Remacle, Robust and efficient validation of the linear hexahedral element, 2017
///              (arXiv:1706.01613).
template <class Number>
JacobianBezier<Number> jacobian_bezier(const HexahedronEdges<Number>& edges) {
  JacobianBezier<Number> b;
  const auto at = [&b](std::size_t i, std::size_t j, std::size_t k) -> Number& { return b[i + 3 * j + 9 * k]; };
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t j = 0; j < 2; ++j) {
      const Triple<Number>&u = edges.u[j + 2 * k], &v0 = edges.v[2 * k], &v1 = edges.v[1 + 2 * k], &w0 = edges.w[2 * j],
            &w1 = edges.w[1 + 2 * j];
      at(0, 2 * j, 2 * k) = 8 * dot(u, cross(v0, w0));
      at(2, 2 * j, 2 * k) = 8 * dot(u, cross(v1, w1));
      at(1, 2 * j, 2 * k) = 4 * dot(u, cross(v0, w1) + cross(v1, w0));
    }
  for (std::size_t q = 0; q < 2; ++q)
    for (std::size_t i = 0; i < 2; ++i) {
      const Triple<Number>&v = edges.v[i + 2 * q], &w = edges.w[i + 2 * q];
      at(2 * i, 1, 2 * q) = 4 * dot(v, cross(edges.w[i + 2], edges.u[2 * q]) + cross(edges.w[i], edges.u[1 + 2 * q]));
      at(2 * i, 2 * q, 1) = 4 * dot(w, cross(edges.u[q], edges.v[i + 2]) + cross(edges.u[q + 2], edges.v[i]));
    }
  // Faces, then the centre from the four faces parallel to w and the four edges along w.
  const auto centre = [](const Number& edge_sum, const Number& corner_sum) -> Number {
    return quarter(2 * edge_sum - corner_sum);
  };
  for (std::size_t q = 0; q < 3; q += 2) {
    at(q, 1, 1) = centre(at(q, 0, 1) + at(q, 2, 1) + at(q, 1, 0) + at(q, 1, 2),
                         at(q, 0, 0) + at(q, 2, 0) + at(q, 0, 2) + at(q, 2, 2));
    at(1, q, 1) = centre(at(0, q, 1) + at(2, q, 1) + at(1, q, 0) + at(1, q, 2),
                         at(0, q, 0) + at(2, q, 0) + at(0, q, 2) + at(2, q, 2));
    at(1, 1, q) = centre(at(0, 1, q) + at(2, 1, q) + at(1, 0, q) + at(1, 2, q),
                         at(0, 0, q) + at(2, 0, q) + at(0, 2, q) + at(2, 2, q));
  }
  at(1, 1, 1) = centre(at(0, 1, 1) + at(2, 1, 1) + at(1, 0, 1) + at(1, 2, 1),
                       at(0, 0, 1) + at(2, 0, 1) + at(0, 2, 1) + at(2, 2, 1));
  return b;
}

/// The eight halves of a set of coefficients, each times 64 (integers stay integers); child 1 + 2 + 4 is the one at
/// the far corner.
template <class Number>
std::array<JacobianBezier<Number>, 8> subdivide(const JacobianBezier<Number>& b) {
  // De Casteljau's halving in one direction turns 3 coefficients into 5, of which the children share the middle one.
  std::array<Number, 125> fine;
  const auto at = [&fine](std::size_t i, std::size_t j, std::size_t k) -> Number& { return fine[i + 5 * j + 25 * k]; };
  const auto halve = [](const Number& b0, const Number& b1, const Number& b2, auto&& out) {
    out(0) = 4 * b0;
    out(1) = 2 * (b0 + b1);
    out(2) = b0 + 2 * b1 + b2;
    out(3) = 2 * (b1 + b2);
    out(4) = 4 * b2;
  };
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t j = 0; j < 3; ++j)
      halve(b[3 * j + 9 * k], b[1 + 3 * j + 9 * k], b[2 + 3 * j + 9 * k],
            [&](std::size_t i) -> Number& { return at(i, j, k); });
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 5; ++i) {
      const Number b0 = at(i, 0, k), b1 = at(i, 1, k), b2 = at(i, 2, k);
      halve(b0, b1, b2, [&](std::size_t j) -> Number& { return at(i, j, k); });
    }
  for (std::size_t j = 0; j < 5; ++j)
    for (std::size_t i = 0; i < 5; ++i) {
      const Number b0 = at(i, j, 0), b1 = at(i, j, 1), b2 = at(i, j, 2);
      halve(b0, b1, b2, [&](std::size_t k) -> Number& { return at(i, j, k); });
    }
  std::array<JacobianBezier<Number>, 8> children;
  for (std::size_t child = 0; child < 8; ++child)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t i = 0; i < 3; ++i)
          children[child][i + 3 * j + 9 * k] = at(i + 2 * (child & 1), j + (child & 2), k + 2 * (child >> 2));
  return children;
}

}  // namespace framehex::detail
