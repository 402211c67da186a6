// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/geometry/predicates.hpp"
#include "framehex/mesh/adjacency.hpp"
#include "framehex/mesh/boundary.hpp"
#include "framehex/mesh/enclosed_volume.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/mesh/validation.hpp"
#include "framehex/observer.hpp"

#include <cmath>
#include <concepts>
#include <span>
#include <string>
#include <vector>

namespace framehex {

/// What a tetrahedraliser is asked for: fill a closed surface with tetrahedra that use the given points and no others.
struct TetrahedralizationRequest {
  std::span<const Vector3> points;                    ///< surface points first, then interior ones
  std::size_t n_surface_points;                       ///< how many of `points` lie on the surface
  std::span<const std::array<index_t, 3>> triangles;  ///< closed, oriented outward
  Observer observer = {};                             ///< polled; false: stop, with `Status::cancelled`
};

/// What it answers. Tetrahedra are positively oriented and in the numbering of the request; points of its own follow.
struct TetrahedralizationResult {
  std::vector<std::array<index_t, 4>> tets;
  std::vector<Vector3> extra_points;  ///< numbered from `request.points.size()` on
  Status status = Status::complete;
};

/// A callable that fills a surface. It throws `invalid_surface` when it refuses the surface (self-intersections), and
/// `tetrahedralization_error` when it fails otherwise. Nothing else is trusted: `tetrahedralize` checks the answer.
template <class T>
concept Tetrahedralizer = requires(const T& tetrahedralizer, const TetrahedralizationRequest& request) {
  { tetrahedralizer(request) } -> std::convertible_to<TetrahedralizationResult>;
};

/// Any tetrahedraliser, by reference: what takes it is compiled once for all of them. It must outlive the reference.
class TetrahedralizerRef {
public:
  template <Tetrahedralizer T>
  requires(!std::same_as<T, TetrahedralizerRef>)
      TetrahedralizerRef(const T& tetrahedralizer)  // NOLINT: whoever takes any is meant to be called with that
      : tetrahedralizer_(&tetrahedralizer),
        call_([](const void* t, const TetrahedralizationRequest& request) -> TetrahedralizationResult {
          return (*static_cast<const T*>(t))(request);
        }) {}

  TetrahedralizationResult operator()(const TetrahedralizationRequest& request) const {
    return call_(tetrahedralizer_, request);
  }

private:
  const void* tetrahedralizer_;
  TetrahedralizationResult (*call_)(const void* tetrahedralizer, const TetrahedralizationRequest& request);
};

/// A tetrahedral mesh inside a surface, checked.
struct Tetrahedralization {
  IndexedTetMesh mesh;  ///< the points of the request, unmoved and in order, then extra points
  TetAdjacency adjacency;
  std::size_t n_extra_points = 0;
  Status status = Status::complete;
};

namespace detail {

inline void check_tets(const IndexedTetMesh& mesh) {
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
    const auto& t = mesh.tets[i];
    for (const index_t v : t)
      if (v >= mesh.points.size())
        throw tetrahedralization_error(
            "tetrahedraliser: tetrahedron " + std::to_string(i) + " refers to a vertex that does not exist",
            Entity::cell, {i});
    if (orientation(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]) <= 0)
      throw tetrahedralization_error("tetrahedraliser: tetrahedron " + std::to_string(i) + " is flat or inverted",
                                     Entity::cell, {i});
  }
}

/// Rotated so that the smallest vertex comes first: equal for equal oriented triangles.
inline std::array<index_t, 3> canonical(const std::array<index_t, 3>& t) {
  const std::size_t low = static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
  return {t[low], t[(low + 1) % 3], t[(low + 2) % 3]};
}

inline void check_boundary(const IndexedTetMesh& mesh, const TetAdjacency& adjacency,
                           std::span<const std::array<index_t, 3>> wanted) {
  const BoundarySurface boundary = extract_boundary(mesh, adjacency);
  std::vector<std::array<index_t, 3>> found, expected;
  for (const auto& t : boundary.surface.triangles)
    found.push_back(canonical({boundary.vertex_of[t[0]], boundary.vertex_of[t[1]], boundary.vertex_of[t[2]]}));
  for (const auto& t : wanted) expected.push_back(canonical(t));
  std::sort(found.begin(), found.end());
  std::sort(expected.begin(), expected.end());
  if (found == expected) return;
  std::vector<std::array<index_t, 3>> missing;
  std::set_difference(expected.begin(), expected.end(), found.begin(), found.end(), std::back_inserter(missing));
  if (missing.empty())
    throw tetrahedralization_error("tetrahedraliser: the boundary has triangles that the surface has not");
  const auto& t = missing.front();
  throw tetrahedralization_error("tetrahedraliser: " + std::to_string(missing.size()) +
                                     " surface triangles were lost, the first is (" + std::to_string(t[0]) + ", " +
                                     std::to_string(t[1]) + ", " + std::to_string(t[2]) +
                                     ") of the surface's own samples; does it cross itself?",
                                 Entity::vertex, {t[0], t[1], t[2]});
}

