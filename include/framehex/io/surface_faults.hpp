// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/triangle_soup.hpp"
#include "framehex/mesh/validation.hpp"
#include "framehex/surface/self_intersection.hpp"

namespace framehex {

namespace detail {

/// Faults of a surface in the words and numbers of its file: how many there are, and where the first five are.
class FaultReport {
public:
  explicit FaultReport(const SoupSurface& soup) : soup_(soup) {}

  std::string polygon(index_t triangle) const {
    return "polygon " + std::to_string(soup_.polygons.empty() ? triangle : soup_.polygons[triangle]);
  }

  static std::string place(const Vector3& p) {
    char text[96];
    std::snprintf(text, sizeof text, "(%.9g, %.9g, %.9g)", p.x(), p.y(), p.z());
    return text;
  }

  std::string edge(index_t a, index_t b) const {
    return place(soup_.surface.points[a]) + " to " + place(soup_.surface.points[b]);
  }

  void add(const std::string& where) {
    if (n_++ < 5) text_ += (text_.empty() ? "" : "; ") + where;
  }

  std::size_t n() const { return n_; }
  /// "WHAT: place; place; place; and 7 more"
  std::string text(const std::string& what) const {
    return what + ": " + text_ + (n_ > 5 ? "; and " + std::to_string(n_ - 5) + " more" : "");
  }

private:
  const SoupSurface& soup_;
  std::size_t n_ = 0;
  std::string text_;
};

inline std::string counted(std::size_t n, const std::string& one, const std::string& many) {
  return n == 1 ? one : std::to_string(n) + " " + many;
}

inline void check_repeated(const SoupSurface& soup) {
  const auto& triangles = soup.surface.triangles;
  std::vector<std::array<index_t, 4>> keys;
  for (index_t t = 0; t < triangles.size(); ++t) {
    const auto v = sorted(triangles[t]);
    keys.push_back({v[0], v[1], v[2], t});
  }
  std::sort(keys.begin(), keys.end());
  FaultReport report(soup);
  std::size_t first = 0, found = 0;
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (!std::equal(keys[i].begin(), keys[i].begin() + 3, keys[first].begin())) {
      first = i;
      continue;
    }
    if (report.n() == 0) found = i;
    report.add(report.polygon(keys[i][3]) + " is " + report.polygon(keys[first][3]) + " again, at " +
               FaultReport::place(soup.surface.points[keys[i][0]]));
  }
  if (report.n() > 0)
    throw nonmanifold(report.text(counted(report.n(), "a triangle stands twice", "triangles stand more than once")),
                      Entity::triangle, {keys[found][3]});
}

/// Whether edges may have more than two triangles.
enum class SharedEdges { refused, taken };

inline void check_edges(const SoupSurface& soup, SharedEdges shared = SharedEdges::refused) {
  const EdgeUses edges(soup.surface);
  FaultReport open(soup), crowded(soup);
  std::array<index_t, 2> first_open{}, first_crowded{};
  edges.for_each_edge([&](std::size_t i, std::size_t j) {
    const auto& use = edges.uses[i];
    if (j - i == 2 || (j - i > 2 && shared == SharedEdges::taken)) return;
    FaultReport& report = j - i == 1 ? open : crowded;
    if (report.n() == 0) (j - i == 1 ? first_open : first_crowded) = {use.low, use.high};
    std::string who;
    for (std::size_t k = i; k < j && k < i + 4; ++k)
      who += (k == i ? "" : ", ") + report.polygon(edges.uses[k].half_edge / 3);
    report.add(who + (j - i > 4 ? "..." : "") + " from " + report.edge(use.low, use.high));
  });
  if (open.n() > 0)
    throw open_surface(open.text("the surface is open along " + counted(open.n(), "an edge", "edges")), Entity::edge,
                       {first_open[0], first_open[1]});
  if (crowded.n() > 0)
    throw nonmanifold(crowded.text(counted(crowded.n(), "an edge has", "edges have") +
                                   " more than two triangles (bodies that touch, or a wall within one)"),
                      Entity::edge, {first_crowded[0], first_crowded[1]});
}

/// @pre every edge has two triangles.
inline void check_vertices(const SoupSurface& soup) {
  const TriangleAdjacency adjacency = make_adjacency(soup.surface);
  FaultReport report(soup);
  index_t first = no_index;
  for (index_t v = 0; v < adjacency.n_vertices(); ++v) {
    if (is_fan(adjacency, v)) continue;
    if (report.n() == 0) first = v;
    report.add(report.polygon(adjacency.triangles_of_vertex[v][0]) + " and others at " +
               FaultReport::place(soup.surface.points[v]));
  }
  if (report.n() > 0)
    throw nonmanifold(report.text("the surface touches itself at " + counted(report.n(), "a vertex", "vertices")),
                      Entity::vertex, {first});
}

}  // namespace detail

/// `validate_closed`, with all faults of a kind at once, in the numbers of the file: repeated triangles, open edges,
/// edges of more than two triangles, vertices at which the surface touches itself.
///
/// @throws invalid_coordinate, nonmanifold, open_surface: the message counts the faults and names up to five by the
///         polygons of the file and coordinates; the indices are those of the first in `soup.surface`.
/// @par Complexity   O(n log n).
inline void check_closed(const SoupSurface& soup) {
  detail::check_coordinates(soup.surface);
  detail::check_repeated(soup);
  detail::check_edges(soup);
  detail::check_vertices(soup);
  validate_closed(soup.surface);
}

/// The same for the complex that several bodies make (`merge_walls`): edges may have more than two triangles, and bodies
/// touch in edges and vertices.
///
/// @throws invalid_coordinate, nonmanifold (triangles that stand twice), open_surface.
inline void check_complex(const SoupSurface& soup) {
  detail::check_coordinates(soup.surface);
  detail::check_repeated(soup);
  detail::check_edges(soup, detail::SharedEdges::taken);
}

/// Checks that no two triangles of a closed surface cross or touch but where they share vertices.
///
/// @throws invalid_surface: the message counts the pairs and names up to five; it speaks of overlapping bodies where all
///         pairs are of two parts of the surface.
/// @pre   `check_closed` passes.
/// @par Complexity   O(n log n) for triangles that are not all in one place.
inline void check_crossings(const SoupSurface& soup) {
  constexpr std::size_t most = 100'000;
  const auto pairs = find_self_intersections(soup.surface, most);
  if (pairs.empty()) return;
  const detail::SurfaceParts parts(soup.surface);
  detail::FaultReport report(soup);
  bool overlap = true;
  for (const auto& [s, t] : pairs) {
    overlap = overlap && parts.part[s] != parts.part[t];
    report.add(report.polygon(s) + " and " + report.polygon(t) + " near " +
               detail::FaultReport::place(soup.surface.points[soup.surface.triangles[t][0]]));
  }
  const std::string n = pairs.size() == most ? "at least " + std::to_string(most) : std::to_string(pairs.size());
  throw invalid_surface(
      report.text((overlap ? "overlapping or touching bodies: " : "the surface crosses or touches itself: ") + n +
                  (pairs.size() == 1 ? " pair" : " pairs") + " of triangles meet"),
      Entity::triangle, {pairs[0][0], pairs[0][1]});
}

}  // namespace framehex
