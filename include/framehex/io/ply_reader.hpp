// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/io/surface_soup.hpp"

namespace framehex {

namespace detail {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
  std::string name;
  PlyType type{};
  bool is_list = false;
  PlyType count_type{};  // of a list
};

struct PlyElement {
  std::string name;
  std::size_t n = 0;
  std::vector<PlyProperty> properties;
};

class PlyReader {
public:
  PlyReader(const std::string& name, std::string_view bytes) : in_(name, bytes), builder_(name) {}

  SurfaceSoup read() {
    read_header();
    for (const PlyElement& element : elements_) {
      check_count(element);
      if (element.name == "vertex")
        read_points(element);
      else if (element.name == "face")
        read_polygons(element);
      else
        for (std::size_t i = 0; i < element.n; ++i)
          for (const PlyProperty& property : element.properties) read_property(property);
    }
    SurfaceSoup soup = builder_.finish();
    if (is_single_) soup.rounding = float_rounding(soup.mesh.points);
    return soup;
  }

private:
  void read_header() {
    if (in_.word() != "ply") in_.fail("not a PLY file");
    in_.line();
    for (;;) {
      if (in_.at_end()) in_.fail("the header does not end");
      const std::string_view keyword = in_.word();
      if (keyword == "format") {
        const std::string_view encoding = in_.word();
        is_text_ = encoding == "ascii";
        if (!is_text_ && encoding != "binary_little_endian" && encoding != "binary_big_endian")
          in_.fail("unknown format \"" + Cursor::printable(encoding) + "\"");
        order_ = encoding == "binary_big_endian" ? std::endian::big : std::endian::little;
      } else if (keyword == "element") {
        const std::string_view name = in_.word();
        elements_.push_back({std::string(name), in_.count("the number of elements", 1), {}});
      } else if (keyword == "property") {
        read_property_line();
      } else if (keyword == "end_header") {
        in_.line();
        return;
      } else if (keyword != "comment" && keyword != "obj_info") {
        in_.fail("\"" + Cursor::printable(keyword) + "\" in the header");
      }
      in_.line();
    }
  }

  void read_property_line() {
    if (elements_.empty()) in_.fail("a property before any element");
    PlyProperty property;
    std::string_view word = in_.word();
    property.is_list = word == "list";
    if (property.is_list) {
      property.count_type = type(in_.word());
      word = in_.word();
    }
    property.type = type(word);
    property.name = in_.word();
    elements_.back().properties.push_back(std::move(property));
  }

  PlyType type(std::string_view word) const {
    constexpr std::array<std::array<std::string_view, 2>, 8> names{{{"char", "int8"},
                                                                    {"uchar", "uint8"},
                                                                    {"short", "int16"},
                                                                    {"ushort", "uint16"},
                                                                    {"int", "int32"},
                                                                    {"uint", "uint32"},
                                                                    {"float", "float32"},
                                                                    {"double", "float64"}}};
    for (std::size_t i = 0; i < names.size(); ++i)
      if (word == names[i][0] || word == names[i][1]) return static_cast<PlyType>(i);
    in_.fail("unknown type \"" + Cursor::printable(word) + "\"");
  }

  static std::size_t size(PlyType type) {
    constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[static_cast<std::size_t>(type)];
  }

  /// Before anything is allocated: what is counted must fit into what is left of the file.
  void check_count(const PlyElement& element) const {
    std::size_t least = 0;
    for (const PlyProperty& p : element.properties) least += is_text_ ? 2 : size(p.is_list ? p.count_type : p.type);
    if (least == 0 ? element.n > 0 : element.n > (in_.remaining() + 1) / least)
      throw io_error(in_.name() + ": tells " + std::to_string(element.n) + " elements \"" +
                     Cursor::printable(element.name) + "\", more than the file can hold");
  }

  double scalar(PlyType type) {
    if (is_text_) return in_.number<double>("a number");
    switch (type) {
      case PlyType::int8: return in_.raw<std::int8_t>(order_);
      case PlyType::uint8: return in_.raw<std::uint8_t>(order_);
      case PlyType::int16: return in_.raw<std::int16_t>(order_);
      case PlyType::uint16: return in_.raw<std::uint16_t>(order_);
      case PlyType::int32: return in_.raw<std::int32_t>(order_);
      case PlyType::uint32: return in_.raw<std::uint32_t>(order_);
      case PlyType::float32: return static_cast<double>(in_.raw<float>(order_));
      default: return in_.raw<double>(order_);
    }
  }

