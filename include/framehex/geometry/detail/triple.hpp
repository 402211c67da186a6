// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/detail/wide_integer.hpp"

#include <array>
#include <cstddef>
#include <span>

namespace framehex::detail {

/// Three numbers of any kind, for arithmetic that Eigen is not needed for.
template <class Number>
struct Triple {
  Number x, y, z;

  friend Triple operator+(const Triple& a, const Triple& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Triple operator-(const Triple& a, const Triple& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
};

template <class Number>
Triple<Number> cross(const Triple<Number>& a, const Triple<Number>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class Number>
Number dot(const Triple<Number>& a, const Triple<Number>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <std::size_t N>
BinaryPlaces binary_places(const std::array<Triple<double>, N>& points) {
  BinaryPlaces places;
  for (const auto& p : points)
    for (const double x : {p.x, p.y, p.z}) places.add(x);
  return places;
}

/// The points as integers, all times one power of two.
template <std::size_t Limbs, std::size_t N>
std::array<Triple<WideInteger<Limbs>>, N> scaled(const BinaryPlaces& places,
                                                 const std::array<Triple<double>, N>& points) {
  std::array<Triple<WideInteger<Limbs>>, N> result;
  for (std::size_t i = 0; i < N; ++i)
    result[i] = {places.scaled<Limbs>(points[i].x), places.scaled<Limbs>(points[i].y),
                 places.scaled<Limbs>(points[i].z)};
  return result;
}

}  // namespace framehex::detail
