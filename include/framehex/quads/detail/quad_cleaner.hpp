// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"
#include "framehex/quads/detail/quad_smoother.hpp"

#include <map>
#include <numbers>
#include <tuple>
#include <utility>

namespace framehex::detail {

/// Changes the connectivity of quadrilaterals so that more vertices have as many as fit round them.
///
/// Every change is tried: the vertices about it are smoothed, and unless the worst cell there stays good enough all is
/// taken back.
class QuadCleaner {
public:
  QuadCleaner(EditableQuads& quads, QuadSmoother& smoother) : quads_(quads), smoother_(smoother) { set_targets(); }

  std::size_t n_changes() const { return n_changes_; }
  std::size_t n_tried() const { return n_tried_; }  ///< changes, those that were taken back with them

  /// Vertices about the changes since the last call, some more than once.
  std::vector<index_t> take_changed() { return std::exchange(changed_, {}); }

  /// Joins the two quadrilaterals of each vertex inside that has no more.
  void remove_doublets() {
    for (bool again = true; std::exchange(again, false);)
      for (index_t v = 0; v < quads_.points.size(); ++v)
        while (is_doublet(v)) {
          const index_t a = quads_.to(quads_.half_edge_of[v]);
          quads_.remove_doublet(v);
          ++n_changes_;
          v = a;
          again = true;
        }
  }

  /// Tries changes that make the vertices about them more regular. @return false when the observer has cancelled.
  bool reduce_irregular(const Observer& observer) {
    std::size_t n_looked_at = 0;
    failed_at_.clear();
    for (index_t v = 0; v < quads_.points.size(); ++v)
      for (int i = 0; i < most_changes && penalty(v) > 0; ++i) {
        if (n_looked_at++ % 64 == 0 && !keep_going(observer, "improvement", 0)) return false;
        if (!change_about(v, Purpose::regularity)) break;
      }
    return true;
  }

  /// Tries changes about cells that are bad, even some that make vertices less regular.
  bool mend(double bad, const Observer& observer) {
    failed_at_.clear();  // smoothing has moved all of it
    // Where a surface is folded or flat, cells that are put in may be as bad as those about them, without end.
    const std::size_t most_cells = quads_.corners.size() + quads_.corners.size() / 8 + 20;
    // Nor is a mesh of bad cells throughout worth more than so many attempts, however poor the input makes them.
    const std::size_t most_tried = n_tried_ + tried_at_least + tried_a_cell * quads_.corners.size();
    for (index_t q = 0; q < std::min(quads_.corners.size(), most_cells) && n_tried_ < most_tried; ++q)
      for (int i = 0; i < most_changes && quads_.alive(q) && smoother_.free_quality(q) < bad; ++i) {
        if (!keep_going(observer, "improvement", 0)) return false;
        const auto corners = quads_.corners[q];
        bool changed = false;
        for (index_t k = 0; k < quads_.size(q) && !changed; ++k)
          if (quads_.half_edge_of[corners[k]] != no_index) changed = change_about(corners[k], Purpose::quality);
        if (!changed) break;
      }
    return true;
  }

private:
  enum class Purpose { regularity, quality };
  enum class Operation { rotate, rotate_back, collapse, split, insert_at_end, insert_at_start, pillow };

  struct Candidate {
    double gain;
    Operation operation;
    index_t h, k;
  };

  using Change = std::tuple<Operation, index_t, index_t>;

  static constexpr int most_changes = 4;      ///< about one vertex or cell in a round
  static constexpr double pillow_gain = -10;  ///< five cells in place of one: the last resort
  static constexpr double least_gain = 0.02;  ///< of quality, for a change that mends
  static constexpr std::size_t tried_at_least = 2000, tried_a_cell = 20;
  static constexpr double at_rest = 1e-3;  ///< mean edges
  static constexpr double good = 0.45;     ///< a change may make the worst cell about it this bad

  /// Right angles that fit between the curves or rims of a fan.
  void set_targets() {
    for (index_t v = 0; v < quads_.points.size(); ++v) {
      const index_t h = quads_.half_edge_of[v];
      if (h != no_index && quads_.is_tip(v)) quads_.target[v] = cells_round_tip(v);
      if (h == no_index || quads_.opposite[h] != no_index) continue;
      index_t last = h;
      quads_.for_each_outgoing(v, [&](index_t o) { last = o; });
      const Vector3& p = quads_.points[v];
      const Vector3& n = quads_.normals[v];
      const Vector3 x = quads_.points[quads_.to(h)] - p, y = quads_.points[quads_.from(quads_.previous(last))] - p;
      double angle = std::atan2(x.cross(y).dot(n), x.dot(y) - x.dot(n) * y.dot(n));
      if (angle <= 1e-3) angle += 2 * std::numbers::pi;
      quads_.target[v] = static_cast<index_t>(std::max(1L, std::lround(angle / (std::numbers::pi / 2))));
    }
  }

