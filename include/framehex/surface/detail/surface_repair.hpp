// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/triangle_distance.hpp"
#include "framehex/surface/detail/delaunay_flips.hpp"
#include "framehex/surface/self_intersection.hpp"

#include <optional>
#include <span>
#include <unordered_map>

namespace framehex::detail {

/// The curves of a surface while vertices come and go: vertices with their arc lengths on the input's curves.
class CurveChains {
public:
  struct Link {
    index_t vertex;
    double arc;
  };

  /// @param input  vertices along each curve of the input surface; must outlive this.
  CurveChains(const std::vector<Vector3>& points, const Csr<index_t>& input) : input_(input) {
    for (std::size_t c = 0; c < input.size(); ++c) {
      double arc = 0;
      for (std::size_t i = 0; i < input[c].size(); ++i) {
        input_points_.push_back(points[input[c][i]]);
        if (i > 0) arc += (points[input[c][i]] - points[input[c][i - 1]]).norm();
        input_arcs_.push_back(arc);
      }
    }
    rows_.resize(input.size());
  }

  std::size_t size() const { return rows_.size(); }
  std::vector<Link>& row(std::size_t c) { return rows_[c]; }
  const std::vector<Link>& row(std::size_t c) const { return rows_[c]; }
  std::span<const double> arcs(std::size_t c) const {
    return {input_arcs_.data() + input_.offsets[c], input_[c].size()};
  }
  double length(std::size_t c) const { return arcs(c).back(); }

  /// Point of the input's curve c at an arc length.
  Vector3 point(std::size_t c, double arc) const {
    const auto a = arcs(c);
    const auto at = std::upper_bound(a.begin() + 1, a.end() - 1, arc) - a.begin();
    const std::size_t i = input_.offsets[c] + static_cast<std::size_t>(at);
    const double length = input_arcs_[i] - input_arcs_[i - 1];
    const double x = length > 0 ? std::clamp((arc - input_arcs_[i - 1]) / length, 0.0, 1.0) : 0.0;
    return input_points_[i - 1] + x * (input_points_[i] - input_points_[i - 1]);
  }

  /// Drops vertices that are gone; a closed curve then starts at its first survivor.
  template <class Alive>
  void drop_dead(Alive&& alive) {
    for (std::size_t c = 0; c < rows_.size(); ++c) {
      auto& row = rows_[c];
      if (row.empty()) continue;
      const bool closed = row.front().vertex == row.back().vertex;
      if (closed) row.pop_back();
      std::erase_if(row, [&](const Link& link) { return !alive(link.vertex); });
      if (closed && !row.empty()) row.push_back({row.front().vertex, row.front().arc + length(c)});
    }
  }

private:
  const Csr<index_t>& input_;
  std::vector<Vector3> input_points_;
  std::vector<double> input_arcs_;
  std::vector<std::vector<Link>> rows_;
};

/// Takes self-intersections out of an EditableSurface by bringing it nearer to the surface that it stands for, where
/// they are: the longest edges of the triangles that cross are cut at points of the input.
class SurfaceRepair {
public:
  SurfaceRepair(EditableSurface& surface, SectorNormals& normals, CurveChains& chains, DelaunayFlipper& flipper,
                Pulse& pulse)
      : surface_(surface), normals_(normals), chains_(chains), flipper_(flipper), pulse_(pulse) {}

  /// Gives up as well when the triangles that cross grow in number: then the input itself crosses there, and each round
  /// would double them.
  ///
  /// @return the pairs of triangles that still cross after at most `max_rounds` rounds, numbered among the living.
  std::vector<std::array<index_t, 2>> run(int max_rounds) {
    std::vector<index_t> crossing = crossing_triangles();
    const std::size_t most = 4 * crossing.size() + 100;
    for (int round = 0; round < max_rounds && !crossing.empty() && crossing.size() <= most; ++round) {
      if (tree_.nodes().empty()) build_tree();
      for (const index_t t : crossing)
        if (surface_.alive(t)) split_longest(t);
      flipper_.run(DelaunayFlipper::Scope::within_patches);
      crossing = crossing_triangles();
    }
    merge_added();
    return std::move(pairs_);
  }

private:
  std::vector<index_t> crossing_triangles() {
    IndexedTriangleMesh mesh;
    mesh.points = surface_.points;
    std::vector<index_t> triangle_of;
    for (index_t t = 0; t < surface_.n_triangles(); ++t) {
      if (!surface_.alive(t)) continue;
      triangle_of.push_back(t);
      auto& triangle = mesh.triangles.emplace_back(surface_.corners[t]);
      for (index_t& v : triangle) v = surface_.name[v];
    }
    pairs_ = find_crossings(mesh.points, mesh.triangles, static_cast<std::size_t>(-1), pulse_);
    std::vector<index_t> crossing;
    for (const auto& pair : pairs_)
      for (const index_t t : pair) crossing.push_back(triangle_of[t]);
    std::sort(crossing.begin(), crossing.end());
    crossing.erase(std::unique(crossing.begin(), crossing.end()), crossing.end());
    return crossing;
  }

  void build_tree() {
    std::vector<BoxTree::Bounds> boxes;
    for (index_t t = 0; t < normals_.n_triangles(); ++t) {
      const auto& v = normals_.corners_of(t);
      boxes.push_back(triangle_bounds(normals_.point(v[0]), normals_.point(v[1]), normals_.point(v[2])));
    }
    tree_ = BoxTree(boxes);
  }

