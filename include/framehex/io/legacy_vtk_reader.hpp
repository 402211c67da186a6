// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/io/label_arrays.hpp"
#include "framehex/io/mesh_builder.hpp"

#include <optional>

namespace framehex {

namespace detail {

class LegacyVtkReader {
public:
  LegacyVtkReader(const std::string& name, std::string_view bytes) : in_(name, bytes), builder_(name, 0) {}

  MixedMesh read(const MeshReadOptions& options, MeshReadNotes& notes) {
    wants_points_ = options.arrays == FileArrays::read;
    read_header();
    while (read_section(in_.word())) {
    }
    if (!has_cells())
      in_.fail(is_poly_data_ ? "the file ends without POINTS, LINES and POLYGONS"
                             : "the file ends without POINTS, CELLS and CELL_TYPES");
    if (types_.size() != rows_.size()) in_.fail("CELLS and CELL_TYPES differ in number");
    std::vector<CellArrayName> names;
    for (const auto& array : arrays_) names.push_back(array.name);
    const std::size_t chosen = choose_label_array(in_.name(), names, options, notes);
    std::vector<std::int64_t> labels(types_.size(), 0);
    if (chosen < arrays_.size()) labels = labels_of(in_.name(), names[chosen].name, arrays_[chosen].values);
    for (std::size_t c = 0; c < types_.size(); ++c) builder_.add_vtk(types_[c], rows_[c], labels[c], c);
    if (options.arrays == FileArrays::read) {
      for (std::size_t i = 0; i < arrays_.size(); ++i)
        if (i != chosen) notes.data.cells.push_back({names[i].name, of_volume(arrays_[i].values, types_)});
      notes.data.points = std::move(point_arrays_);
    }
    return builder_.finish(options.volume);
  }

private:
  struct CellArray {
    CellArrayName name;
    std::vector<double> values;
  };

  bool has_cells() const { return !types_.empty() && !rows_.empty(); }

  /// @return false at the end of the file.
  bool read_section(std::string_view keyword) {
    if (keyword == "POINTS")
      read_points();
    else if (is_poly_data_ && (keyword == "VERTICES" || keyword == "LINES" || keyword == "POLYGONS"))
      read_poly_data(keyword);
    else if (keyword == "CELLS" && !is_poly_data_)
      rows_ = read_rows();
    else if (keyword == "CELL_TYPES" && !is_poly_data_)
      read_types();
    else if (keyword == "METADATA")
      pass_metadata();
    else if (keyword == "FIELD")
      read_field();
    else if (keyword == "CELL_DATA" || keyword == "POINT_DATA")
      begin_data(keyword == "CELL_DATA");
    else if (n_rows_)
      return read_attribute(keyword);
    else if (!keyword.empty())
      in_.fail("unexpected \"" + Cursor::printable(keyword) + "\"");
    return !keyword.empty();
  }

  /// Ends with an empty line.
  void pass_metadata() {
    in_.line();
    while (in_.remaining() > 0 && !is_blank(in_.line())) {
    }
  }

  /// Each array may have some.
  void pass_metadata_if_any() {
    if (in_.peek_word() != "METADATA") return;
    in_.word();
    pass_metadata();
  }

  static bool is_blank(std::string_view line) { return line.find_first_not_of(" \t\r") == line.npos; }

  void begin_data(bool by_cell) {
    by_cell_ = by_cell;
    n_rows_ = in_.count("the number of rows", 1);
    if (by_cell && *n_rows_ != types_.size())
      in_.fail("CELL_DATA is of " + std::to_string(*n_rows_) + " cells of " + std::to_string(types_.size()));
    in_.line();
  }

