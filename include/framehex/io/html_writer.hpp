// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/bounding_box.hpp"
#include "framehex/geometry/quality.hpp"
#include "framehex/geometry/validity.hpp"
#include "framehex/io/data_array.hpp"
#include "framehex/io/detail/viewer_page.hpp"
#include "framehex/io/output_file.hpp"
#include "framehex/mesh/mixed_mesh.hpp"

#include <bit>
#include <charconv>
#include <type_traits>

namespace framehex {

namespace detail {

/// A script element of a page that holds numbers: little-endian, as browsers' typed arrays have them, in base64.
class Base64Element {
public:
  Base64Element(OutputFile& file, const std::string& id) : file_(file) {
    file_.write("<script type=\"text/plain\" id=\"framehex-" + id + "\">");
  }

  /// @tparam Number  one of std::uint8_t, std::uint32_t and float.
  template <class Number>
  void add(Number number) {
    if constexpr (sizeof(Number) == 1) {
      add_byte(number);
    } else {
      const auto bits = std::bit_cast<std::uint32_t>(number);
      for (unsigned shift = 0; shift < 32; shift += 8) add_byte(static_cast<std::uint8_t>(bits >> shift));
    }
  }

  void end() {
    const std::size_t n_padding = (3 - n_bytes_ % 3) % 3;
    for (std::size_t i = 0; i < n_padding; ++i) add_byte(0);
    text_.replace(text_.size() - n_padding, n_padding, n_padding, '=');
    file_.write(text_ + "</script>\n");
  }

private:
  void add_byte(std::uint8_t byte) {
    group_ = group_ << 8 | byte;
    if (++n_bytes_ % 3 != 0) return;
    if (text_.size() > (1u << 16)) {  // before, not after: padding replaces the end of the last group
      file_.write(text_);
      text_.clear();
    }
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (int shift = 18; shift >= 0; shift -= 6) text_ += digits[group_ >> shift & 63];
    group_ = 0;
  }

  OutputFile& file_;
  std::string text_;
  std::uint32_t group_ = 0;  // bytes since the last whole group of three
  std::size_t n_bytes_ = 0;
};

/// Text as a string of JSON that may stand in a script element.
inline std::string json_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || c == '<' || c == '"' || c == '\\') {
      constexpr std::string_view digits = "0123456789abcdef";
      out += {'\\', 'u', '0', '0', digits[code >> 4], digits[code & 15]};
    } else {
      out += c;
    }
  }
  return out + '"';
}

/// Arrays of one number a row: those that cells can be coloured by.
inline std::vector<std::pair<const DataArray*, bool>> colour_arrays(const MeshData& data) {
  std::vector<std::pair<const DataArray*, bool>> arrays;
  for (const DataArray& array : data.cells)
    if (array.n_components == 1 && array.name != "scaled_jacobian") arrays.push_back({&array, true});
  for (const DataArray& array : data.points)
    if (array.n_components == 1) arrays.push_back({&array, false});
  return arrays;
}

/// The mesh in the elements that the page's script looks for (examples/viewer/src/mesh.js).
class HtmlData {
public:
  HtmlData(OutputFile& file, const MixedMesh& mesh, const MeshData& data) : file_(file), mesh_(mesh), data_(data) {
    if (mesh.points.empty()) return;
    check_coordinates();
    const Eigen::AlignedBox3d box = bounding_box(mesh.points);
    centre_ = box.center();
    const double half = box.diagonal().stableNorm() / 2;
    if (half > 0) scale_ = half;
  }

  void write(const std::string& title) {
    write_info(title);
    write_positions("points", mesh_.points);
    write_each("kinds", mesh_.kinds, [](CellKind kind) { return static_cast<std::uint8_t>(kind); });
    write_each("corners", mesh_.cells.values, [](index_t v) { return std::uint32_t{v}; });
    write_quality();
    write_each("regions", mesh_.regions, [](index_t label) { return std::uint32_t{label}; });
    write_curves();
    write_lines();
    std::size_t n = 0;
    for (const auto& [array, by_cell] : colour_arrays(data_)) {
      Base64Element element(file_, "array-" + std::to_string(n++));
      std::visit(
          [&](const auto& values) {
            for (const auto x : values) element.add(static_cast<float>(x));
          },
          array->values);
      element.end();
    }
  }

private:
  /// Volumes of cells are products of three lengths.
  void check_coordinates() const {
    constexpr double most = 1e100;
    for (std::size_t v = 0; v < mesh_.points.size(); ++v)
      if (!(mesh_.points[v].cwiseAbs().maxCoeff() <= most))
        throw invalid_coordinate("vertex " + std::to_string(v) + " has a coordinate that is not finite or beyond " +
                                     number(most) + ", where volumes are out of range",
                                 Entity::vertex, {v});
  }