  void split_longest(index_t t) {
    const auto length = [&](index_t h) {
      return (surface_.points[surface_.to(h)] - surface_.points[surface_.from(h)]).squaredNorm();
    };
    index_t h = 3 * t;
    for (index_t o = 3 * t + 1; o < 3 * t + 3; ++o)
      if (length(o) > length(h)) h = o;
    if (surface_.feature[h])
      split_on_curve(h);
    else
      split_in_patch(h);
  }

  struct Foot {
    index_t triangle;
    TrianglePoint place;
  };

  /// Nearest point of the input in a patch, on triangles that face the same way.
  std::optional<Foot> project(const Vector3& p, index_t patch, const Vector3& facing) const {
    std::optional<Foot> best;
    double distance = std::numeric_limits<double>::infinity();
    tree_.nearest(p, distance, [&](index_t first, index_t count) {
      for (index_t i = first; i < first + count; ++i) {
        const index_t t = tree_.order()[i];
        if (normals_.patch_of(t) != patch || normals_.of_triangle(t).dot(facing) < 0.2 * facing.norm()) continue;
        const auto& v = normals_.corners_of(t);
        const TrianglePoint q =
            nearest_on_triangle(p, normals_.point(v[0]), normals_.point(v[1]), normals_.point(v[2]));
        if (q.squared_distance > distance || (q.squared_distance == distance && best && t > best->triangle)) continue;
        distance = q.squared_distance;
        best = Foot{t, q};
      }
      return distance;
    });
    return best;
  }

  void split_in_patch(index_t h) {
    const Vector3 &a = surface_.points[surface_.from(h)], &b = surface_.points[surface_.to(h)];
    const Vector3 middle = (a + b) / 2;
    const auto foot = project(middle, surface_.patch[h / 3], normals_.at(h) + normals_.at(EditableSurface::next(h)));
    if (!foot || foot->place.squared_distance > 0.1 * (b - a).squaredNorm()) return;
    const index_t sector = normals_.add(surface_, foot->triangle, foot->place.barycentric);
    const index_t v = surface_.add_vertex(foot->place.point);
    surface_.split_edge(h, v, sector, sector);
    flipper_.push_star(v);
  }

  /// A piece of a curve between two vertices, with the arc lengths at the smaller and the larger one.
  struct Piece {
    std::size_t curve;
    double arc_at_smaller, arc_at_larger;
  };

  void add_piece(std::size_t curve, const CurveChains::Link& from, const CurveChains::Link& to) {
    const bool rises = from.vertex < to.vertex;
    pieces_.try_emplace(edge_key(from.vertex, to.vertex),
                        Piece{curve, rises ? from.arc : to.arc, rises ? to.arc : from.arc});
  }

  void find_pieces() {
    added_.resize(chains_.size());
    for (std::size_t c = 0; c < chains_.size(); ++c)
      for (std::size_t i = 0; i + 1 < chains_.row(c).size(); ++i)
        add_piece(c, chains_.row(c)[i], chains_.row(c)[i + 1]);
  }

  void split_on_curve(index_t h) {
    const index_t a = surface_.name[surface_.from(h)], b = surface_.name[surface_.to(h)], g = surface_.opposite[h];
    const auto found = pieces_.find(edge_key(a, b));
    if (found == pieces_.end()) return;
    const auto [curve, arc_at_smaller, arc_at_larger] = found->second;
    const double arc = (arc_at_smaller + arc_at_larger) / 2;
    const auto sector = [&](index_t side) {
      return normals_.add(surface_, Vector3(normals_.at(side) + normals_.at(EditableSurface::next(side))));
    };
    const std::vector<index_t> others = surface_.other_sides(h);
    const index_t left = sector(h), right = g == no_index ? left : sector(g);
    const index_t v = surface_.add_vertex(chains_.point(curve, std::fmod(arc, chains_.length(curve))));
    surface_.split_edge(h, v, left, right);
    for (const index_t o : others) {
      const index_t there = sector(o);
      surface_.split_edge(o, surface_.add_copy(v), there, there);
    }
    pieces_.erase(found);
    add_piece(curve, {std::min(a, b), arc_at_smaller}, {v, arc});
    add_piece(curve, {v, arc}, {std::max(a, b), arc_at_larger});
    added_[curve].push_back({v, arc});
    flipper_.push_star(v);
  }

  /// Puts what was added to the curves in its place.
  void merge_added() {
    const auto by_arc = [](const CurveChains::Link& x, const CurveChains::Link& y) { return x.arc < y.arc; };
    for (std::size_t c = 0; c < added_.size(); ++c) {
      if (added_[c].empty()) continue;
      auto& row = chains_.row(c);
      std::sort(added_[c].begin(), added_[c].end(), by_arc);
      const auto n = static_cast<std::ptrdiff_t>(row.size());
      row.insert(row.end(), added_[c].begin(), added_[c].end());
      std::inplace_merge(row.begin(), row.begin() + n, row.end(), by_arc);
    }
    added_.clear();
    pieces_.clear();
  }

  EditableSurface& surface_;
  SectorNormals& normals_;
  CurveChains& chains_;
  DelaunayFlipper& flipper_;
  Pulse& pulse_;
  BoxTree tree_;
  std::vector<std::array<index_t, 2>> pairs_;          // that crossed when it was looked last
  std::unordered_map<std::uint64_t, Piece> pieces_;    // by edge; looked up only, never walked over
  std::vector<std::vector<CurveChains::Link>> added_;  // by curve
};

}  // namespace framehex::detail
