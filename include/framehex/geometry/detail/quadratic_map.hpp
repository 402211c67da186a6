// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/cell_kinds.hpp"

#include <algorithm>
#include <span>
#include <vector>

namespace framehex::detail {

/// Sum of monomials in at most eight variables, four bits of `powers` each.
///
/// `magnitude` is the same sum of the absolute values of all that went into it: rounding is a small part of it.
template <class Value>
struct Polynomial {
  struct Term {
    std::uint32_t powers;
    Value value;
    double magnitude;
  };
  std::vector<Term> terms;  // ascending powers once collected

  void collect() {
    std::stable_sort(terms.begin(), terms.end(), [](const Term& a, const Term& b) { return a.powers < b.powers; });
    std::size_t n = 0;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      if (n > 0 && terms[n - 1].powers == terms[i].powers) {
        terms[n - 1].value += terms[i].value;
        terms[n - 1].magnitude += terms[i].magnitude;
      } else {
        terms[n++] = terms[i];
      }
    }
    terms.resize(n);
  }
};

constexpr std::uint32_t power_of(std::size_t variable) {
  return std::uint32_t{1} << (4 * variable);
}

/// Homogeneous coordinates of the reference cells. A cube is the product of three intervals, a prism that of a triangle and an
/// interval; a pyramid is a cube whose top is one point. Each factor is a group of variables that add up to 1: shape
/// functions, and what is made of them, are polynomials of one degree in each group, so that their coefficients are Bezier
/// coefficients but for positive factors.
struct ReferenceVariables {
  std::vector<std::vector<std::size_t>> groups;          ///< variables of each group
  std::vector<std::vector<std::size_t>> of_corner;       ///< the variable of each group that is 1 there
  std::vector<std::array<std::size_t, 2>> directions{};  ///< three: along which pairs of variables (from, to)
};

inline const ReferenceVariables& reference_variables(CellKind kind) {
  static const ReferenceVariables tetrahedron{{{0, 1, 2, 3}}, {{0}, {1}, {2}, {3}}, {{0, 1}, {0, 2}, {0, 3}}};
  static const ReferenceVariables prism{
      {{0, 1, 2}, {3, 4}}, {{0, 3}, {1, 3}, {2, 3}, {0, 4}, {1, 4}, {2, 4}}, {{0, 1}, {0, 2}, {3, 4}}};
  static const ReferenceVariables cube{
      {{0, 1}, {2, 3}, {4, 5}},
      {{0, 2, 4}, {1, 2, 4}, {1, 3, 4}, {0, 3, 4}, {0, 2, 5}, {1, 2, 5}, {1, 3, 5}, {0, 3, 5}},
      {{0, 1}, {2, 3}, {4, 5}}};
  switch (kind) {
    case CellKind::tetrahedron: return tetrahedron;
    case CellKind::prism: return prism;
    default: return cube;
  }
}

/// The map of a cell with a node on each edge, of degree 2 in each group.
///
/// Each edge adds what its node is off the middle, times a function that is 1 there and 0 on all other edges: the shape
/// functions of serendipity elements, for pyramids those of Bedrosian (Int. J. Numer. Meth. Eng. 35 (1992) 95-108).
class QuadraticMap {
public:
  QuadraticMap(CellKind kind, std::span<const Vector3> corners, std::span<const Vector3> middles)
      : kind_(kind), variables_(reference_variables(kind)) {
    const Vector3& origin = corners[0];
    for (std::size_t i = 0; i < corners.size(); ++i) add_corner(i, corners[i] - origin);
    const auto edges = edges_of(kind);
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const auto a = static_cast<std::size_t>(edges[e][0]), b = static_cast<std::size_t>(edges[e][1]);
      const Vector3 p = corners[a] - origin, q = corners[b] - origin, m = middles[e] - origin;
      const double magnitude = 2 * (p.cwiseAbs() + q.cwiseAbs() + m.cwiseAbs()).maxCoeff();
      if (m != (p + q) / 2) add_edge(a, b, 4 * (m - (p + q) / 2), 4 * magnitude);
    }
    position_.collect();
  }

  /// Along a direction of the reference cell.
  Polynomial<Vector3> derivative(std::size_t direction) const {
    const auto [from, to] = variables_.directions[direction];
    Polynomial<Vector3> result;
    for (const auto& term : position_.terms) {
      const auto lower = [&](std::size_t variable, double sign) {
        const auto n = static_cast<double>(term.powers >> (4 * variable) & 15u);
        if (n > 0)
          result.terms.push_back({term.powers - power_of(variable), sign * n * term.value, n * term.magnitude});
      };
      lower(to, 1);
      lower(from, -1);
    }
    result.collect();
    return result;
  }

private:
  bool is_apex(std::size_t corner) const { return kind_ == CellKind::pyramid && corner == 4; }

  /// Adds value * start * product over the groups of (sum of their variables)^n; n by group.
  void add(std::uint32_t start, std::array<int, 3> n, const Vector3& value, double magnitude) {
    Polynomial<Vector3> product{{{start, value, magnitude}}};
    for (std::size_t g = 0; g < variables_.groups.size(); ++g)
      for (int i = 0; i < n[g]; ++i) {
        Polynomial<Vector3> next;
        for (const auto& term : product.terms)
          for (const std::size_t variable : variables_.groups[g])
            next.terms.push_back({term.powers + power_of(variable), term.value, term.magnitude});
        next.collect();
        product = std::move(next);
      }
    position_.terms.insert(position_.terms.end(), product.terms.begin(), product.terms.end());
  }

  void add_corner(std::size_t corner, const Vector3& p) {
    const double magnitude = p.cwiseAbs().maxCoeff();
    if (is_apex(corner)) return add(power_of(5), {2, 2, 1}, p, magnitude);
    std::uint32_t start = 0;
    for (const std::size_t variable : variables_.of_corner[corner]) start += power_of(variable);
    add(start, {1, 1, 1}, p, magnitude);
  }

  void add_edge(std::size_t a, std::size_t b, const Vector3& value, double magnitude) {
    std::uint32_t start = 0;
    std::array<int, 3> n{0, 0, 0};
    const auto& of_a = variables_.of_corner[a];
    for (std::size_t g = 0; g < of_a.size(); ++g) {
      const bool is_base = kind_ == CellKind::pyramid && g == 2;
      const std::size_t other = is_apex(b) ? (is_base ? 5 : of_a[g]) : variables_.of_corner[b][g];
      start += power_of(of_a[g]);
      if (other != of_a[g] || (is_base && !is_apex(b)))
        start += power_of(other);  // for an edge of a pyramid's base the height squared
      else
        n[g] = 1;
    }
    add(start, n, value, magnitude);
  }

  CellKind kind_;
  const ReferenceVariables& variables_;
  Polynomial<Vector3> position_;
};

}  // namespace framehex::detail
