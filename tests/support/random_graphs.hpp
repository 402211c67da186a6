// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/incompatibility_graph.hpp"

#include <random>

namespace framehex::test {

enum class Weights { ones, small_integers, reals, some_zero };

/// Every pair of n candidates is a conflict with the given probability.
inline IncompatibilityGraph random_graph(std::mt19937_64& engine, index_t n, double density, Weights kind) {
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<double> weights(n, 1.0);
  for (double& w : weights) {
    if (kind == Weights::small_integers) w = static_cast<double>(1 + engine() % 9);
    if (kind == Weights::reals) w = uniform();
    if (kind == Weights::some_zero) w = static_cast<double>(engine() % 3);
  }
  std::vector<std::array<index_t, 2>> conflicts;
  for (index_t u = 0; u < n; ++u)
    for (index_t v = 0; v < u; ++v)
      if (uniform() < density) conflicts.push_back({u, v});
  return make_incompatibility_graph(weights, conflicts);
}

/// Candidates are points of a square and exclude those nearer than `radius`: clustered, like graphs of hexahedra.
inline IncompatibilityGraph random_disk_graph(std::mt19937_64& engine, index_t n, double radius) {
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<std::array<double, 2>> points(n);
  std::vector<double> weights(n);
  for (index_t v = 0; v < n; ++v) {
    points[v] = {uniform(), uniform()};
    weights[v] = std::floor(5000 + 5000 * uniform());
  }
  std::vector<std::array<index_t, 2>> conflicts;
  for (index_t u = 0; u < n; ++u)
    for (index_t v = 0; v < u; ++v)
      if (std::hypot(points[u][0] - points[v][0], points[u][1] - points[v][1]) < radius) conflicts.push_back({u, v});
  return make_incompatibility_graph(weights, conflicts);
}

}  // namespace framehex::test
