// SPDX-License-Identifier: BSL-1.0
#include "framehex/geometry/quadratic_validity.hpp"
#include "framehex/geometry/validity.hpp"
#include "support/cells.hpp"

#include <catch2/catch.hpp>

#include <functional>
#include <random>

using namespace framehex;

namespace {

struct Nodes {
  std::vector<Vector3> corners, middles;
};

Nodes straight(CellKind kind, std::vector<Vector3> corners) {
  Nodes nodes{std::move(corners), {}};
  for (const auto& [a, b] : edges_of(kind))
    nodes.middles.push_back((nodes.corners[std::size_t(a)] + nodes.corners[std::size_t(b)]) / 2);
  return nodes;
}

std::vector<Vector3> unit_corners(CellKind kind) {
  switch (kind) {
    case CellKind::tetrahedron: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    case CellKind::pyramid: return {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 1}};
    case CellKind::prism: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    default:
      return {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};
  }
}

/// The shape functions as the textbooks print them, at a point of the reference cell whose corners are `unit_corners`; nodes
/// on edges follow the corners in the order of `edges_of`.
std::vector<double> shape(CellKind kind, const Vector3& x) {
  const double r = x[0], s = x[1], t = x[2];
  std::vector<double> n;
  const auto unit = unit_corners(kind);
  if (kind == CellKind::hexahedron) {
    for (const Vector3& c : unit)
      n.push_back((1 + r * c[0]) * (1 + s * c[1]) * (1 + t * c[2]) * (r * c[0] + s * c[1] + t * c[2] - 2) / 8);
    for (const auto& [a, b] : edges_of(kind)) {
      const Vector3 m = (unit[std::size_t(a)] + unit[std::size_t(b)]) / 2;
      double value = 0.25;
      for (int i = 0; i < 3; ++i) value *= m[i] == 0 ? 1 - x[i] * x[i] : 1 + x[i] * m[i];
      n.push_back(value);
    }
  } else if (kind == CellKind::tetrahedron || kind == CellKind::prism) {
    const bool is_prism = kind == CellKind::prism;
    const std::array<double, 4> l{is_prism ? 1 - r - s : 1 - r - s - t, r, s, t};
    const double z = 2 * t - 1;
    if (!is_prism) {
      for (const double a : l) n.push_back(a * (2 * a - 1));
      for (const auto& [a, b] : edges_of(kind)) n.push_back(4 * l[std::size_t(a)] * l[std::size_t(b)]);
    } else {
      for (int i = 0; i < 6; ++i) {
        const double a = l[std::size_t(i % 3)], zi = i < 3 ? -1 : 1;
        n.push_back(a * ((2 * a - 1) * (1 + z * zi) - (1 - z * z)) / 2);
      }
      for (int e = 0; e < 9; ++e) {
        const double a = l[std::size_t(e % 3)], b = l[std::size_t((e + 1) % 3)];
        n.push_back(e < 6 ? 2 * a * b * (1 + z * (e < 3 ? -1 : 1)) : a * (1 - z * z));
      }
    }
  } else {  // Bedrosian's
    const auto base = [&](double ri, double si) {
      return ((1 + ri * r) * (1 + si * s) - t + ri * si * r * s * t / (1 - t)) / 4 * (ri * r + si * s - 1);
    };
    n = {base(-1, -1), base(1, -1), base(1, 1), base(-1, 1), t * (2 * t - 1)};
    const double q = 1 - t;
    n.push_back((q - r) * (q + r) * (q - s) / (2 * q));
    n.push_back((q - s) * (q + s) * (q + r) / (2 * q));
    n.push_back((q - r) * (q + r) * (q + s) / (2 * q));
    n.push_back((q - s) * (q + s) * (q - r) / (2 * q));
    n.push_back(t * (q - r) * (q - s) / q);
    n.push_back(t * (q + r) * (q - s) / q);
    n.push_back(t * (q + r) * (q + s) / q);
    n.push_back(t * (q - r) * (q + s) / q);
  }
  return n;
}

double jacobian(CellKind kind, const Nodes& nodes, const Vector3& x) {
  constexpr double h = 1e-5;
  Eigen::Matrix3d j = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto up = shape(kind, x + h * Vector3::Unit(i)), down = shape(kind, x - h * Vector3::Unit(i));
    for (std::size_t k = 0; k < up.size(); ++k) {
      const Vector3& p = k < nodes.corners.size() ? nodes.corners[k] : nodes.middles[k - nodes.corners.size()];
      j.col(i) += (up[k] - down[k]) / (2 * h) * p;
    }
  }
  return j.determinant();
}