/// Forgets points of the backend's own that no tetrahedron uses: TetGen lists those that it added and took back.
inline void forget_unused_points(IndexedTetMesh& mesh, std::size_t n_wanted) {
  std::vector<index_t> number(mesh.points.size(), no_index);
  for (const auto& t : mesh.tets)
    for (const index_t v : t) number[v] = v;
  std::size_t n = n_wanted;
  for (std::size_t v = n_wanted; v < mesh.points.size(); ++v) {
    if (number[v] == no_index) continue;
    number[v] = static_cast<index_t>(n);
    mesh.points[n++] = mesh.points[v];
  }
  if (n == mesh.points.size()) return;
  mesh.points.resize(n);
  for (auto& t : mesh.tets)
    for (index_t& v : t) v = number[v];
}

inline void check_points_used(const IndexedTetMesh& mesh) {
  std::vector<bool> used(mesh.points.size(), false);
  for (const auto& t : mesh.tets)
    for (const index_t v : t) used[v] = true;
  std::vector<std::size_t> lost;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (!used[v]) lost.push_back(v);
  if (!lost.empty())
    throw tetrahedralization_error("tetrahedraliser: point " + std::to_string(lost.front()) + " was lost" +
                                       (lost.size() > 1 ? ", and " + std::to_string(lost.size() - 1) + " more" : ""),
                                   Entity::vertex, lost);
}

}  // namespace detail

/// Fills a closed surface with tetrahedra, and trusts nobody: checks the input before and the answer after.
///
/// @param host       closed, outward; its points come first in the result.
/// @param interior   points strictly inside, none nearer than about 0.05 of the local spacing to the surface or to each
///                   other (backends split the surface, or merge points, when they are).
/// @return the mesh and its adjacency; every point is a vertex and the surface triangles are exactly the boundary. Empty when cancelled.
/// @throws what `validate_closed` throws; `invalid_surface` from the backend; `tetrahedralization_error` naming the
///         first tetrahedron, the corners of the first triangle, or all points, that break the promise.
/// @par Complexity   the backend's, and O(n log n) for the checks.
template <Tetrahedralizer T, TriangleMesh M>
Tetrahedralization tetrahedralize(const T& tetrahedralizer, const M& host, std::span<const Vector3> interior,
                                  const Observer& observer = {}) {
  validate_closed(host);
  const auto& surface = detail::flat(host);
  if (enclosed_volume(surface) <= 0)
    throw invalid_surface("the surface is inside out: its triangles must be anticlockwise seen from outside");
  Tetrahedralization result;
  result.mesh.points.assign(surface.points.begin(), surface.points.end());
  result.mesh.points.insert(result.mesh.points.end(), interior.begin(), interior.end());
  TetrahedralizationResult answer = tetrahedralizer(
      TetrahedralizationRequest{result.mesh.points, surface.points.size(), surface.triangles, observer});
  result.status = answer.status;
  if (answer.status != Status::complete) return {.mesh = {}, .adjacency = {}, .status = answer.status};
  const auto stopped = [&](double fraction) { return !keep_going(observer, "tetrahedra", fraction); };
  if (stopped(0.8)) return detail::cancelled<Tetrahedralization>();
  result.mesh.tets = std::move(answer.tets);
  result.mesh.points.insert(result.mesh.points.end(), answer.extra_points.begin(), answer.extra_points.end());

  detail::check_tets(result.mesh);
  const std::size_t n_wanted = surface.points.size() + interior.size();
  detail::forget_unused_points(result.mesh, n_wanted);
  result.n_extra_points = result.mesh.points.size() - n_wanted;
  result.adjacency = make_adjacency(result.mesh);
  if (stopped(0.9)) return detail::cancelled<Tetrahedralization>();
  detail::check_boundary(result.mesh, result.adjacency, surface.triangles);
  detail::check_points_used(result.mesh);
  double sum = 0;
  for (const auto& t : result.mesh.tets)
    sum += orientation_determinant(result.mesh.points[t[0]], result.mesh.points[t[1]], result.mesh.points[t[2]],
                                   result.mesh.points[t[3]]);
  const double expected = 6 * enclosed_volume(surface);
  if (std::abs(sum - expected) > 1e-9 * expected)
    throw tetrahedralization_error("tetrahedraliser: the tetrahedra do not add up to the volume inside the surface");
  if (stopped(1)) return detail::cancelled<Tetrahedralization>();
  return result;
}

}  // namespace framehex
