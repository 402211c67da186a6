// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/io/mesh_builder.hpp"

namespace framehex {

namespace detail {

class LegacyVtkReader {
public:
  LegacyVtkReader(const std::string& name, std::string_view bytes) : in_(name, bytes), builder_(name, 0) {}

  MixedMesh read() {
    read_header();
    // What follows the cells (data by cell and point) is not needed.
    while (types_.empty() || rows_.empty()) {
      const std::string_view keyword = in_.word();
      if (keyword == "POINTS")
        read_points();
      else if (keyword == "CELLS")
        read_cells();
      else if (keyword == "CELL_TYPES")
        read_types();
      else if (keyword == "METADATA")
        skip_metadata();
      else if (keyword == "FIELD")
        skip_field();
      else if (keyword.empty())
        in_.fail("the file ends without POINTS, CELLS and CELL_TYPES");
      else
        in_.fail("unexpected \"" + Cursor::printable(keyword) + "\"");
    }
    if (types_.size() != rows_.size()) in_.fail("CELLS and CELL_TYPES differ in number");
    for (std::size_t c = 0; c < types_.size(); ++c) builder_.add_vtk(types_[c], rows_[c], 0, c);
    return builder_.finish();
  }

private:
  void read_header() {
    if (!in_.line().starts_with("# vtk DataFile Version")) in_.fail("not a VTK file");
    in_.line();
    const std::string_view encoding = in_.word();
    if (encoding != "ASCII" && encoding != "BINARY") in_.fail("neither ASCII nor BINARY");
    binary_ = encoding == "BINARY";
    if (in_.word() != "DATASET" || in_.word() != "UNSTRUCTURED_GRID") in_.fail("not an unstructured grid");
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

  std::vector<std::int64_t> integers(std::size_t n, std::string_view type, const char* what) {
    if (type == "int" || type == "vtkIdType") return values<std::int32_t, std::int64_t>(n, what);
    if (type == "vtktypeint64" || type == "long") return values<std::int64_t, std::int64_t>(n, what);
    in_.fail("unknown type \"" + Cursor::printable(type) + "\"");
  }

  void read_points() {
    const std::size_t n = in_.count("the number of points", 3);
    const std::string_view type = in_.word();
    in_.line();
    std::vector<double> x;
    if (type == "float")
      x = values<float, double>(3 * n, "a coordinate");
    else if (type == "double")
      x = values<double, double>(3 * n, "a coordinate");
    else
      in_.fail("unknown type \"" + Cursor::printable(type) + "\"");
    for (std::size_t i = 0; i < n; ++i) builder_.add_point(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
  }

  void read_cells() {
    const std::size_t n = in_.count("the number of cells", 1);
    const std::size_t size = in_.count("the size of the cells", 1);
    in_.line();
    if (in_.peek_word() == "OFFSETS") return read_cells_with_offsets(n, size);
    const std::vector<std::int64_t> list = integers(size, "int", "a vertex");
    std::size_t at = 0;
    for (std::size_t c = 0; c < n; ++c) {
      if (at >= size || list[at] < 0 || static_cast<std::size_t>(list[at]) > size - at - 1)
        in_.fail("CELLS ends within cell " + std::to_string(c));
      const auto corners = static_cast<std::size_t>(list[at++]);
      for (std::size_t i = 0; i < corners; ++i) rows_.values.push_back(list[at++]);
      rows_.end_row();
    }
  }

  // Version 5: n counts the offsets, one more than the cells.
  void read_cells_with_offsets(std::size_t n, std::size_t size) {
    in_.word();
    const std::string_view offset_type = in_.word();
    in_.line();
    const std::vector<std::int64_t> offsets = integers(n, offset_type, "an offset");
    skip_metadata_if_any();
    if (in_.word() != "CONNECTIVITY") in_.fail("CONNECTIVITY should stand here");
    const std::string_view type = in_.word();
    in_.line();
    rows_.values = integers(size, type, "a vertex");
    for (std::size_t c = 0; c < n; ++c)
      if (offsets[c] < (c == 0 ? 0 : offsets[c - 1]) || offsets[c] > static_cast<std::int64_t>(size))
        in_.fail("the offset of cell " + std::to_string(c) + " is out of range");
    rows_.offsets.assign(offsets.begin(), offsets.end());
    if (rows_.offsets.empty()) rows_.offsets.push_back(0);
  }

  /// A block of lines that ends with an empty one.
  void skip_metadata() {
    in_.line();
    while (in_.remaining() > 0 && !is_blank(in_.line())) {
    }
  }

  /// Each array may have one.
  void skip_metadata_if_any() {
    if (in_.peek_word() != "METADATA") return;
    in_.word();
    skip_metadata();
  }

  static bool is_blank(std::string_view line) { return line.find_first_not_of(" \t\r") == line.npos; }

  /// Arrays that belong to no cell and no point (of a time, a name...).
  void skip_field() {
    in_.word();  // its name
    const std::size_t n_arrays = in_.count("the number of arrays", 1);
    for (std::size_t array = 0; array < n_arrays; ++array) {
      skip_metadata_if_any();
      in_.word();  // its name
      const auto n_components = in_.number<std::size_t>("the number of components");
      const auto n = in_.number<std::size_t>("the number of rows");
      // Bits are the smallest: eight a byte.
      if (n_components != 0 && n > 8 * in_.remaining() / n_components) in_.fail("an array is larger than the file");
      const std::string_view type = in_.word();
      in_.line();
      skip_values(n * n_components, type);
    }
  }

  void skip_values(std::size_t n, std::string_view type) {
    if (type == "string") {
      for (std::size_t i = 0; i < n; ++i) skip_string();
    } else if (!binary_) {
      for (std::size_t i = 0; i < n; ++i)
        if (in_.word().empty()) in_.fail("the file ends within an array");
    } else if (type == "bit") {
      in_.skip((n + 7) / 8);
    } else {
      const std::size_t size = size_of(type);
      if (n > in_.remaining() / size) in_.fail("the file ends within binary data");
      in_.skip(n * size);
    }
  }

  /// Text files: a line each. Binary ones: the length first, in as many bytes as its two highest bits tell.
  void skip_string() {
    if (!binary_) {
      in_.line();
      return;
    }
    const auto first = in_.raw<std::uint8_t>();
    std::size_t length = first & 0x3f;
    for (int more = first >> 6 == 3 ? 0 : first >> 6 == 2 ? 1 : first >> 6 == 1 ? 3 : 7; more > 0; --more)
      length = length << 8 | in_.raw<std::uint8_t>();
    in_.skip(length);
  }

  std::size_t size_of(std::string_view type) const {
    constexpr std::array<std::pair<std::string_view, std::size_t>, 14> sizes{{{"char", 1},
                                                                              {"signed_char", 1},
                                                                              {"unsigned_char", 1},
                                                                              {"short", 2},
                                                                              {"unsigned_short", 2},
                                                                              {"int", 4},
                                                                              {"unsigned_int", 4},
                                                                              {"float", 4},
                                                                              {"long", 8},
                                                                              {"unsigned_long", 8},
                                                                              {"double", 8},
                                                                              {"vtkIdType", 4},
                                                                              {"vtktypeint64", 8},
                                                                              {"vtktypeuint64", 8}}};
    for (const auto& [name, size] : sizes)
      if (name == type) return size;
    in_.fail("unknown type \"" + Cursor::printable(type) + "\"");
  }

  void read_types() {
    const std::size_t n = in_.count("the number of cell types", 1);
    in_.line();
    types_ = integers(n, "int", "a cell type");
  }

  Cursor in_;
  MeshBuilder builder_;
  bool binary_ = false;
  Csr<std::int64_t> rows_;
  std::vector<std::int64_t> types_;
};

}  // namespace detail

/// Reads an unstructured grid in VTK's legacy format, text or binary, of versions 1 to 5.1.
///
/// @return its cells, and its triangles, quadrilaterals and lines as faces and edges (label 0). Prisms are turned as a
///         whole where the file does not follow VTK's manual.
/// @throws io_error naming file and line or cell; invalid_connectivity (a vertex out of range) and invalid_coordinate
///         (NaN, infinity), both naming the file as well.
/// @par Complexity   O(n).
inline MixedMesh read_legacy_vtk(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  return detail::LegacyVtkReader(path.string(), bytes).read();
}

}  // namespace framehex
