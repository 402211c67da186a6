// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/quality_energy.hpp"

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

  static constexpr double little_energy = 1e-3;  ///< of one corner at 0.82 of its target

  /// @param enough  energy that is left as it is.
  /// @return whether the vertex moved.
  bool smooth(index_t vertex, double enough = little_energy) {
    if (complex_.unused(vertex)) return false;
    const bool bound = complex_.on_boundary[vertex] != 0 || complex_.is_protected[vertex] != 0;
    if (bound && !projection_) return false;
    gather(vertex);
    const Vector3 start = complex_.points[vertex];
    Vector3 place = start;
    double worst = -std::numeric_limits<double>::infinity();
    double energy = evaluate(place, std::numeric_limits<double>::infinity(), worst);
    double damping = 1e-3;
    for (int iteration = 0; iteration < max_iterations && energy > enough; ++iteration) {
      Vector3 gradient;
      Eigen::Matrix3d hessian;
      differentiate(place, gradient, hessian);
      bool improved = false;
      const double before = energy;
      for (int attempt = 0; attempt < 5 && !improved; ++attempt, damping *= 20) {
        Vector3 step = solve(hessian, damping * hessian.trace() + 1e-300, gradient);
        const double length = step.norm();
        if (!(length > 1e-9 * shortest_)) break;
        if (length > 0.5 * shortest_) step *= 0.5 * shortest_ / length;
        Vector3 trial = place + step;
        if (bound && !projection_(vertex, trial)) return false;
        double trial_worst = worst;
        const double trial_energy = evaluate(trial, energy * (1 - 1e-6), trial_worst);
        if (!std::isfinite(trial_energy) || !remains_valid(vertex, trial, trial_worst)) continue;
        improved = true;
        place = trial;
        energy = trial_energy;
        worst = trial_worst;
      }
      if (!improved || energy > 0.95 * before) break;
      damping = std::max(0.005 * damping, 1e-6);
    }
    if (place == start) return false;
    complex_.move(vertex, place);
    return true;
  }