  index_t cells_round_tip(index_t v) const {
    double angle = 0;
    quads_.for_each_outgoing(v, [&](index_t h) {
      const Vector3& p = quads_.points[v];
      const Vector3 x = quads_.points[quads_.to(h)] - p, y = quads_.points[quads_.from(quads_.previous(h))] - p;
      angle += std::atan2(x.cross(y).norm(), x.dot(y));
    });
    return static_cast<index_t>(std::max(3L, std::lround(angle / (std::numbers::pi / 2))));
  }

  bool is_doublet(index_t v) const {
    if (quads_.half_edge_of[v] == no_index || !quads_.is_inside(v) || quads_.n_cells[v] != 2) return false;
    const index_t h = quads_.half_edge_of[v], g = quads_.opposite[quads_.previous(h)];
    return g != no_index && quads_.is_quad(h / 4) && quads_.is_quad(g / 4) && h / 4 != g / 4 &&
           quads_.name[quads_.to(quads_.next(h))] != quads_.name[quads_.to(quads_.next(g))];
  }

  double penalty(index_t v, int change = 0) const {
    if (quads_.half_edge_of[v] == no_index) return 0;
    return penalty_of(v, static_cast<int>(quads_.n_cells[v]) + change);
  }
  double penalty_of(index_t v, int n) const {
    const double excess = n - static_cast<int>(quads_.target[v]);
    const bool flat = excess < 0 && !quads_.is_inside(v);  // a corner of a cell that is open too wide
    return excess * excess * (flat ? 3 : 1);
  }

