// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/io/obj_reader.hpp"
#include "framehex/mesh/mixed_mesh.hpp"
#include "framehex/mesh/validation.hpp"
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

  index_t vertex(double x, double y, double z = 0) {
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z))
      throw invalid_coordinate(
          name_ + ": vertex " + std::to_string(outline_.points.size()) + " has a coordinate that is not finite",
          Entity::vertex, {outline_.points.size()});
    const auto [at, is_new] = known_.try_emplace({x, y}, static_cast<index_t>(outline_.points.size()));
    if (is_new) outline_.points.emplace_back(x, y);
    heights_.push_back({at->second, z});
    return at->second;
  }

  void add(Kind kind, std::span<const index_t> vertices) {
    Csr<index_t>& rows = kind == Kind::loop ? outline_.loops : outline_.inner;
    rows.values.insert(rows.values.end(), vertices.begin(), vertices.end());
    rows.end_row();
  }

  PlanarOutline finish() {
    check_heights();
    return std::move(outline_);
  }

private:
  static constexpr double flat = 1e-10;  // of the outline's extent: what rounding leaves

  void check_heights() {
    if (heights_.empty()) return;
    outline_.z = heights_[0].second;
    Eigen::AlignedBox2d box;
    for (const Vector2& p : outline_.points) box.extend(p);
    const double tolerance = flat * box.sizes().maxCoeff();
    for (const auto& [vertex, z] : heights_)
      if (!(std::abs(z - outline_.z) <= tolerance))
        throw invalid_coordinate(name_ + ": vertex " + std::to_string(vertex) + " has z = " + number_text(z) +
                                     ", the first one " + number_text(outline_.z) +
                                     ": an outline lies in one plane, z = const",
                                 Entity::vertex, {vertex});
  }

  std::string name_;
  std::vector<std::pair<index_t, double>> heights_;  // of the points as they come
  std::map<std::array<double, 2>, index_t> known_;
  PlanarOutline outline_;
};

/// Reads polylines block by block.
class TextOutline {
public:
  TextOutline(const std::string& name, std::string_view bytes) : builder_(name), in_(name, bytes), bytes_(bytes) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (bytes.starts_with(byte_order_mark)) in_.move_to(byte_order_mark.size());
  }

  PlanarOutline run() {
    while (in_.remaining() > 0) {
      begin_ = in_.position();
      const std::string_view whole = in_.line(), line = trimmed(whole.substr(0, whole.find('#')));
      if (line.empty()) {
        if (trimmed(whole).empty() && !points_.empty()) end_block();
      } else if (same_word(line, "inner") && line.size() == 5) {
        if (kind_ == OutlineBuilder::Kind::inner && points_.empty()) fail_without_points();
        end_block();
        kind_ = OutlineBuilder::Kind::inner;
        inner_ = begin_;
      } else {
        add_point(line);
      }
    }
    if (kind_ == OutlineBuilder::Kind::inner && points_.empty()) fail_without_points();
    end_block();
    return builder_.finish();
  }

private:
  [[noreturn]] void fail_without_points() {
    in_.move_to(inner_);
    in_.fail("no point follows \"inner\"");
  }

  void add_point(std::string_view line) {
    Cursor words("", line);
    words.word();
    const bool has_second = !words.word().empty();
    // Up to the comment, with all lines before it for the error.
    Cursor point(in_.name(), bytes_.substr(0, static_cast<std::size_t>(line.data() - bytes_.data()) + line.size()));
    point.move_to(begin_);
    if (!has_second || !words.at_end())
      point.fail("a point is two numbers, x and y, where \"" + Cursor::printable(line) + "\" stands");
    const auto x = point.number<double>("a coordinate"), y = point.number<double>("a coordinate");
    points_.push_back(builder_.vertex(x, y));
  }

  void end_block() {
    if (!points_.empty()) {
      if (kind_ == OutlineBuilder::Kind::loop && points_.front() != points_.back()) points_.push_back(points_.front());
      builder_.add(kind_, points_);
    }
    points_.clear();
    kind_ = OutlineBuilder::Kind::loop;
  }

  OutlineBuilder builder_;
  Cursor in_;
  std::string_view bytes_;
  std::vector<index_t> points_;  // of the polyline that is being read
  OutlineBuilder::Kind kind_ = OutlineBuilder::Kind::loop;
  std::size_t begin_ = 0, inner_ = 0;  // where the line stands, and the last `inner`
};

inline PlanarOutline read_text_outline(const std::string& name, std::string_view bytes) {
  return TextOutline(name, bytes).run();
}

inline PlanarOutline read_obj_outline(const std::string& name, std::string_view bytes) {
  OutlineBuilder builder(name);
  Cursor in(name, bytes);
  std::vector<Vector3> points;
  std::vector<index_t> line;
  while (!in.at_end()) {
    const std::string_view keyword = in.word();
    if (keyword == "v") {
      const auto x = in.number<double>("a coordinate"), y = in.number<double>("a coordinate");
      Cursor rest = in.rest_of_line();
      points.emplace_back(x, y, rest.at_end() ? 0.0 : rest.number<double>("a coordinate"));
      continue;
    } else if (keyword == "l") {
      line.clear();
      for (Cursor corners = in.rest_of_line(); !corners.at_end();) {
        const std::string_view word = corners.word();
        const std::int64_t at = obj_vertex(corners, word, points.size());
        if (at < 0 || at >= static_cast<std::int64_t>(points.size()))
          corners.fail("there is no point " + std::string(word));
        const auto& p = points[static_cast<std::size_t>(at)];
        line.push_back(builder.vertex(p.x(), p.y(), p.z()));
      }
      builder.add(OutlineBuilder::Kind::loop, line);
      continue;
    }
    in.line();
  }
  return builder.finish();
}

}  // namespace detail

/// The labelled edges of a mesh as an outline, each a polyline of its own.
///
/// @param name  of the file, for the error.
/// @throws io_error  when there are none; invalid_coordinate for one that is not finite, and for a vertex that is not
///         in the plane z = const of the first.
inline PlanarOutline outline_of_edges(const std::string& name, const MixedMesh& mesh) {
  if (mesh.edges.empty()) throw io_error(name + ": holds no line");
  detail::OutlineBuilder builder(name);
  for (const LabelledEdge& edge : mesh.edges) {
    const Vector3 &a = mesh.points[edge.vertices[0]], &b = mesh.points[edge.vertices[1]];
    const std::array<index_t, 2> ends{builder.vertex(a.x(), a.y(), a.z()), builder.vertex(b.x(), b.y(), b.z())};
    builder.add(detail::OutlineBuilder::Kind::loop, ends);
  }
  return builder.finish();
}

/// Reads an outline from the lines (`l`) of an .obj file, or from text: a point `x y` a line, an empty line between
/// loops, which are closed if they are not, and a line `inner` before an inner polyline. `#` starts a comment; a line
/// that is a comment ends no loop.
///
/// Points in one place are one vertex.
///
/// @throws io_error  naming file and line; invalid_coordinate as `outline_of_edges`.
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