  void write_info(const std::string& title) {
    std::string json = "{\"title\":" + json_string(title) + ",\"scale\":" + number(scale_) + ",\"centre\":[" +
                       number(centre_.x()) + "," + number(centre_.y()) + "," + number(centre_.z()) + "],\"names\":{";
    std::size_t n = 0;
    for (const LabelGroup& group : mesh_.groups)
      for (const index_t label : group.labels)
        if (group.dimension == 3)
          json += (n++ ? ",\"" : "\"") + std::to_string(label) + "\":" + json_string(group.name);
    json += "},\"arrays\":[";
    n = 0;
    for (const auto& [array, by_cell] : colour_arrays(data_))
      json += std::string(n++ ? "," : "") + "{\"name\":" + json_string(array->name) + ",\"on\":\"" +
              (by_cell ? "cells" : "points") + "\"}";
    file_.write("<script type=\"application/json\" id=\"framehex-info\">" + json + "]}</script>\n");
  }

  static std::string number(double x) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, x).ptr;
    return {text, end};
  }

  template <class Values, class Convert>
  void write_each(const std::string& id, const Values& values, Convert&& convert) {
    Base64Element element(file_, id);
    for (const auto& value : values) element.add(convert(value));
    element.end();
  }

  void add_position(Base64Element& element, const Vector3& p) const {
    const Vector3 relative = (p - centre_) / scale_;
    for (int k = 0; k < 3; ++k) element.add(static_cast<float>(relative[k]));
  }

  void write_positions(const std::string& id, const std::vector<Vector3>& points) {
    Base64Element element(file_, id);
    for (const Vector3& p : points) add_position(element, p);
    element.end();
  }

  void write_quality() {
    Base64Element element(file_, "quality");
    std::vector<std::uint32_t> invalid;
    std::array<Vector3, 8> corners;
    for (std::size_t c = 0; c < mesh_.n_cells(); ++c) {
      const auto row = mesh_.cells[c];
      for (std::size_t i = 0; i < row.size(); ++i) corners[i] = mesh_.points[row[i]];
      const auto points = std::span<const Vector3>(corners).first(row.size());
      element.add(static_cast<float>(scaled_jacobian(mesh_.kinds[c], points)));
      if (!is_valid(mesh_.kinds[c], points)) invalid.push_back(static_cast<std::uint32_t>(c));
    }
    element.end();
    write_each("invalid", invalid, [](std::uint32_t cell) { return cell; });
  }

  void write_curves() {
    Base64Element element(file_, "curves");
    for (const LabelledEdge& edge : mesh_.edges)
      for (const index_t v : edge.vertices) element.add(std::uint32_t{v});
    element.end();
  }

  /// Segment by segment.
  void write_lines() {
    std::vector<Vector3> ends;
    for (std::size_t line = 0; line < data_.lines.size(); ++line) {
      const auto points = data_.lines[line];
      for (std::size_t i = 1; i < points.size(); ++i) ends.insert(ends.end(), {points[i - 1], points[i]});
    }
    write_positions("lines", ends);
  }

  OutputFile& file_;
  const MixedMesh& mesh_;
  const MeshData& data_;
  Vector3 centre_ = Vector3::Zero();
  double scale_ = 1;  // half the diagonal of the box
};

}  // namespace detail

/// Writes a mesh as a page that shows it in a browser: cut, peeled, filtered and coloured, with its counts and its worst
/// cells. The page is one file and asks the network for nothing.
///
/// @param path  the file; appears whole or not at all (`OutputFile`). Its stem is the page's title.
/// @param mesh  cells, regions with their names, and labelled edges as curves; labelled faces are not shown.
/// @param data  arrays of one number by cell or point become colours; `lines` are drawn as singular lines.
/// @throws invalid_option  for an array of another length; invalid_coordinate with the first vertex that is not finite or
///         beyond 1e100; io_error naming the file.
/// @par Complexity   O(n); 0.6 MB and some 70 bytes a cell.
/// @par Determinism  Same mesh, same bytes. Coordinates and values are rounded to single precision, relative to the box.
inline void write_html(const std::filesystem::path& path, const MixedMesh& mesh, const MeshData& data = {}) {
  detail::check_rows(path.string(), mesh.n_cells(), mesh.points.size(), data);
  OutputFile file(path);
  file.write({detail::viewer_page_head, sizeof detail::viewer_page_head - 1});
  detail::HtmlData(file, mesh, data).write(path.stem().string());
  file.write({detail::viewer_page_tail, sizeof detail::viewer_page_tail - 1});
  file.commit();
}

}  // namespace framehex