  bool change_about(index_t v, Purpose purpose) {
    candidates_.clear();
    quads_.for_each_outgoing(v, [&](index_t h) {
      if (!quads_.is_quad(h / 4)) return;
      for (index_t side = 4 * (h / 4); side < 4 * (h / 4) + 4; ++side) {
        add_rotation(side);
        add_collapse(side);
        if (purpose == Purpose::quality) add_insertions(side);
      }
      if (purpose == Purpose::quality) candidates_.push_back({pillow_gain, Operation::pillow, h, no_index});
    });
    add_splits(v);
    const double least = purpose == Purpose::regularity ? 0.5 : pillow_gain;
    std::erase_if(candidates_, [&](const Candidate& c) { return c.gain < least; });
    std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& x, const Candidate& y) {
      return std::tuple(-x.gain, x.operation, x.h, x.k) < std::tuple(-y.gain, y.operation, y.h, y.k);
    });
    for (const Candidate& candidate : candidates_) {
      const auto [failed, is_new] = failed_at_.try_emplace(change_of(candidate), 0);
      if (!is_new && failed->second >= changed_at(candidate)) continue;
      if (attempt(candidate, purpose)) {
        date_change();
        return true;
      }
      failed->second = n_changes_;
    }
    return false;
  }

  void date_change() {
    ++n_changes_;
    changed_at_.resize(quads_.points.size(), 0);
    for (const index_t v : region_) changed_at_[v] = n_changes_;
  }

  /// The number of the last change that moved a vertex of the cells that a candidate changes.
  std::size_t changed_at(const Candidate& candidate) {
    changed_at_.resize(quads_.points.size(), 0);
    std::size_t last = 0;
    const index_t g = quads_.opposite[candidate.h];
    for (const index_t cell : {candidate.h / 4, g == no_index ? candidate.h / 4 : g / 4})
      for (index_t i = 0; i < quads_.size(cell); ++i) last = std::max(last, changed_at_[quads_.corners[cell][i]]);
    return last;
  }

  /// The same for both half edges of an edge, from which most changes can be seen.
  Change change_of(const Candidate& candidate) const {
    Operation operation = candidate.operation;
    index_t h = candidate.h;
    const index_t g = quads_.opposite[h];
    if (operation == Operation::pillow) {
      h = 4 * (h / 4);
    } else if (operation != Operation::collapse && operation != Operation::split && g < h) {
      if (operation == Operation::insert_at_end)
        operation = Operation::insert_at_start;
      else if (operation == Operation::insert_at_start)
        operation = Operation::insert_at_end;
      h = g;
    }
    return {operation, h, candidate.k};
  }

  bool inside_and_thin(index_t v, index_t least) const {
    return quads_.n_cells[v] < (quads_.is_inside(v) || quads_.is_tip(v) ? least : 2);
  }

  /// Does a half edge lie between two quadrilaterals that have six different corners?
  bool in_hexagon(index_t h) const {
    const index_t g = quads_.opposite[h];
    if (g == no_index || !quads_.is_quad(g / 4) || !quads_.is_quad(h / 4) || g / 4 == h / 4) return false;
    const auto &x = quads_.corners[h / 4], &y = quads_.corners[g / 4];
    int n_shared = 0;
    for (const index_t v : x)
      for (const index_t w : y) n_shared += quads_.name[v] == quads_.name[w];
    return n_shared == 2;
  }

  void add_rotation(index_t h) {
    const index_t g = quads_.opposite[h];
    if (!in_hexagon(h)) return;
    const index_t a = quads_.from(h), b = quads_.to(h);
    if (inside_and_thin(a, 4) || inside_and_thin(b, 4)) return;
    const double ends = penalty(a) + penalty(b) - penalty(a, -1) - penalty(b, -1);
    const auto add = [&](index_t x, index_t y, Operation operation) {
      if (!quads_.joined(x, y))
        candidates_.push_back({ends + penalty(x) + penalty(y) - penalty(x, 1) - penalty(y, 1), operation, h, no_index});
    };
    add(quads_.to(quads_.next(h)), quads_.to(quads_.next(g)), Operation::rotate);
    add(quads_.from(quads_.previous(h)), quads_.from(quads_.previous(g)), Operation::rotate_back);
  }

  void add_insertions(index_t h) {
    const index_t g = quads_.opposite[h];
    if (!in_hexagon(h)) return;
    const index_t a = quads_.from(h), b = quads_.to(h);
    const auto add = [&](index_t loses, index_t x, index_t y, Operation operation) {
      if (inside_and_thin(loses, 4)) return;
      const double gain = penalty(loses) + penalty(x) + penalty(y) - penalty(loses, -1) - penalty(x, 1) - penalty(y, 1);
      candidates_.push_back({gain - 1, operation, h, no_index});
    };
    add(a, quads_.from(quads_.previous(h)), quads_.to(quads_.next(g)), Operation::insert_at_end);
    add(b, quads_.to(quads_.next(h)), quads_.from(quads_.previous(g)), Operation::insert_at_start);
  }

  void add_collapse(index_t h) {
    const index_t p = quads_.from(h), b = quads_.to(h), r = quads_.to(quads_.next(h)),
                  d = quads_.from(quads_.previous(h));
    if (!quads_.is_inside(p) || inside_and_thin(b, 4) || inside_and_thin(d, 4)) return;
    if (quads_.joined(p, r) || n_common_neighbours(p, r) != 2) return;
    const double gain = penalty(p) + penalty(b) + penalty(d) + penalty(r) - penalty(b, -1) - penalty(d, -1) -
                        penalty(r, static_cast<int>(quads_.n_cells[p]) - 2);
    candidates_.push_back({gain, Operation::collapse, h, no_index});
  }

  std::size_t n_common_neighbours(index_t p, index_t r) const {
    std::vector<index_t> of_p, of_r, common;
    quads_.for_each_neighbour(p, [&](index_t w) { of_p.push_back(quads_.name[w]); });
    quads_.for_each_copy(
        r, [&](index_t copy) { quads_.for_each_neighbour(copy, [&](index_t w) { of_r.push_back(quads_.name[w]); }); });
    std::sort(of_p.begin(), of_p.end());
    std::sort(of_r.begin(), of_r.end());
    of_r.erase(std::unique(of_r.begin(), of_r.end()), of_r.end());
    std::set_intersection(of_p.begin(), of_p.end(), of_r.begin(), of_r.end(), std::back_inserter(common));
    return common.size();
  }

  void add_splits(index_t v) {
    fan_.clear();
    quads_.for_each_outgoing(v, [&](index_t h) { fan_.push_back(h); });
    const auto n = static_cast<int>(fan_.size());
    const bool inside = quads_.is_inside(v);
    if (n < (inside ? 4 : 3)) return;
    for (int i = 0; i < n; ++i)
      for (int taken = 2; taken <= n - (inside ? 2 : 1); ++taken) {
        if (!inside && i + taken >= n) break;
        const index_t h = fan_[static_cast<std::size_t>(i)], k = fan_[static_cast<std::size_t>((i + taken) % n)];
        if (quads_.opposite[h] == no_index || quads_.opposite[k] == no_index) continue;
        const index_t p = quads_.to(h), r = quads_.to(k);
        const double excess = taken + 1 - 4;
        const double gain = penalty(v) + penalty(p) + penalty(r) - penalty_of(v, n - taken + 1) - excess * excess -
                            penalty(p, 1) - penalty(r, 1);
        candidates_.push_back({gain, Operation::split, h, k});
      }
  }

  bool attempt(const Candidate& candidate, Purpose purpose) {
    gather_region(candidate);
    const double before = least_quality(), deficit_before = deficit();
    quads_.mark();
    apply(candidate);
    ++n_tried_;
    for (int sweep = 0; sweep < 5; ++sweep) {
      double moved = 0;
      for (const index_t v : region_) moved = std::max(moved, smoother_.relax(v));
      if (moved < at_rest) break;
    }
    const double after = least_quality();
    const bool better = purpose == Purpose::regularity
                            ? after >= std::min(before, good)
                            : after >= before - 1e-3 && deficit() < deficit_before - least_gain;
    const bool accepted = better && (!smoother_.keeps_sound() || all_sound());
    if (accepted) {
      quads_.keep();
      changed_.insert(changed_.end(), region_.begin(), region_.end());
    } else {
      quads_.take_back();
    }
    return accepted;
  }

  /// The corners of the cells about a change.
  void gather_region(const Candidate& candidate) {
    region_.clear();
    const auto add_cells_round = [&](index_t v) {
      quads_.for_each_corner_about(v, [&](index_t corner) { region_.push_back(corner); });
    };
    for (const index_t cell : {candidate.h / 4, quads_.opposite[candidate.h] / 4})
      if (cell < quads_.corners.size())
        for (index_t i = 0; i < quads_.size(cell); ++i) add_cells_round(quads_.corners[cell][i]);
    if (candidate.k != no_index) add_cells_round(quads_.to(candidate.k));
    std::sort(region_.begin(), region_.end());
    region_.erase(std::unique(region_.begin(), region_.end()), region_.end());
  }

  void apply(const Candidate& candidate) {
    const auto n = static_cast<index_t>(quads_.points.size());
    const index_t h = candidate.h;
    switch (candidate.operation) {
      case Operation::rotate: quads_.rotate(h); break;
      case Operation::rotate_back: quads_.rotate(quads_.rotate(h)); break;
      case Operation::collapse: quads_.collapse(h); break;
      case Operation::split: quads_.split(h, candidate.k); break;
      case Operation::insert_at_end: quads_.insert(h, EditableQuads::Corners::with_end); break;
      case Operation::insert_at_start: quads_.insert(h, EditableQuads::Corners::with_start); break;
      case Operation::pillow: quads_.pillow(h / 4); break;
    }
    for (index_t v = n; v < quads_.points.size(); ++v) {
      smoother_.place(v, mean_of_neighbours(v));
      region_.push_back(v);
    }
  }

  Vector3 mean_of_neighbours(index_t v) const {
    Vector3 sum = Vector3::Zero();
    double n = 0;
    quads_.for_each_outgoing(v, [&](index_t h) {
      sum += quads_.points[quads_.to(h)];
      ++n;
    });
    return sum / n;
  }

  /// How much is missing to good cells about the vertices of the region.
  double deficit() const {
    double sum = 0;
    for (const index_t v : region_)
      if (quads_.half_edge_of[v] != no_index) sum += std::max(0.0, good - smoother_.least_quality(v));
    return sum;
  }

  bool all_sound() const {
    return std::all_of(region_.begin(), region_.end(),
                       [&](index_t v) { return quads_.half_edge_of[v] == no_index || smoother_.all_sound(v); });
  }

  double least_quality() const {
    double least = 1;
    for (const index_t v : region_)
      if (quads_.half_edge_of[v] != no_index) least = std::min(least, smoother_.least_quality(v));
    return least;
  }

  EditableQuads& quads_;
  QuadSmoother& smoother_;
  std::size_t n_changes_ = 0, n_tried_ = 0;
  std::vector<Candidate> candidates_;
  std::vector<std::size_t> changed_at_;      ///< by copy: after how many changes in all it was last moved by one
  std::map<Change, std::size_t> failed_at_;  ///< how many changes there were when it was last tried in vain
  std::vector<index_t> region_, fan_, changed_;
};

}  // namespace framehex::detail