  /// Leaves the value in `scalar_`, or the values in `list_`.
  void read_property(const PlyProperty& property) {
    if (!property.is_list) {
      scalar_ = scalar(property.type);
      return;
    }
    const std::int64_t n = as_integer(scalar(property.count_type), "the length of a list");
    const std::size_t least = is_text_ ? 1 : size(property.type);
    if (n < 0 || static_cast<std::size_t>(n) > (in_.remaining() + 1) / least)
      in_.fail("a list of " + std::to_string(n) + " is more than the file can hold");
    list_.clear();
    for (std::int64_t i = 0; i < n; ++i) list_.push_back(scalar(property.type));
  }

  void read_points(const PlyElement& element) {
    std::array<bool, 3> found{};
    for (const PlyProperty& p : element.properties)
      for (std::size_t i = 0; i < 3; ++i) found[i] |= p.name == std::string(1, "xyz"[i]) && !p.is_list;
    if (!found[0] || !found[1] || !found[2]) throw io_error(in_.name() + ": its vertices lack one of x, y and z");
    for (std::size_t v = 0; v < element.n; ++v) {
      std::array<double, 3> x{};
      for (const PlyProperty& p : element.properties) {
        read_property(p);
        if (p.is_list || p.name.size() != 1 || p.name[0] < 'x' || p.name[0] > 'z') continue;
        x[static_cast<std::size_t>(p.name[0] - 'x')] = scalar_;
        is_single_ |= !is_text_ && p.type == PlyType::float32;
      }
      builder_.add_point(x[0], x[1], x[2]);
    }
  }

  void read_polygons(const PlyElement& element) {
    constexpr std::array<std::string_view, 9> label_names{"label",    "patch", "group",     "group_id",     "region",
                                                          "material", "id",    "medit:ref", "gmsh:physical"};
    const PlyProperty* label = nullptr;
    for (const std::string_view name : label_names)
      for (const PlyProperty& p : element.properties)
        if (!label && p.name == name && !p.is_list) label = &p;
    index_t patch = builder_.patch("");
    for (std::size_t f = 0; f < element.n; ++f) {
      corners_.clear();
      for (const PlyProperty& p : element.properties) {
        read_property(p);
        if (&p == label) patch = builder_.patch(p.name + "_" + std::to_string(as_integer(scalar_, "a label")));
        if (!p.is_list || (p.name != "vertex_indices" && p.name != "vertex_index")) continue;
        for (const double v : list_) corners_.push_back(as_integer(v, "a vertex"));
      }
      builder_.add_polygon(corners_, patch);
    }
  }

  std::int64_t as_integer(double value, const char* what) const {
    if (!(value > -0x1p53 && value < 0x1p53) || value != std::floor(value))
      in_.fail(std::string(what) + " is not an integer");
    return static_cast<std::int64_t>(value);
  }

  Cursor in_;
  SoupBuilder builder_;
  std::vector<PlyElement> elements_;
  bool is_text_ = true, is_single_ = false;
  std::endian order_ = std::endian::little;
  double scalar_ = 0;
  std::vector<double> list_;
  std::vector<std::int64_t> corners_;
};

}  // namespace detail

/// Reads the polygons of a PLY file: text, or binary of either byte order, with elements and properties of any kind
/// beside those of a surface.
///
/// @param name   of the file, for errors.
/// @param bytes  what it holds.
/// @return coordinates in double precision; a property of faces `label`, `patch`, `group`, `group_id`, `region`,
///         `material` or `id` (the first of these) makes patches, named after it and its value ("label_3").
/// @throws io_error naming file and line; invalid_connectivity naming the polygon.
/// @par Complexity   O(n).
/// @par Source       G. Turk, The PLY polygon file format, 1994.
inline SurfaceSoup read_ply(const std::string& name, std::string_view bytes) {
  return detail::PlyReader(name, bytes).read();
}

}  // namespace framehex
