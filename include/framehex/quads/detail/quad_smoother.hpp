// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/quadrilateral.hpp"
#include "framehex/quads/detail/editable_quads.hpp"
#include "framehex/quads/detail/quad_shape.hpp"
#include "framehex/surface/feature_carriers.hpp"

#include <array>
#include <span>

namespace framehex::detail {

/// Moves vertices of quadrilaterals, those inside on their patch and those of curves along their curve, where that makes
/// the cells about them better.
class QuadSmoother {
public:
  /// @param max_deviation  diagonals of the carriers' box: see `QuadImprovementOptions`.
  QuadSmoother(EditableQuads& quads, const FeatureCarriers& carriers, double max_deviation)
      : quads_(quads), carriers_(carriers), max_distance_(max_deviation * carriers.diagonal()) {}

  /// Brings every vertex to its patch or curve, and finds the normals.
  void settle() {
    for (index_t v = 0; v < quads_.points.size(); ++v)
      if (quads_.half_edge_of[v] != no_index) place(v, quads_.points[v]);
    given_distance_.assign(carriers_.n_curves(), 0);
    for (index_t v = 0; v < quads_.points.size(); ++v)
      for_each_side_on_curve(v, [&](const Vector3& end) {
        double& given = given_distance_[quads_.curve[v]];
        given = std::max(given, distance_on_curve(v, end));
      });
  }

  /// Whether steps that leave a cell folded are not made.
  void keep_sound(bool keep) { keep_sound_ = keep; }
  bool keeps_sound() const { return keep_sound_; }

  /// One step of a vertex towards the least energy of its cells. @return how far it moved, in mean edges about it.
  double relax(index_t v) {
    if (quads_.is_fixed(v) || quads_.half_edge_of[v] == no_index) return 0;
    const double edge = mean_edge(v);
    if (!(edge > 0)) return 0;
    const double least = 0.02 * edge * edge;
    const Vector3 old = quads_.points[v];
    VertexModel model;
    quads_.for_each_copy(
        v, [&](index_t copy) { quads_.for_each_outgoing(copy, [&](index_t h) { add_cell(h, least, model); }); });
    Vector3 step = quads_.curve[v] == no_index ? step_in_patch(v, model) : step_along_curve(v, model);
    if (const double length = step.norm(); length > 0.5 * edge) step *= 0.5 * edge / length;
    for (int halvings = 0; halvings < 6; ++halvings, step /= 2) {
      if (step.norm() < 1e-7 * edge) break;
      place(v, old + step);
      if (energy(v, least) < model.energy * (1 - 1e-9) && (!keep_sound_ || all_sound(v)) && follows_curve(v))
        return (quads_.points[v] - old).norm() / edge;
    }
    place(v, old);
    return 0;
  }

  /// Is the angle of a cell the input's doing? A corner that has room for one cell and has no more is as sharp as it is,
  /// and so is a tip that three surround.
  bool is_given(index_t v) const {
    const index_t n = quads_.is_tip(v) ? 3 : 1;
    return quads_.is_fixed(v) && quads_.n_cells[v] <= n && quads_.target[v] <= n;
  }

  /// Least free quality of the cells round a vertex.
  double least_quality(index_t v) const {
    double least = 1;
    quads_.for_each_copy(v, [&](index_t copy) {
      quads_.for_each_outgoing(copy, [&](index_t h) { least = std::min(least, free_quality(h / 4)); });
    });
    return least;
  }

  double quality(index_t q) const {
    std::array<Vector3, 4> storage;
    return scaled_jacobian(places(q, storage), normal(q));
  }

