// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/data_array.hpp"
#include "framehex/io/output_file.hpp"
#include "framehex/io/vtk_cells.hpp"
#include "framehex/mesh/mixed_mesh.hpp"

#include <bit>
#include <functional>
#include <limits>

namespace framehex {

namespace detail {

/// Cells of all dimensions in the order of the file: the volume's, then faces, then edges.
struct VtuCells {
  std::vector<std::int64_t> connectivity, offsets;
  std::vector<std::uint8_t> types, kinds;
  std::vector<index_t> labels;

  explicit VtuCells(const MixedMesh& mesh) {
    for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
      const CellKind kind = mesh.kinds[c];
      for (std::size_t i = 0; i < mesh.cells[c].size(); ++i)
        connectivity.push_back(mesh.cells[c][vtk::corner(kind, i)]);
      end_cell(vtk::cell_type(kind), static_cast<std::uint8_t>(kind), mesh.regions.empty() ? 0 : mesh.regions[c]);
    }
    for (const LabelledFace& face : mesh.faces) {
      connectivity.insert(connectivity.end(), face.vertices.begin(),
                          face.vertices.begin() + static_cast<std::ptrdiff_t>(face.size()));
      if (face.size() == 3)
        end_cell(vtk::triangle, 4, face.label);
      else
        end_cell(vtk::quad, 5, face.label);
    }
    for (const LabelledEdge& edge : mesh.edges) {
      connectivity.insert(connectivity.end(), edge.vertices.begin(), edge.vertices.end());
      end_cell(vtk::line, 6, edge.label);
    }
  }

  std::size_t size() const { return types.size(); }

private:
  void end_cell(vtk::CellType type, std::uint8_t kind, index_t label) {
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
    types.push_back(type);
    kinds.push_back(kind);
    labels.push_back(label);
  }
};

/// Text as the value of an XML attribute.
inline std::string xml_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\t':
      case '\n':
      case '\r': out += "&#" + std::to_string(static_cast<int>(c)) + ";"; break;
      default: out += c;
    }
  return out;
}

/// One appended array: its element in the XML part, and where its bytes stand.
class VtuArrays {
public:
  /// @param n_padding  values to add at the end, for the cells that have none.
  template <class Value>
  std::string add(const std::string& name, std::size_t n_components, const Value* values, std::size_t n,
                  std::size_t n_padding = 0) {
    static_assert(sizeof(Value) <= 8);
    const char* const family = std::is_floating_point_v<Value> ? "Float" : std::is_signed_v<Value> ? "Int" : "UInt";
    std::string element = "        <DataArray type=\"" + std::string(family) + std::to_string(8 * sizeof(Value)) +
                          "\" Name=\"" + xml_escaped(name) + "\"";
    if (n_components != 1) element += " NumberOfComponents=\"" + std::to_string(n_components) + "\"";
    element += " format=\"appended\" offset=\"" + std::to_string(offset_) + "\"/>\n";
    offset_ += sizeof(std::uint64_t) + (n + n_padding) * sizeof(Value);
    blocks_.push_back([=](OutputFile& file) {
      file.write_value(static_cast<std::uint64_t>((n + n_padding) * sizeof(Value)));
      file.write_values(values, n);
      constexpr Value padding = std::is_floating_point_v<Value> ? std::numeric_limits<Value>::quiet_NaN() : Value{};
      const std::vector<Value> tail(n_padding, padding);
      file.write_values(tail.data(), n_padding);
    });
    return element;
  }

  std::string add(const DataArray& array, std::size_t n_padded_rows) {
    const std::size_t n_padding = (n_padded_rows - array.size()) * array.n_components;
    return std::visit(
        [&](const auto& values) {
          return add(array.name, array.n_components, values.data(), values.size(), n_padding);
        },
        array.values);
  }

  void write(OutputFile& file) const {
    for (const auto& block : blocks_) block(file);
  }

private:
  std::uint64_t offset_ = 0;
  std::vector<std::function<void(OutputFile&)>> blocks_;
};

inline void check_data(const std::string& name, const MixedMesh& mesh, const MeshData& data) {
  const auto check = [&](const std::vector<DataArray>& arrays, std::size_t n) {
    for (const DataArray& array : arrays)
      if (array.n_components == 0 || array.size() != n)
        throw invalid_option(name + ": array \"" + array.name + "\" has " + std::to_string(array.size()) +
                             " rows instead of " + std::to_string(n));
  };
  check(data.cells, mesh.n_cells());
  check(data.points, mesh.points.size());
}

}  // namespace detail

/// Writes a mesh as a VTK XML unstructured grid, for ParaView and whoever builds on VTK.
///
/// @param path  the file; appears whole or not at all (`OutputFile`).
/// @param mesh  its labelled faces and edges are written as cells too, after the volume's.
/// @param data  arrays of n_cells and n_points rows. Faces and edges have NaN (integers: 0) in the arrays by cell. Two
///              arrays are always written: `kind` (0 tetrahedron, 1 pyramid, 2 prism, 3 hexahedron, 4 triangle,
///              5 quadrilateral, 6 edge) and `label` (region, patch or curve).
/// @throws invalid_option  for an array of another length; io_error naming the file.
/// @par Complexity   O(n); connectivity is held once more in memory.
/// @par Determinism  Same mesh, same bytes (on machines of one byte order, which the file states).
/// @par Source       VTK file formats, XML, version 1.0: appended raw data, 64-bit headers. Prisms in the order of
///                   VTK's manual (vtk_cells.hpp).
inline void write_vtu(const std::filesystem::path& path, const MixedMesh& mesh, const MeshData& data = {}) {
  static_assert(sizeof(Vector3) == 3 * sizeof(double));
  detail::check_data(path.string(), mesh, data);
  const detail::VtuCells cells(mesh);
  detail::VtuArrays arrays;

  const double* const coordinates = mesh.points.empty() ? nullptr : mesh.points.front().data();
  std::string xml = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"";
  xml += std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
  xml += "\" header_type=\"UInt64\">\n  <UnstructuredGrid>\n    <Piece NumberOfPoints=\"" +
         std::to_string(mesh.points.size()) + "\" NumberOfCells=\"" + std::to_string(cells.size()) +
         "\">\n      <Points>\n" + arrays.add("Points", 3, coordinates, 3 * mesh.points.size()) +
         "      </Points>\n      <Cells>\n" +
         arrays.add("connectivity", 1, cells.connectivity.data(), cells.connectivity.size()) +
         arrays.add("offsets", 1, cells.offsets.data(), cells.size()) +
         arrays.add("types", 1, cells.types.data(), cells.size()) + "      </Cells>\n      <CellData>\n" +
         arrays.add("kind", 1, cells.kinds.data(), cells.size()) +
         arrays.add("label", 1, cells.labels.data(), cells.size());
  for (const DataArray& array : data.cells) xml += arrays.add(array, cells.size());
  xml += "      </CellData>\n      <PointData>\n";
  for (const DataArray& array : data.points) xml += arrays.add(array, mesh.points.size());
  xml += "      </PointData>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_";

  OutputFile file(path);
  file.write(xml);
  arrays.write(file);
  file.write("\n  </AppendedData>\n</VTKFile>\n");
  file.commit();
}

}  // namespace framehex