  /// One attribute of CELL_DATA or POINT_DATA. Those of another kind than scalars are passed over.
  bool read_attribute(std::string_view keyword) {
    if (keyword.empty()) return false;
    const std::string_view name = in_.word();
    if (keyword == "LOOKUP_TABLE") {
      const std::size_t n = in_.count("the size of a table", 1);
      in_.line();
      pass_values(4 * n, binary_ ? "unsigned_char" : "float");
    } else if (keyword == "COLOR_SCALARS") {
      const std::size_t n = in_.count("the number of components", 1);
      in_.line();
      pass_values(checked_product(*n_rows_, n), binary_ ? "unsigned_char" : "float");
    } else if (keyword == "SCALARS") {
      read_scalars(name);
    } else if (keyword == "TEXTURE_COORDINATES") {
      const std::size_t n = in_.count("the number of components", 1);
      pass_rows(n, in_.word());
    } else if (const std::size_t n = attribute_components(keyword); n > 0) {
      pass_rows(n, in_.word());
    } else {
      in_.fail("unexpected \"" + Cursor::printable(keyword) + "\"");
    }
    return true;
  }

  static std::size_t attribute_components(std::string_view keyword) {
    if (keyword == "VECTORS" || keyword == "NORMALS") return 3;
    if (keyword == "TENSORS") return 9;
    if (keyword == "TENSORS6") return 6;
    return keyword == "GLOBAL_IDS" || keyword == "PEDIGREE_IDS" || keyword == "EDGE_FLAGS" ? 1 : 0;
  }

  void read_scalars(std::string_view name) {
    const std::string_view type = in_.word();
    Cursor rest = in_.rest_of_line();
    const std::size_t n_components = rest.at_end() ? 1 : rest.number<std::size_t>("the number of components");
    if (in_.peek_word() == "LOOKUP_TABLE") in_.word(), in_.line();
    read_array(name, type, n_components, *n_rows_);
  }

  /// Arrays under one name, each with its own number of rows; those beside CELL_DATA are passed over.
  void read_field() {
    in_.word();
    const std::size_t n = in_.count("the number of arrays", 1);
    in_.line();
    for (std::size_t i = 0; i < n; ++i) {
      pass_metadata_if_any();
      const std::string_view name = in_.word();
      const auto n_components = in_.number<std::size_t>("the number of components");
      const auto n_rows = in_.number<std::size_t>("the number of rows");
      const std::string_view type = in_.word();
      in_.line();
      read_array(name, type, n_components, n_rows);
    }
  }

  void read_array(std::string_view name, std::string_view type, std::size_t n_components, std::size_t n_rows) {
    const bool is_number = n_rows_ && n_components == 1 && type != "string" && type != "bit";
    if (!is_number || !(by_cell_ || wants_points_)) return pass_values(checked_product(n_rows, n_components), type);
    const std::size_t n = by_cell_ ? types_.size() : builder_.n_points();
    if (n_rows != n)
      in_.fail("array \"" + Cursor::printable(name) + "\" is of " + std::to_string(n_rows) +
               (by_cell_ ? " cells of " : " points of ") + std::to_string(n));
    if (!by_cell_) {
      point_arrays_.push_back({decoded(name), typed_values<double>(n_rows, type)});
      return;
    }
    CellArray& array = arrays_.emplace_back();
    array.name = {decoded(name), type != "float" && type != "double", 1};
    array.values = typed_values<double>(n_rows, type);
  }

  /// Blanks and other characters stand as %20 and so on.
  static std::string decoded(std::string_view name) {
    std::string text;
    for (std::size_t i = 0; i < name.size(); ++i) {
      unsigned code = 0;
      const bool coded = name[i] == '%' && i + 2 < name.size() &&
                         std::from_chars(&name[i + 1], &name[i + 1] + 2, code, 16).ptr == &name[i + 1] + 2;
      text += coded ? static_cast<char>(code) : name[i];
      if (coded) i += 2;
    }
    return text;
  }

  std::size_t checked_product(std::size_t n, std::size_t k) const {
    if (k > 0 && n > 8 * in_.remaining() / k + 8) in_.fail("an array is more than the file can hold");
    return n * k;
  }

  void pass_rows(std::size_t n_components, std::string_view type) {
    in_.line();
    pass_values(checked_product(*n_rows_, n_components), type);
  }

  void pass_values(std::size_t n, std::string_view type) {
    if (type == "string") return pass_strings(n);
    if (!binary_) {
      for (std::size_t i = 0; i < n; ++i)
        if (in_.word().empty()) in_.fail("the file ends within an array");
      return;
    }
    if (type == "bit") return in_.skip((n + 7) / 8);
    in_.skip(n, type_size(type));
  }

