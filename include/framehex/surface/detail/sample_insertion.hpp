// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/triangle_distance.hpp"
#include "framehex/surface/detail/delaunay_flips.hpp"
#include "framehex/surface/detail/surface_repair.hpp"
#include "framehex/surface/surface_sample.hpp"

#include <span>

namespace framehex::detail {

/// Makes samples vertices of an EditableSurface: splits feature edges at curve samples, then triangles and edges at
/// surface samples. A sample on an existing vertex takes it over.
class SampleInserter {
public:
  SampleInserter(EditableSurface& surface, SectorNormals& normals, const FeatureGraph& features,
                 std::span<const SurfaceSample> samples, CurveChains& chains, Pulse& pulse)
      : surface_(surface),
        normals_(normals),
        features_(features),
        samples_(samples),
        chains_(chains),
        pulse_(pulse),
        flipper_(surface, normals, pulse) {
    for (std::size_t i = 0; i < samples.size(); ++i) check(i);
    sample_of_vertex_.assign(surface.points.size(), no_index);
    vertex_of_sample_.assign(samples.size(), no_index);
  }

  /// Leaves the rest out when it is told to stop.
  void run() {
    for (index_t i = 0; i < samples_.size(); ++i)
      if (samples_[i].kind == SampleKind::corner) take(features_.corners[samples_[i].entity], i);
    insert_on_curves();
    insert_in_triangles();
  }

  const std::vector<index_t>& vertex_of_sample() const { return vertex_of_sample_; }
  const std::vector<index_t>& sample_of_vertex() const { return sample_of_vertex_; }  ///< or `no_index`

private:
  static constexpr double same_point = 1e-7;  ///< relative to the edges about it

  void check(std::size_t i) const {
    const SurfaceSample& s = samples_[i];
    const std::size_t n = s.kind == SampleKind::corner  ? features_.corners.size()
                          : s.kind == SampleKind::curve ? features_.curves.size()
                                                        : surface_.n_triangles();
    if (!s.point.allFinite() || !std::isfinite(s.arc))
      throw invalid_coordinate("sample " + std::to_string(i) + " is not finite", Entity::vertex, {i});
    if (s.entity >= n)
      throw invalid_connectivity(
          "sample " + std::to_string(i) + " refers to entity " + std::to_string(s.entity) + " of " + std::to_string(n),
          Entity::vertex, {i});
  }

  [[noreturn]] static void refuse_twins(index_t a, index_t b) {
    throw invalid_option("samples " + std::to_string(a) + " and " + std::to_string(b) + " are the same point",
                         Entity::vertex, {a, b});
  }

  void take(index_t v, index_t sample) {
    if (sample_of_vertex_[v] != no_index) refuse_twins(sample_of_vertex_[v], sample);
    vertex_of_sample_[sample] = v;
    surface_.for_each_copy(v, [&](index_t copy) {
      sample_of_vertex_[copy] = sample;
      surface_.points[copy] = samples_[sample].point;
    });
  }

  index_t new_vertex(index_t sample) {
    const index_t v = surface_.add_vertex(samples_[sample].point);
    sample_of_vertex_.push_back(sample);
    vertex_of_sample_[sample] = v;
    return v;
  }

  /// Makes copies of a new vertex where the other sides of its edge meet it.
  template <class Sector>
  void split_others(std::span<const index_t> others, index_t v, Sector&& sector) {
    for (const index_t o : others) {
      const index_t name = sector(surface_.parent[o / 3]);
      surface_.split_edge(o, surface_.add_copy(v), name, name);
    }
    sample_of_vertex_.resize(surface_.points.size(), sample_of_vertex_[v]);
  }

