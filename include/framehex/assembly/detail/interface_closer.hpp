// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/cavity_grower.hpp"
#include "framehex/assembly/detail/originals.hpp"
#include "framehex/assembly/options.hpp"
#include "framehex/observer.hpp"

namespace framehex::detail {

/// Closes open quadrilaterals: by a pyramid over the tetrahedra in front, else by giving up the cell behind.
class InterfaceCloser {
public:
  InterfaceCloser(CellComplex& complex, const Originals& originals, double quality_floor,
                  AssemblyStatistics& statistics, Pulse& pulse)
      : complex_(complex),
        filler_(complex),
        grower_(complex, filler_),
        originals_(originals),
        floor_(quality_floor),
        statistics_(statistics),
        pulse_(pulse) {}

  /// Merges pairs of tetrahedra with a common apex on an open quadrilateral, the best pyramids first.
  void merge_pairs(double least_quality) {
    struct Pair {
      double quality;
      index_t quad;
    };
    std::vector<Pair> pairs;
    for (index_t quad = 0; quad < complex_.open_quads.size(); ++quad) {
      double quality = least_quality;
      if (complex_.open_quads[quad].open && find_pair(quad, quality) != no_index) pairs.push_back({quality, quad});
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) { return x.quality > y.quality; });
    for (const Pair& pair : pairs) {
      double quality = least_quality;
      const index_t apex = find_pair(pair.quad, quality);  // one of the two may have gone to a better pyramid
      if (apex != no_index && filler_.fill(cavity_, apex) == 1) ++statistics_.n_merged;
    }
  }

  /// Closes every open quadrilateral, or leaves open those that no cell can be put before.
  void close_all() {
    for (const double quality : {0.4, 0.3, 0.2}) for_each_open([&](index_t quad) { raise_to_vertex(quad, quality); });
    for (const double quality : {0.3, 0.2, 0.1, floor_, 1e-3})
      for_each_open([&](index_t quad) {
        if (!raise_to_vertex(quad, std::max(quality, 0.1))) raise_to_new_vertex(quad, quality);
      });
    for_each_open([&](index_t quad) { give_up(quad, 1e-3); });
  }

private:
  static constexpr double comfortable = 0.2;  ///< quality of a new pyramid that needs no more search

  /// Quadrilaterals opened on the way are visited too. Only a chosen cell that is taken back opens any, and it is gone for
  /// good, so this ends.
  template <class Visit>
  void for_each_open(Visit&& visit) {
    const double first = pulse_.fraction(), share = 0.05;
    for (index_t quad = 0; quad < complex_.open_quads.size(); ++quad) {
      if (!complex_.open_quads[quad].open || complex_.is_deferred(complex_.open_quads[quad])) continue;
      if (!pulse_.beat(first + share * quad / static_cast<double>(complex_.open_quads.size()))) return;
      visit(quad);
    }
  }

  bool changed_since(index_t quad, CellComplex::Time time) const {
    return std::ranges::any_of(complex_.open_quads[quad].vertices,
                               [&](index_t v) { return complex_.changed_since(v, time); });
  }

  /// The cells round the diagonal in front of an open quadrilateral.
  bool gather_fan(index_t quad, Cavity& cavity) {
    const OpenQuad& q = complex_.open_quads[quad];
    if (q.half_boundary) return false;
    const index_t a = q.triangle(0)[0], c = q.triangle(0)[2];
    cavity.cells.clear();
    bool raisable = true;
    complex_.for_each_cell_at(a, [&](index_t cell) {
      if (!complex_.has_vertex(cell, c) || cell == q.cell) return;
      const CellKind kind = complex_.cells[cell].kind;
      if (kind == CellKind::hexahedron || kind == CellKind::prism) raisable = false;
      cavity.cells.push_back(cell);
    });
    return raisable && !cavity.cells.empty();
  }

  index_t find_pair(index_t quad, double& quality) {
    if (!gather_fan(quad, cavity_) || cavity_.cells.size() != 2 || !filler_.build(cavity_)) return no_index;
    if (cavity_.faces.size() != 5) return no_index;
    return filler_.best_apex(cavity_, quality);
  }

  /// A pyramid whose apex is a vertex of the fan; the rest of the fan is joined to it.
  bool raise_to_vertex(index_t quad, double least_quality) {
    if (!gather_fan(quad, cavity_) || !filler_.build(cavity_)) return false;
    double quality = least_quality;
    const std::size_t n_cells = cavity_.cells.size();
    const index_t apex = filler_.best_apex(cavity_, quality);
    if (apex == no_index || filler_.fill(cavity_, apex) == 0) return false;
    ++(n_cells == 2 ? statistics_.n_merged : statistics_.n_raised);
    return true;
  }

