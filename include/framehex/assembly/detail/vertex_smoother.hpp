// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/quality_energy.hpp"

#include <Eigen/Cholesky>

#include <functional>
#include <limits>

namespace framehex::detail {

/// Moves one vertex at a time to lower the energy of the corners that depend on it.
class VertexSmoother {
public:
  /// Brings a trial place of a boundary vertex back to its surface or curve; returns false if the vertex may not move.
  using Projection = std::function<bool(index_t vertex, Vector3& place)>;

  VertexSmoother(CellComplex& complex, const QualityEnergy& energy, Projection projection)
      : complex_(complex), energy_(energy), projection_(std::move(projection)) {}

  /// @return whether the vertex moved.
  bool smooth(index_t vertex) {
    if (complex_.unused(vertex)) return false;
    const bool bound = complex_.on_boundary[vertex] != 0 || complex_.is_protected[vertex] != 0;
    if (bound && !projection_) return false;
    gather(vertex);
    Vector3 place = complex_.points[vertex];
    double worst = 0;
    double energy = evaluate(place, worst);
    if (energy == 0) return false;
    bool moved = false;
    double damping = 1e-3;
    for (int iteration = 0; iteration < max_iterations; ++iteration) {
      Vector3 gradient;
      Eigen::Matrix3d hessian;
      differentiate(place, gradient, hessian);
      bool improved = false;
      for (int attempt = 0; attempt < 5 && !improved; ++attempt) {
        Eigen::Matrix3d damped = hessian;
        damped.diagonal().array() += damping * hessian.trace() + 1e-300;
        Vector3 step = -damped.ldlt().solve(gradient);
        const double length = step.norm();
        if (!(length > 1e-9 * shortest_)) return moved;
        if (length > 0.5 * shortest_) step *= 0.5 * shortest_ / length;
        Vector3 trial = place + step;
        if (bound && !projection_(vertex, trial)) return moved;
        double trial_worst = 0;
        const double trial_energy = evaluate(trial, trial_worst);
        improved = trial_energy < energy * (1 - 1e-6) && acceptable(worst, trial_worst) && remains_valid(vertex, trial);
        if (improved) {
          moved = true;
          place = complex_.points[vertex] = trial;
          const bool little = trial_energy > 0.95 * energy;
          energy = trial_energy;
          worst = trial_worst;
          damping = std::max(0.1 * damping, 1e-6);
          if (energy == 0 || little) return moved;
        } else {
          damping *= 20;
        }
      }
      if (!improved) break;
    }
    return moved;
  }

private:
  static constexpr int max_iterations = 6;

  /// A corner and its three edge ends; `role` says which of the four is the vertex that moves.
  struct Term {
    std::array<const Vector3*, 4> p;
    int role;
    double factor;
  };

  void gather(index_t vertex) {
    terms_.clear();
    shortest_ = std::numeric_limits<double>::infinity();
    complex_.for_each_cell_at(vertex, [&](index_t cell) {
      const CellKind kind = complex_.cells[cell].kind;
      const auto& corners = complex_.cells[cell].corners;
      const double factor = 1 / energy_.target(kind);
      for (const LocalCorner& c : corners_of(kind)) {
        const std::array<index_t, 4> v{corners[static_cast<std::size_t>(c.corner)],
                                       corners[static_cast<std::size_t>(c.x)], corners[static_cast<std::size_t>(c.y)],
                                       corners[static_cast<std::size_t>(c.z)]};
        int role = 0;
        while (role < 4 && v[static_cast<std::size_t>(role)] != vertex) ++role;
        if (role == 4) continue;
        Term& term = terms_.emplace_back();
        for (std::size_t i = 0; i < 4; ++i) term.p[i] = &complex_.points[v[i]];
        term.role = role;
        term.factor = factor;
        if (role > 0) shortest_ = std::min(shortest_, (*term.p[0] - complex_.points[vertex]).norm());
      }
    });
    if (!std::isfinite(shortest_)) shortest_ = 0;
  }

  double evaluate(const Vector3& place, double& worst) const {
    double energy = 0;
    worst = std::numeric_limits<double>::infinity();
    for (const Term& t : terms_) {
      const auto at = [&](int i) -> const Vector3& { return i == t.role ? place : *t.p[static_cast<std::size_t>(i)]; };
      const double s = t.factor * normalised_determinant(at(1) - at(0), at(2) - at(0), at(3) - at(0));
      worst = std::min(worst, s);
      energy += QualityEnergy::penalty(s);
    }
    return energy;
  }

  /// Gradient, and the part of the Hessian that squares first derivatives: it is never indefinite.
  void differentiate(const Vector3& place, Vector3& gradient, Eigen::Matrix3d& hessian) const {
    gradient.setZero();
    hessian.setZero();
    for (const Term& t : terms_) {
      const auto at = [&](int i) -> const Vector3& { return i == t.role ? place : *t.p[static_cast<std::size_t>(i)]; };
      const Vector3 e[3] = {at(1) - at(0), at(2) - at(0), at(3) - at(0)};
      const double n2[3] = {e[0].squaredNorm(), e[1].squaredNorm(), e[2].squaredNorm()};
      const double lengths = std::sqrt(n2[0] * n2[1] * n2[2]);
      if (!(lengths > 0)) continue;
      const Vector3 c[3] = {e[1].cross(e[2]), e[2].cross(e[0]), e[0].cross(e[1])};
      const double s = c[0].dot(e[0]) / lengths;
      const double lack = 1 - t.factor * s;
      if (lack <= 0) continue;
      Vector3 d = Vector3::Zero();
      for (int i = 0; i < 3; ++i) {
        if (t.role != 0 && t.role != i + 1) continue;
        const Vector3 di = c[i] / lengths - (s / n2[i]) * e[i];
        d += t.role == 0 ? Vector3(-di) : di;
      }
      gradient -= (4 * lack * lack * lack * t.factor) * d;
      hessian += (12 * lack * lack * t.factor * t.factor) * d * d.transpose();
    }
  }

  /// No valid cell becomes invalid: positive corners are not enough for hexahedra and prisms, nor in rounding for the
  /// others. A cell that is invalid already may stay so while the energy falls.
  bool remains_valid(index_t vertex, const Vector3& place) {
    const Vector3 before = complex_.points[vertex];
    bool valid = true;
    complex_.for_each_cell_at(vertex, [&](index_t cell) {
      if (!valid) return;
      complex_.points[vertex] = place;
      valid = complex_.valid(cell);
      complex_.points[vertex] = before;
      if (!valid) valid = !complex_.valid(cell);
    });
    return valid;
  }

  CellComplex& complex_;
  QualityEnergy energy_;
  Projection projection_;
  std::vector<Term> terms_;
  double shortest_ = 0;
};

}  // namespace framehex::detail