  /// The same of the corners about which the input leaves a choice.
  double free_quality(index_t q) const {
    double least = 1;
    const Vector3 n = normal(q);
    for (index_t h = 4 * q; h < 4 * q + quads_.size(q); ++h) {
      if (is_given(quads_.from(h))) continue;
      const Vector3 x = at(quads_.next(h)) - at(h), y = at(quads_.previous(h)) - at(h);
      const double lengths = std::sqrt(x.squaredNorm() * y.squaredNorm());
      least = std::min(least, lengths > 0 ? x.cross(y).dot(n) / lengths : 0.0);
    }
    return least;
  }

  bool is_convex(index_t q) const {
    std::array<Vector3, 4> storage;
    return framehex::is_convex(places(q, storage), normal(q));
  }

  /// Convex, and not for want of rounding: a quadrilateral's corner on a straight side is as good as folded.
  bool is_sound(index_t q) const { return is_convex(q) && (!quads_.is_quad(q) || quality(q) > flat); }

  /// Are the cells round a vertex?
  bool all_sound(index_t v) const {
    bool sound = true;
    quads_.for_each_copy(
        v, [&](index_t copy) { quads_.for_each_outgoing(copy, [&](index_t h) { sound = sound && is_sound(h / 4); }); });
    return sound;
  }

  Vector3 normal(index_t q) const {
    Vector3 sum = Vector3::Zero();
    for (std::size_t i = 0; i < quads_.size(q); ++i) sum += quads_.normals[quads_.corners[q][i]];
    const double length = sum.norm();
    return length > 0 ? Vector3(sum / length) : sum;
  }

  /// Moves a vertex to the nearest place that it may have.
  void place(index_t v, const Vector3& wished) {
    if (quads_.is_inside(v)) {
      const auto at = carriers_.onto_patch(quads_.patch[quads_.half_edge_of[v] / 4], wished);
      quads_.points.set(v, at.point);
      quads_.normals.set(v, at.normal);
      return;
    }
    const Vector3 at = quads_.is_fixed(v) ? quads_.points[v] : carriers_.onto_curve(quads_.curve[v], wished);
    if (quads_.is_tip(v)) return;  // without a normal: the cells about it have those of their other corners
    quads_.for_each_copy(v, [&](index_t copy) {
      quads_.points.set(copy, at);
      if (quads_.half_edge_of[copy] != no_index)
        quads_.normals.set(copy, carriers_.onto_patch(quads_.patch[quads_.half_edge_of[copy] / 4], at).normal);
    });
  }

private:
  static constexpr double flat = 1e-6;       ///< scaled Jacobian
  static constexpr double least_cut = 0.05;  ///< of a side on a curve: one that is nearer to it hardly shows

  /// Calls `visit(other end)` for both sides along the curve of a vertex that may move on one.
  template <class Visit>
  void for_each_side_on_curve(index_t v, Visit&& visit) const {
    const index_t h = quads_.half_edge_of[v];  // open fans start on the curve
    if (quads_.curve[v] == no_index || h == no_index) return;
    index_t last = h;
    quads_.for_each_outgoing(v, [&](index_t o) { last = o; });
    visit(at(quads_.next(h)));
    visit(at(quads_.previous(last)));
  }

  /// From the curve of a vertex to a side along it.
  double distance_on_curve(index_t v, const Vector3& end) const {
    return carriers_.farthest_from_chord(quads_.curve[v], quads_.points[v], end).distance;
  }

  /// Are the sides beside a vertex of a curve as near to that as sliding may leave them?
  bool follows_curve(index_t v) const {
    bool follows = true;
    for_each_side_on_curve(v, [&](const Vector3& end) {
      const double nearest = std::min(max_distance_, least_cut * (end - quads_.points[v]).norm());
      const double allowed = std::max(given_distance_[quads_.curve[v]], nearest);
      follows = follows && distance_on_curve(v, end) <= allowed * (1 + 1e-9);
    });
    return follows;
  }

  std::span<const Vector3> places(index_t q, std::array<Vector3, 4>& storage) const {
    const std::size_t n = quads_.size(q);
    for (std::size_t i = 0; i < n; ++i) storage[i] = quads_.points[quads_.corners[q][i]];
    return std::span(storage).first(n);
  }