  /// A pyramid with a new apex in a cavity that grows from the fan as long as that helps.
  bool raise_to_new_vertex(index_t quad, double least_quality) {
    // In vain before, and nothing has changed since?
    reached_.resize(complex_.open_quads.size(), {0, 2.0});
    if (reached_[quad].quality < least_quality && !changed_since(quad, reached_[quad].time)) return false;
    const CellComplex::Time now = complex_.tick();
    reached_[quad] = {now, -2.0};
    if (!gather_fan(quad, cavity_) || !filler_.build(cavity_)) return false;
    Vector3 point;
    double quality = place_over(quad, cavity_, point);
    grower_.grow(cavity_, quality, point, 0.2 * frame_over(quad).side);
    if (quality < comfortable) grow_round_points(quad, quality, point);
    reached_[quad].quality = quality;
    if (quality < least_quality) return false;
    return fill_from_new_vertex(cavity_, point, statistics_.n_raised);
  }

  /// Takes, for points at several heights over a quadrilateral, all cells that hide a face from the point.
  void grow_round_points(index_t quad, double& quality, Vector3& point) {
    const Frame frame = frame_over(quad);
    Cavity grown;
    for (const double height : {0.5, 0.3, 0.15}) {
      Vector3 place = frame.centre + height * frame.up;
      if (!gather_fan(quad, grown) || !filler_.build(grown) || !grower_.uncover(place, 0.05, grown)) continue;
      const double start = filler_.evaluate(grown, place, no_index);
      const double reached = filler_.improve_point(grown, place, 0.1 * frame.side, start);
      if (reached <= quality) continue;
      quality = reached;
      point = place;
      std::swap(cavity_, grown);
    }
  }

  /// Where a quadrilateral lies, and the way out of its cell with the length of its side.
  struct Frame {
    Vector3 centre, up;
    double side;
  };
  Frame frame_over(index_t quad) const {
    const auto& q = complex_.open_quads[quad].vertices;
    const auto& p = complex_.points;
    const Vector3 area = 0.5 * (p[q[2]] - p[q[0]]).cross(p[q[3]] - p[q[1]]);
    const double side = std::sqrt(area.norm());
    return {0.25 * (p[q[0]] + p[q[1]] + p[q[2]] + p[q[3]]), area / std::max(side, 1e-300), side};
  }

  /// The best place for a new apex over a quadrilateral.
  double place_over(index_t quad, const Cavity& cavity, Vector3& point) {
    const Frame frame = frame_over(quad);
    double best = -2.0;
    for (const double height : {0.6, 0.4, 0.25, 0.12, 0.05, 0.02}) {
      const Vector3 trial = frame.centre + height * frame.up;
      const double quality = filler_.evaluate(cavity, trial, no_index, best);
      if (quality <= best) continue;
      best = quality;
      point = trial;
    }
    return filler_.improve_point(cavity, point, 0.1 * frame.side, best);
  }

  bool fill_from_new_vertex(const Cavity& cavity, const Vector3& point, std::size_t& counter) {
    if (!filler_.fill_from_new_vertex(cavity, point)) return false;
    ++counter;
    return true;
  }

  /// Splits the cell behind from its centre, or takes it back into its tetrahedra. When all of that fails the
  /// quadrilateral stays open.
  void give_up(index_t quad, double least_quality) {
    if (raise_to_vertex(quad, 0.1) || raise_to_new_vertex(quad, least_quality)) return;
    const index_t cell = complex_.open_quads[quad].cell;
    if (split(cell, least_quality)) return;
    if (dissolve(complex_, filler_, originals_, cell)) {
      ++statistics_.n_dissolved;
      return;
    }
    static_cast<void>(split(cell, 0.0));  // what stays open is looked at when all is done
  }

  bool split(index_t cell, double least_quality) {
    cavity_.cells = {cell};
    if (!filler_.build(cavity_)) return false;
    Vector3 centre = Vector3::Zero();
    const auto corners = complex_.corners(cell);
    for (const index_t v : corners) centre += complex_.points[v] / static_cast<double>(corners.size());
    const double size = (complex_.points[corners[0]] - centre).norm();
    const double start = filler_.evaluate(cavity_, centre, no_index);
    if (filler_.improve_point(cavity_, centre, 0.2 * size, start) <= least_quality) return false;
    return fill_from_new_vertex(cavity_, centre, statistics_.n_split);
  }

  CellComplex& complex_;
  CavityFiller filler_;
  CavityGrower grower_;
  const Originals& originals_;
  double floor_;
  AssemblyStatistics& statistics_;
  Pulse& pulse_;
  Cavity cavity_;

  /// The best quality of a pyramid with a new apex that was found at a time.
  struct Reached {
    CellComplex::Time time;
    double quality;
  };
  std::vector<Reached> reached_;  ///< by open quadrilateral
};

}  // namespace framehex::detail