  void insert_on_curves() {
    const Csr<index_t> samples_of_curve = make_csr(features_.curves.size(), [&](auto&& put) {
      for (index_t i = 0; i < samples_.size(); ++i)
        if (samples_[i].kind == SampleKind::curve) put(samples_[i].entity, i);
    });
    std::vector<index_t> order;
    for (std::size_t c = 0; c < features_.curves.size() && pulse_.beat(); ++c) {
      order.assign(samples_of_curve[c].begin(), samples_of_curve[c].end());
      std::sort(order.begin(), order.end(), [&](index_t a, index_t b) {
        return samples_[a].arc < samples_[b].arc || (samples_[a].arc == samples_[b].arc && a < b);
      });
      insert_on_curve(c, order);
    }
  }

  void insert_on_curve(std::size_t c, const std::vector<index_t>& order) {
    const auto curve = features_.curves[c];
    const auto arcs = chains_.arcs(c);
    auto& row = chains_.row(c);
    std::size_t next = 0;
    row.push_back({curve[0], 0});
    for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
      const index_t a = curve[i], b = curve[i + 1];
      const double begin = arcs[i], length = arcs[i + 1] - arcs[i];
      const bool last = i + 2 == curve.size();
      index_t at = a;
      double before = 0;
      for (; next < order.size() && (last || samples_[order[next]].arc < begin + (1 - same_point) * length); ++next) {
        const double position = length > 0 ? (samples_[order[next]].arc - begin) / length : 0;
        if (position <= same_point) {
          take(a, order[next]);
        } else if (position >= 1 - same_point) {
          take(b, order[next]);
        } else {
          const double gap = (samples_[order[next]].point - surface_.points[at]).norm();
          if (at != a && (position - before <= same_point || gap <= same_point * length))
            refuse_twins(sample_of_vertex_[at], order[next]);
          at = split_feature(at, b, a, position, order[next]);
          before = position;
          row.push_back({at, samples_[order[next]].arc});
        }
      }
      row.push_back({b, arcs[i + 1]});
    }
  }

  /// Splits what is left, (at, b), of input edge (a, b).
  index_t split_feature(index_t at, index_t b, index_t a, double position, index_t sample) {
    index_t h = surface_.find(at, b);
    if (h == no_index) h = surface_.find(b, at);
    const index_t g = surface_.opposite[h];
    const auto sector = [&](index_t parent) { return normals_.add_on_edge(surface_, parent, a, b, position); };
    const std::vector<index_t> others = surface_.other_sides(h);
    const index_t left = sector(surface_.parent[h / 3]);
    const index_t right = g == no_index ? left : sector(surface_.parent[g / 3]);
    const index_t v = new_vertex(sample);
    surface_.split_edge(h, v, left, right);
    split_others(others, v, sector);
    return v;
  }

  void insert_in_triangles() {
    const std::size_t n = normals_.n_triangles();
    const Csr<index_t> samples_of_triangle = make_csr(n, [&](auto&& put) {
      for (index_t i = 0; i < samples_.size(); ++i)
        if (samples_[i].kind == SampleKind::surface) put(samples_[i].entity, i);
    });
    // Curve samples have cut triangles into fans: make them Delaunay before walking in them.
    flipper_.push_all();
    flipper_.run(DelaunayFlipper::Scope::within_input_triangles);
    std::vector<std::pair<std::array<double, 2>, index_t>> order;
    for (index_t t = 0; t < n; ++t) {
      if (samples_of_triangle[t].empty()) continue;
      sort_in_rows(t, samples_of_triangle[t], order);
      index_t hint = t;
      for (const auto& [key, sample] : order) {
        if (!pulse_.beat()) return;
        hint = insert_in_triangle(t, sample, hint);
      }
    }
  }

  /// Back and forth in rows, so that each sample is near the one before.
  void sort_in_rows(index_t t, std::span<const index_t> samples,
                    std::vector<std::pair<std::array<double, 2>, index_t>>& order) const {
    order.clear();
    const double rows = std::ceil(std::sqrt(static_cast<double>(samples.size())));
    for (const index_t i : samples) {
      const Vector3 b = barycentric(t, samples_[i].point);
      const double row = std::floor(b[1] * rows);
      order.push_back({{row, std::fmod(row, 2) == 0 ? b[2] : -b[2]}, i});
    }
    std::sort(order.begin(), order.end());
  }