private:
  static constexpr int max_iterations = 6;

  /// A corner at the vertex that moves and the ends of its three edges.
  struct Corner {
    std::array<Vector3, 3> end;
    double factor;  ///< 1 over the target
  };
  /// A corner at which the vertex that moves ends an edge. The determinant is linear in that edge.
  struct End {
    Vector3 corner;
    Vector3 normal;  ///< cross product of the other two edges over their lengths and the target
  };

  void gather(index_t vertex) {
    corners_.clear();
    ends_.clear();
    const auto& p = complex_.points;
    shortest_ = std::numeric_limits<double>::infinity();
    complex_.for_each_cell_at(vertex, [&](index_t cell) {
      const CellKind kind = complex_.cells[cell].kind;
      const auto& v = complex_.cells[cell].corners;
      const double factor = 1 / energy_.target(kind);
      std::int8_t at = 0;
      while (v[static_cast<std::size_t>(at)] != vertex) ++at;
      const auto point = [&](std::int8_t i) -> const Vector3& { return p[v[static_cast<std::size_t>(i)]]; };
      const auto add_end = [&](std::int8_t corner, std::int8_t next, std::int8_t last) {
        const Vector3 a = point(next) - point(corner), b = point(last) - point(corner);
        const double lengths = std::sqrt(a.squaredNorm() * b.squaredNorm());
        ends_.push_back({point(corner), lengths > 0 ? Vector3(a.cross(b) * (factor / lengths)) : Vector3::Zero()});
        shortest_ = std::min(shortest_, (point(corner) - p[vertex]).squaredNorm());
      };
      for (const LocalCorner& c : corners_of(kind)) {
        if (c.corner == at) corners_.push_back({{point(c.x), point(c.y), point(c.z)}, factor});
        if (c.x == at) add_end(c.corner, c.y, c.z);
        if (c.y == at) add_end(c.corner, c.z, c.x);
        if (c.z == at) add_end(c.corner, c.x, c.y);
      }
    });
    shortest_ = std::isfinite(shortest_) ? std::sqrt(shortest_) : 0.0;
  }

  /// Energy with the vertex at `place`; infinite where it is not below `limit` or where the worst corner is not
  /// acceptable after `worst`, which else becomes the new one.
  double evaluate(const Vector3& place, double limit, double& worst) const {
    double energy = 0, least = std::numeric_limits<double>::infinity();
    const auto add = [&](double s) {
      least = std::min(least, s);
      energy += QualityEnergy::penalty(s);
      return energy < limit && acceptable(worst, s);
    };
    for (const End& t : ends_) {
      const Vector3 e = place - t.corner;
      const double length = e.norm();
      if (!add(length > 0 ? t.normal.dot(e) / length : 0.0)) return std::numeric_limits<double>::infinity();
    }
    for (const Corner& t : corners_)
      if (!add(t.factor * normalised_determinant(t.end[0] - place, t.end[1] - place, t.end[2] - place)))
        return std::numeric_limits<double>::infinity();
    worst = least;
    return energy;
  }

  /// Gradient, and the part of the Hessian that squares first derivatives: it is never indefinite.
  void differentiate(const Vector3& place, Vector3& gradient, Eigen::Matrix3d& hessian) const {
    gradient.setZero();
    hessian.setZero();
    const auto add = [&](double lack, const Vector3& d) {
      gradient -= (4 * lack * lack * lack) * d;
      hessian += (12 * lack * lack) * d * d.transpose();
    };
    for (const End& t : ends_) {
      const Vector3 e = place - t.corner;
      const double length = e.norm();
      if (!(length > 0)) continue;
      const double s = t.normal.dot(e) / length;
      if (s < 1) add(1 - s, (t.normal - (s / length) * e) / length);
    }
    for (const Corner& t : corners_) {
      const Vector3 e[3] = {t.end[0] - place, t.end[1] - place, t.end[2] - place};
      const double n2[3] = {e[0].squaredNorm(), e[1].squaredNorm(), e[2].squaredNorm()};
      const double lengths = std::sqrt(n2[0] * n2[1] * n2[2]);
      if (!(lengths > 0)) continue;
      const Vector3 c[3] = {e[1].cross(e[2]), e[2].cross(e[0]), e[0].cross(e[1])};
      const double scale = t.factor / lengths, s = c[0].dot(e[0]) * scale;
      if (s >= 1) continue;
      Vector3 d = Vector3::Zero();
      for (int i = 0; i < 3; ++i) d += (s / n2[i]) * e[i] - scale * c[i];
      add(1 - s, d);
    }
  }

  /// Minus the solution of a symmetric system whose diagonal is raised, by Cramer's rule.
  static Vector3 solve(const Eigen::Matrix3d& m, double raise, const Vector3& right) {
    const Vector3 x = m.col(0) + raise * Vector3::UnitX(), y = m.col(1) + raise * Vector3::UnitY(),
                  z = m.col(2) + raise * Vector3::UnitZ();
    const Vector3 yz = y.cross(z), zx = z.cross(x), xy = x.cross(y);
    return -Vector3(yz.dot(right), zx.dot(right), xy.dot(right)) / x.dot(yz);
  }

  /// No valid cell becomes invalid: positive corners are not enough for hexahedra and prisms. For the others they are,
  /// when clear of rounding. A cell that is invalid already may stay so while the energy falls.
  bool remains_valid(index_t vertex, const Vector3& place, double worst) {
    const Vector3 before = complex_.points[vertex];
    bool valid = true;
    complex_.for_each_cell_at(vertex, [&](index_t cell) {
      const CellKind kind = complex_.cells[cell].kind;
      if (!valid || (worst > 1e-6 && (kind == CellKind::tetrahedron || kind == CellKind::pyramid))) return;
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
  std::vector<Corner> corners_;
  std::vector<End> ends_;
  double shortest_ = 0;
};

}  // namespace framehex::detail