  /// The cell of a half edge that leaves the vertex, whose place is what the model is of.
  void add_cell(index_t h, double least, VertexModel& model) const {
    const index_t q = h / 4;
    const index_t after = quads_.next(h), before = quads_.previous(h);
    const Vector3 n = normal(q);
    const double shape = quads_.is_quad(q) ? 1 : std::sqrt(0.75);
    const Vector3 &v = at(h), &a = at(after), &b = at(before);
    {
      const Vector3 x = a - v, y = b - v;
      model.add({x, y, n, shape, least}, -2 * (x + y), n.cross(y - x), 2);
    }
    {  // the next corner: v is where its second side ends
      const Vector3 x = at(quads_.next(after)) - a, y = v - a;
      model.add({x, y, n, shape, least}, 2 * y, n.cross(x), 1);
    }
    {  // the one before: its first side
      const Vector3 x = v - b, y = at(quads_.previous(before)) - b;
      model.add({x, y, n, shape, least}, 2 * x, y.cross(n), 1);
    }
  }

  double energy(index_t v, double least) const {
    double sum = 0;
    quads_.for_each_copy(v, [&](index_t copy) {
      quads_.for_each_outgoing(copy, [&](index_t h) {
        const index_t q = h / 4, after = quads_.next(h), before = quads_.previous(h);
        const Vector3 n = normal(q);
        const double shape = quads_.is_quad(q) ? 1 : std::sqrt(0.75);
        const Vector3 &p = at(h), &a = at(after), &b = at(before);
        sum += CornerShape(a - p, b - p, n, shape, least).energy() +
               CornerShape(at(quads_.next(after)) - a, p - a, n, shape, least).energy() +
               CornerShape(p - b, at(quads_.previous(before)) - b, n, shape, least).energy();
      });
    });
    return sum;
  }

  const Vector3& at(index_t h) const { return quads_.points[quads_.from(h)]; }

  double mean_edge(index_t v) const {
    double sum = 0, n = 0;
    quads_.for_each_copy(v, [&](index_t copy) {
      quads_.for_each_outgoing(copy, [&](index_t h) {
        sum += (at(quads_.next(h)) - at(h)).norm() + (at(quads_.previous(h)) - at(h)).norm();
        n += 2;
      });
    });
    return n > 0 ? sum / n : 0;
  }

  /// Newton's step in the tangent plane.
  Vector3 step_in_patch(index_t v, const VertexModel& model) const {
    const Vector3& n = quads_.normals[v];
    const Vector3 x = n.unitOrthogonal(), y = n.cross(x);
    const double gx = model.gradient.dot(x), gy = model.gradient.dot(y);
    const double xx = x.dot(model.curvature * x), xy = x.dot(model.curvature * y), yy = y.dot(model.curvature * y);
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 0)) return Vector3::Zero();
    return -((yy * gx - xy * gy) * x + (xx * gy - xy * gx) * y) / determinant;
  }

  /// The same along the chord of its neighbours on the curve.
  Vector3 step_along_curve(index_t v, const VertexModel& model) const {
    Vector3 tangent = Vector3::Zero();
    for_each_side_on_curve(v, [&](const Vector3& end) { tangent = end - tangent; });  // second end less the first
    const double length = tangent.norm();
    if (!(length > 0)) return Vector3::Zero();
    tangent /= length;
    const double curvature = tangent.dot(model.curvature * tangent);
    return curvature > 0 ? Vector3(-(model.gradient.dot(tangent) / curvature) * tangent) : Vector3::Zero();
  }

  EditableQuads& quads_;
  const FeatureCarriers& carriers_;
  double max_distance_;
  std::vector<double> given_distance_;  ///< by curve: from it to the sides given, the greatest
  bool keep_sound_ = false;
};

}  // namespace framehex::detail