  void pass_strings(std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      if (!binary_) {
        in_.line();
        continue;
      }
      // The length takes one, two, four or eight bytes, as the first two bits tell.
      const auto first = in_.raw<std::uint8_t>();
      const std::size_t n_more = first >= 0xc0 ? 0 : first >= 0x80 ? 1 : first >= 0x40 ? 3 : 7;
      std::uint64_t length = first & 0x3fu;
      for (std::size_t k = 0; k < n_more; ++k) length = length << 8 | in_.raw<std::uint8_t>();
      in_.skip(length);
    }
  }

  std::size_t type_size(std::string_view type) const {
    if (type == "char" || type == "unsigned_char" || type == "signed_char") return 1;
    if (type == "short" || type == "unsigned_short") return 2;
    if (type == "int" || type == "unsigned_int" || type == "float" || type == "vtkIdType") return 4;
    if (type == "long" || type == "unsigned_long" || type == "double" || type == "vtktypeint64" ||
        type == "vtktypeuint64" || type == "long_long" || type == "unsigned_long_long")
      return 8;
    in_.fail("unknown type \"" + Cursor::printable(type) + "\"");
  }

  void read_header() {
    if (!in_.line().starts_with("# vtk DataFile Version")) in_.fail("not a VTK file");
    in_.line();
    const std::string_view encoding = in_.word();
    if (encoding != "ASCII" && encoding != "BINARY") in_.fail("neither ASCII nor BINARY");
    binary_ = encoding == "BINARY";
    const bool has_kind = in_.word() == "DATASET";
    const std::string_view kind = in_.word();
    is_poly_data_ = kind == "POLYDATA";
    if (!has_kind || (!is_poly_data_ && kind != "UNSTRUCTURED_GRID"))
      in_.fail("neither an unstructured grid nor polygonal data");
  }

  template <class Stored, class Value>
  std::vector<Value> values(std::size_t n, const char* what) {
    std::vector<Value> out;
    if (binary_) {
      if (n > in_.remaining() / sizeof(Stored)) in_.fail("the file ends within binary data");
      std::vector<Stored> stored(n);
      in_.raw(stored.data(), n, std::endian::big);
      out.assign(stored.begin(), stored.end());
    } else {
      out.reserve(std::min(n, in_.remaining()));
      for (std::size_t i = 0; i < n; ++i) out.push_back(in_.number<Value>(what));
    }
    return out;
  }

  /// Values of any type that the format knows.
  template <class Value>
  std::vector<Value> typed_values(std::size_t n, std::string_view type, const char* what = "a number of an array") {
    if (type == "float") return values<float, Value>(n, what);
    if (type == "double") return values<double, Value>(n, what);
    const bool is_unsigned = type.starts_with("unsigned") || type == "vtktypeuint64";
    switch (type_size(type)) {
      case 1: return is_unsigned ? values<std::uint8_t, Value>(n, what) : values<std::int8_t, Value>(n, what);
      case 2: return is_unsigned ? values<std::uint16_t, Value>(n, what) : values<std::int16_t, Value>(n, what);
      case 4: return is_unsigned ? values<std::uint32_t, Value>(n, what) : values<std::int32_t, Value>(n, what);
      default: return is_unsigned ? values<std::uint64_t, Value>(n, what) : values<std::int64_t, Value>(n, what);
    }
  }

  std::vector<std::int64_t> integers(std::size_t n, std::string_view type) {
    if (type == "float" || type == "double") in_.fail("unknown type \"" + Cursor::printable(type) + "\"");
    return typed_values<std::int64_t>(n, type);
  }

