// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"
#include "framehex/surface/detail/sector_normals.hpp"

#include <limits>

namespace framehex::detail {

/// How a triangle stands: cosine of its normal with the mean normal of its corners; -1 without area.
inline double uprightness(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& reference) {
  const Vector3 ab = b - a, ac = c - a, normal = ab.cross(ac);
  const double area = normal.norm(), size = reference.norm();
  if (!(area > 1e-10 * (ab.squaredNorm() + ac.squaredNorm()))) return -1;
  return size > 0 ? normal.dot(reference) / (area * size) : 1.0;
}

/// Do the two angles opposite an edge sum to more than a straight angle? Not so on a feature or rim, nor in a tie:
/// edges of lattices stay as they are.
inline bool is_not_delaunay(const EditableSurface& surface, index_t h) {
  constexpr double tie = 1e-7;
  const index_t g = surface.opposite[h];
  if (g == no_index || surface.feature[h]) return false;
  const Vector3 &a = surface.points[surface.from(h)], &b = surface.points[surface.to(h)];
  const Vector3 &c = surface.points[surface.apex(h)], &d = surface.points[surface.apex(g)];
  const Vector3 ca = a - c, cb = b - c, da = a - d, db = b - d;
  const double cos_c = ca.dot(cb), cos_d = da.dot(db);
  if (cos_c >= 0 && cos_d >= 0) return false;
  const double sin_c = ca.cross(cb).norm(), sin_d = da.cross(db).norm();
  const double scale = std::sqrt(ca.squaredNorm() * cb.squaredNorm() * da.squaredNorm() * db.squaredNorm());
  return cos_c * sin_d + sin_c * cos_d < -tie * scale;
}

/// Makes an EditableSurface Delaunay by flips that neither cross features nor bend the surface.
class DelaunayFlipper {
public:
  enum class Scope { within_input_triangles, within_patches };

  DelaunayFlipper(EditableSurface& surface, const SectorNormals& normals, Pulse& pulse)
      : surface_(surface), normals_(normals), pulse_(pulse) {}

  void push(index_t h) { stack_.push_back(h); }
  void push_star(index_t v) {
    surface_.for_each_copy(v, [&](index_t copy) {
      surface_.for_each_outgoing(copy, [&](index_t h) {
        stack_.push_back(h);
        stack_.push_back(EditableSurface::next(h));
      });
    });
  }
  void push_all() {
    for (index_t h = 0; h < surface_.opposite.size(); ++h)
      if (surface_.alive(h / 3) && (surface_.opposite[h] == no_index || h < surface_.opposite[h])) stack_.push_back(h);
  }

  /// Flips until every pushed edge, and every edge that a flip touched, is Delaunay or must stay, or until it is told to
  /// stop.
  ///
  /// In a plane that ends by itself; on a bent surface two edges may ask for one another for ever, so that the number of
  /// flips is bounded.
  std::size_t run(Scope scope) {
    std::size_t flips = 0, budget = 64 + 20 * stack_.size();
    while (!stack_.empty() && pulse_.beat()) {
      const index_t h = stack_.back();
      stack_.pop_back();
      if (!surface_.alive(h / 3) || flips > budget || !wants_flip(h) || !may_flip(h, scope)) continue;
      const index_t g = surface_.opposite[h], t = 3 * (h / 3), s = 3 * (g / 3);
      surface_.flip(h);
      ++flips;
      stack_.insert(stack_.end(), {t, t + 2, s, s + 2});
    }
    return flips;
  }

  bool wants_flip(index_t h) const { return is_not_delaunay(surface_, h); }

  bool may_flip(index_t h, Scope scope) const {
    const index_t g = surface_.opposite[h];
    if (scope == Scope::within_input_triangles && surface_.parent[h / 3] != surface_.parent[g / 3]) return false;
    const index_t next = EditableSurface::next(h), previous = EditableSurface::previous(h),
                  far = EditableSurface::previous(g);
    const Vector3 &a = surface_.points[surface_.from(h)], &b = surface_.points[surface_.to(h)];
    const Vector3 &c = surface_.points[surface_.apex(h)], &d = surface_.points[surface_.apex(g)];
    double after, before;
    if (scope == Scope::within_input_triangles) {
      const Vector3& n = normals_.of_triangle(surface_.parent[h / 3]);
      after = std::min(uprightness(a, d, c, n), uprightness(b, c, d, n));
      before = 1;
    } else {
      const Vector3 cd = normals_.at(previous) + normals_.at(far), ab = normals_.at(h) + normals_.at(next);
      after = std::min(uprightness(a, d, c, normals_.at(h) + cd), uprightness(b, c, d, normals_.at(next) + cd));
      before = std::min(uprightness(a, b, c, ab + normals_.at(previous)), uprightness(b, a, d, ab + normals_.at(far)));
    }
    return after >= std::min(upright, before) && after > 0 && !surface_.joined(surface_.apex(h), surface_.apex(g));
  }

private:
  static constexpr double upright = 0.8;  ///< cosine above which a flip may also make matters worse

  EditableSurface& surface_;
  const SectorNormals& normals_;
  Pulse& pulse_;
  std::vector<index_t> stack_;
};

}  // namespace framehex::detail