  Vector3 barycentric(index_t parent, const Vector3& p) const {
    const auto& v = normals_.corners_of(parent);
    const TrianglePoint q = nearest_on_triangle(p, normals_.point(v[0]), normals_.point(v[1]), normals_.point(v[2]));
    return q.barycentric;
  }

  /// @return a triangle beside the sample, to start the next walk from.
  index_t insert_in_triangle(index_t parent, index_t sample, index_t hint) {
    const Vector3& p = samples_[sample].point;
    const index_t t = walk(parent, p, hint);
    const index_t h = nearest_side(t, p);
    for (const index_t end : {surface_.from(h), surface_.to(h), surface_.apex(h)}) {
      const double size = (surface_.points[surface_.to(h)] - surface_.points[surface_.from(h)]).norm();
      if ((surface_.points[end] - p).norm() > same_point * size) continue;
      take(end, sample);
      return t;
    }
    const auto normal_in = [&](index_t triangle) { return normals_.add(surface_, triangle, barycentric(triangle, p)); };
    const index_t sector = normal_in(parent);
    const index_t v = new_vertex(sample);
    if (relative_distance(h, p) < same_point) {
      const index_t g = surface_.opposite[h];
      const std::vector<index_t> others = surface_.other_sides(h);
      const index_t right = g == no_index || !surface_.feature[h] ? sector : normal_in(surface_.parent[g / 3]);
      surface_.split_edge(h, v, sector, right);
      split_others(others, v, normal_in);
    } else {
      surface_.split_triangle(t, v, sector);
    }
    flipper_.push_star(v);
    flipper_.run(DelaunayFlipper::Scope::within_input_triangles);
    index_t beside = t;
    surface_.for_each_outgoing(v, [&](index_t o) {
      if (surface_.parent[o / 3] == parent) beside = o / 3;
    });
    return beside;
  }

  /// Twice the area of p over half edge h, seen along the input triangle's normal: negative when p is outside.
  double side(index_t h, const Vector3& p) const {
    const Vector3 &a = surface_.points[surface_.from(h)], &b = surface_.points[surface_.to(h)];
    return (b - a).cross(p - a).dot(normals_.of_triangle(surface_.parent[h / 3]));
  }
  double relative_distance(index_t h, const Vector3& p) const {
    const double length = (surface_.points[surface_.to(h)] - surface_.points[surface_.from(h)]).squaredNorm();
    return length > 0 ? side(h, p) / length : std::numeric_limits<double>::infinity();
  }

  /// Walks through the parts of an input triangle to the one that holds p, or the nearest to holding it.
  index_t walk(index_t parent, const Vector3& p, index_t start) const {
    index_t t = start;
    const std::size_t limit = 100 + surface_.n_triangles();
    for (std::size_t step = 0; step < limit; ++step) {
      index_t out = no_index;
      double worst = -1e-12;
      for (index_t h = 3 * t; h < 3 * t + 3; ++h) {
        const index_t g = surface_.opposite[h];
        if (g == no_index || surface_.parent[g / 3] != parent) continue;
        const double d = relative_distance(h, p);
        if (d < worst) {
          worst = d;
          out = g / 3;
        }
      }
      if (out == no_index) break;
      t = out;
    }
    return t;
  }

  index_t nearest_side(index_t t, const Vector3& p) const {
    index_t best = 3 * t;
    for (index_t h = 3 * t + 1; h < 3 * t + 3; ++h)
      if (relative_distance(h, p) < relative_distance(best, p)) best = h;
    return best;
  }

  EditableSurface& surface_;
  SectorNormals& normals_;
  const FeatureGraph& features_;
  std::span<const SurfaceSample> samples_;
  CurveChains& chains_;
  Pulse& pulse_;
  DelaunayFlipper flipper_;
  std::vector<index_t> sample_of_vertex_, vertex_of_sample_;
};

}  // namespace framehex::detail