  void read_points() {
    const std::size_t n = in_.count("the number of points", 3);
    const std::string_view type = in_.word();
    in_.line();
    const std::vector<double> x = typed_values<double>(3 * n, type, "a coordinate");
    for (std::size_t i = 0; i < n; ++i) builder_.add_point(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
  }

  /// Cells of polygonal data, whose types are those that they have in a grid.
  void read_poly_data(std::string_view keyword) {
    const auto type_of = [&](std::size_t n_corners) -> vtk::CellType {
      if (keyword == "LINES") return vtk::poly_line;
      if (keyword == "VERTICES") return vtk::poly_vertex;
      return n_corners == 3 ? vtk::triangle : n_corners == 4 ? vtk::quad : vtk::polygon;
    };
    const Csr<std::int64_t> rows = read_rows();
    for (std::size_t c = 0; c < rows.size(); ++c) {
      const auto row = rows[c];
      rows_.values.insert(rows_.values.end(), row.begin(), row.end());
      rows_.end_row();
      types_.push_back(type_of(row.size()));
    }
  }

  Csr<std::int64_t> read_rows() {
    const std::size_t n = in_.count("the number of cells", 1);
    const std::size_t size = in_.count("the size of the cells", 1);
    in_.line();
    if (in_.peek_word() == "OFFSETS") return read_rows_with_offsets(n, size);
    Csr<std::int64_t> rows;
    const std::vector<std::int64_t> list = integers(size, "int");
    std::size_t at = 0;
    for (std::size_t c = 0; c < n; ++c) {
      if (at >= size || list[at] < 0 || static_cast<std::size_t>(list[at]) > size - at - 1)
        in_.fail("CELLS ends within cell " + std::to_string(c));
      const auto corners = static_cast<std::size_t>(list[at++]);
      for (std::size_t i = 0; i < corners; ++i) rows.values.push_back(list[at++]);
      rows.end_row();
    }
    return rows;
  }

  // Version 5: n counts the offsets, one more than the cells.
  Csr<std::int64_t> read_rows_with_offsets(std::size_t n, std::size_t size) {
    Csr<std::int64_t> rows;
    in_.word();
    const std::string_view offset_type = in_.word();
    in_.line();
    const std::vector<std::int64_t> offsets = integers(n, offset_type);
    pass_metadata_if_any();
    if (in_.word() != "CONNECTIVITY") in_.fail("CONNECTIVITY should stand here");
    const std::string_view type = in_.word();
    in_.line();
    rows.values = integers(size, type);
    for (std::size_t c = 0; c < n; ++c)
      if (offsets[c] < (c == 0 ? 0 : offsets[c - 1]) || offsets[c] > static_cast<std::int64_t>(size))
        in_.fail("the offset of cell " + std::to_string(c) + " is out of range");
    rows.offsets.assign(offsets.begin(), offsets.end());
    if (rows.offsets.empty()) rows.offsets.push_back(0);
    return rows;
  }

  void read_types() {
    const std::size_t n = in_.count("the number of cell types", 1);
    in_.line();
    types_ = integers(n, "int");
  }

  Cursor in_;
  MeshBuilder builder_;
  bool binary_ = false, is_poly_data_ = false;
  Csr<std::int64_t> rows_;
  std::vector<std::int64_t> types_;
  std::optional<std::size_t> n_rows_;  // of CELL_DATA or POINT_DATA, within them
  bool by_cell_ = false;
  bool wants_points_ = false;
  std::vector<CellArray> arrays_;        // by cell, of one component
  std::vector<DataArray> point_arrays_;  // the same by point, where they are wanted
};

}  // namespace detail

/// Reads an unstructured grid, or polygonal data without strips, in VTK's legacy format, text or binary, of versions 1 to
/// 5.1.
///
/// @param options  which array by cell holds the labels.
/// @param notes    what else was found, when not null.
/// @return its cells, and its triangles, quadrilaterals and lines as faces and edges. Prisms are turned as a whole where
///         the file does not follow VTK's manual.
/// @throws io_error naming file and line or cell; invalid_connectivity (a vertex out of range) and invalid_coordinate
///         (NaN, infinity), both naming the file as well.
/// @par Complexity   O(n).
inline MixedMesh read_legacy_vtk(const std::filesystem::path& path, const MeshReadOptions& options = {},
                                 MeshReadNotes* notes = nullptr) {
  const std::string bytes = read_file(path);
  MeshReadNotes ignored;
  return detail::LegacyVtkReader(path.string(), bytes).read(options, notes ? *notes : ignored);
}

}  // namespace framehex