/// A point inside the reference cell, on its boundary or near it as often as not.
Vector3 random_inside(CellKind kind, std::mt19937_64& random) {
  std::uniform_real_distribution<double> x(0, 1);
  const auto end = [&] {
    const double v = 1.4 * x(random) - 0.2;
    return std::clamp(v, 0.0, 1.0);
  };
  const double u = end(), v = end(), w = end();
  switch (kind) {
    case CellKind::tetrahedron: return {u * (1 - v) * (1 - w), v * (1 - w), w};
    case CellKind::prism: return {u * (1 - v), v, w};
    case CellKind::pyramid: {
      const double t = 0.98 * w;
      return {(2 * u - 1) * (1 - t), (2 * v - 1) * (1 - t), t};
    }
    default: return {2 * u - 1, 2 * v - 1, 2 * w - 1};
  }
}

Nodes random_nodes(CellKind kind, double shake, double bend, std::mt19937_64& random) {
  std::uniform_real_distribution<double> x(-1, 1);
  std::vector<Vector3> corners = unit_corners(kind);
  for (Vector3& p : corners) p += shake * Vector3{x(random), x(random), x(random)} + Vector3(7, -3, 11);
  Nodes nodes = straight(kind, corners);
  for (Vector3& p : nodes.middles) p += bend * Vector3{x(random), x(random), x(random)};
  return nodes;
}

}  // namespace

TEST_CASE("quadratic cells that are surely valid have no sample of their Jacobian that is not positive") {
  std::mt19937_64 random(1);
  for (const CellKind kind : all_cell_kinds) {
    int n_valid = 0, n_certain = 0;
    for (int i = 0; i < 150; ++i) {
      const Nodes nodes = random_nodes(kind, 0.15, 0.03 * (i % 15), random);
      double least = std::numeric_limits<double>::infinity();
      for (int k = 0; k < 300; ++k) least = std::min(least, jacobian(kind, nodes, random_inside(kind, random)));
      const bool certain = is_surely_valid(kind, nodes.corners, nodes.middles);
      if (certain) CHECK(least > 0);
      n_valid += least > 0;
      n_certain += certain;
    }
    INFO("kind " << static_cast<int>(kind) << ": " << n_certain << " of " << n_valid);
    CHECK(n_valid < 150);
    CHECK(n_certain > 0.5 * n_valid);
  }
}

TEST_CASE("moderately bent cells are surely valid, folded ones are not") {
  for (const CellKind kind : all_cell_kinds) {
    Nodes nodes = straight(kind, unit_corners(kind));
    CHECK(is_surely_valid(kind, nodes.corners, nodes.middles));
    const Vector3 along = nodes.corners[1] - nodes.corners[0];
    const Vector3 middle = nodes.middles[0];
    nodes.middles[0] = middle + Vector3(0, -0.1, -0.1);
    CHECK(is_surely_valid(kind, nodes.corners, nodes.middles));
    // Beyond a quarter of the edge off its middle the edge turns back.
    nodes.middles[0] = middle + 0.24 * along;
    CHECK(is_surely_valid(kind, nodes.corners, nodes.middles));
    nodes.middles[0] = middle + 0.26 * along;
    CHECK_FALSE(is_surely_valid(kind, nodes.corners, nodes.middles));
    nodes.middles[0] = middle;
    std::swap(nodes.corners[0], nodes.corners[1]);
    nodes = straight(kind, nodes.corners);
    CHECK_FALSE(is_surely_valid(kind, nodes.corners, nodes.middles));
  }
}

TEST_CASE("a cell without volume is not surely valid, however its coordinates are rounded") {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> x(-1, 1);
  for (const CellKind kind : all_cell_kinds)
    for (int i = 0; i < 50; ++i) {
      const Vector3 u(x(random), x(random), x(random)), v(x(random), x(random), x(random));
      std::vector<Vector3> corners;
      for (const Vector3& p : unit_corners(kind)) corners.push_back(p[0] * u + p[1] * v + 0.3 * p[2] * (u + v));
      const Nodes nodes = straight(kind, corners);
      CHECK_FALSE(is_surely_valid(kind, nodes.corners, nodes.middles));
    }
}
