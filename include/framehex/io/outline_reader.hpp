// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/mesh/mixed_mesh.hpp"
#include "framehex/surface/planar_outline.hpp"

#include <cmath>
#include <map>

namespace framehex {

namespace detail {

/// Gathers polylines of which points in one place are one vertex.
class OutlineBuilder {
public:
  enum class Kind { loop, inner };

  explicit OutlineBuilder(std::string name) : name_(std::move(name)) {}

  index_t vertex(double x, double y) {
    if (!std::isfinite(x) || !std::isfinite(y))
      throw invalid_coordinate(
          name_ + ": vertex " + std::to_string(outline_.points.size()) + " has a coordinate that is not finite",
          Entity::vertex, {outline_.points.size()});
    const auto [at, is_new] = known_.try_emplace({x, y}, static_cast<index_t>(outline_.points.size()));
    if (is_new) outline_.points.emplace_back(x, y);
    return at->second;
  }

  void add(Kind kind, std::span<const index_t> vertices) {
    Csr<index_t>& rows = kind == Kind::loop ? outline_.loops : outline_.inner;
    rows.values.insert(rows.values.end(), vertices.begin(), vertices.end());
    rows.end_row();
  }

  PlanarOutline finish() { return std::move(outline_); }

private:
  std::string name_;
  std::map<std::array<double, 2>, index_t> known_;
  PlanarOutline outline_;
};

inline PlanarOutline read_text_outline(const std::string& name, std::string_view bytes) {
  OutlineBuilder builder(name);
  Cursor in(name, bytes);
  std::vector<index_t> points;
  auto kind = OutlineBuilder::Kind::loop;
  const auto end_block = [&] {
    if (!points.empty()) {
      if (kind == OutlineBuilder::Kind::loop && points.front() != points.back()) points.push_back(points.front());
      builder.add(kind, points);
    }
    points.clear();
    kind = OutlineBuilder::Kind::loop;
  };
  while (in.remaining() > 0) {
    const std::size_t begin = in.position();
    std::string_view line = in.line();
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty()) {
      end_block();
    } else if (same_word(line, "inner") && line.size() == 5) {
      end_block();
      kind = OutlineBuilder::Kind::inner;
    } else {
      in.move_to(begin);
      const auto x = in.number<double>("a coordinate"), y = in.number<double>("a coordinate");
      points.push_back(builder.vertex(x, y));
      in.line();
    }
  }
  end_block();
  return builder.finish();
}

inline PlanarOutline read_obj_outline(const std::string& name, std::string_view bytes) {
  OutlineBuilder builder(name);
  Cursor in(name, bytes);
  std::vector<std::array<double, 2>> points;
  std::vector<index_t> line;
  while (!in.at_end()) {
    const std::string_view keyword = in.word();
    if (keyword == "v") {
      const auto x = in.number<double>("a coordinate"), y = in.number<double>("a coordinate");
      points.push_back({x, y});
    } else if (keyword == "l") {
      line.clear();
      Cursor corners(name, in.line());
      while (!corners.at_end()) {
        const std::string_view word = corners.word();
        Cursor number(name, word.substr(0, word.find('/')));
        const auto given = number.number<std::int64_t>("the number of a point");
        const auto n = static_cast<std::int64_t>(points.size());
        const std::int64_t at = given < 0 ? n + given : given - 1;
        if (at < 0 || at >= n) in.fail("there is no point " + std::to_string(given));
        const auto& p = points[static_cast<std::size_t>(at)];
        line.push_back(builder.vertex(p[0], p[1]));
      }
      builder.add(OutlineBuilder::Kind::loop, line);
      continue;
    }
    in.line();
  }
  return builder.finish();
}

}  // namespace detail

/// The labelled edges of a mesh as an outline, each a polyline of its own; z is not looked at.
///
/// @param name  of the file, for the error.
/// @throws io_error  when there are none; invalid_coordinate for one that is not finite.
inline PlanarOutline outline_of_edges(const std::string& name, const MixedMesh& mesh) {
  if (mesh.edges.empty()) throw io_error(name + ": holds no line");
  detail::OutlineBuilder builder(name);
  for (const LabelledEdge& edge : mesh.edges) {
    const Vector3 &a = mesh.points[edge.vertices[0]], &b = mesh.points[edge.vertices[1]];
    const std::array<index_t, 2> ends{builder.vertex(a.x(), a.y()), builder.vertex(b.x(), b.y())};
    builder.add(detail::OutlineBuilder::Kind::loop, ends);
  }
  return builder.finish();
}

/// Reads an outline from the lines (`l`) of an .obj file, or from text: a point `x y` a line, an empty line between
/// loops, which are closed if they are not, and a line `inner` before an inner polyline. `#` starts a comment.
///
/// Points in one place are one vertex.
///
/// @throws io_error  naming file and line.
/// @par Complexity   O(n log n).
inline PlanarOutline read_outline(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  PlanarOutline outline = detail::lower_text(path.extension().string()) == ".obj"
                              ? detail::read_obj_outline(path.string(), bytes)
                              : detail::read_text_outline(path.string(), bytes);
  if (outline.n_polylines() == 0) throw io_error(path.string() + ": holds no line");
  return outline;
}

}  // namespace framehex
