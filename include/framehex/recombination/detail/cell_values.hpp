// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/quality.hpp"
#include "framehex/geometry/validity.hpp"

namespace framehex::detail {

struct CellValues {
  double quality, volume;
};

/// Scaled Jacobian and volume of a cell; nothing when it misses the floor or is not valid. The public functions give
/// the same; for a hexahedron their common parts are computed once.
template <CellKind Kind>
bool evaluate(std::span<const Vector3> corners, double floor, CellValues& values) {
  values.quality = scaled_jacobian(Kind, corners);
  if (values.quality < floor || !is_valid(Kind, corners)) return false;
  values.volume = cell_volume(Kind, corners);
  return true;
}

template <>
inline bool evaluate<CellKind::hexahedron>(std::span<const Vector3> corners, double floor, CellValues& values) {
  const HexahedronEdges<double> edges(triples<8>(corners));
  std::array<double, 4> u{}, v{}, w{};
  for (std::size_t i = 0; i < 4; ++i) {
    u[i] = dot(edges.u[i], edges.u[i]);
    v[i] = dot(edges.v[i], edges.v[i]);
    w[i] = dot(edges.w[i], edges.w[i]);
  }
  const JacobianBezier<double> b = jacobian_bezier(edges);
  // Squares are compared, so that one root is drawn and not eight; a negative corner fails in any case.
  double least = 1;
  for (std::size_t i = 0; i < 8; ++i) {
    const std::size_t x = i & 1, y = i >> 1 & 1, z = i >> 2;
    const double determinant = b[2 * x + 6 * y + 18 * z] / 8;
    if (!(determinant > 0)) return false;
    least = std::min(least, determinant * determinant / (u[y + 2 * z] * v[x + 2 * z] * w[x + 2 * y]));
  }
  values.quality = std::sqrt(least);
  if (!(values.quality >= floor)) return false;
  double sum = 0, lowest = b[0];
  for (const double coefficient : b) {
    sum += coefficient;
    lowest = std::min(lowest, coefficient);
  }
  values.volume = sum / (8 * 27);
  // No component of an edge is larger than its length.
  const double x = std::sqrt(std::ranges::max(u)), y = std::sqrt(std::ranges::max(v)),
               z = std::sqrt(std::ranges::max(w));
  return (in_filter_range(x, y, z) && lowest > hexahedron_error(x * y * z)) || is_valid_hexahedron(corners);
}

}  // namespace framehex::detail
