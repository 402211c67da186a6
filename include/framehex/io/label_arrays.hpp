// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/data_array.hpp"
#include "framehex/io/input_file.hpp"
#include "framehex/io/vtk_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace framehex {

/// Whether a file has to hold cells of a volume.
enum class Volume { required, optional };

/// Whether the arrays of a file are wanted, beside those that hold labels.
enum class FileArrays { skip, read };

/// What to read of a mesh's file.
struct MeshReadOptions {
  Volume volume = Volume::required;
  std::string regions = {};  ///< array by cell that holds the labels; empty: one of the usual names
  FileArrays arrays = FileArrays::skip;
};

/// What a reader of a mesh found beside the mesh.
struct MeshReadNotes {
  std::string label_array = {};                 ///< array by cell that the labels come from; empty: none
  std::vector<std::string> unused_arrays = {};  ///< further arrays by cell of one integer a cell
  MeshData data = {};  ///< when asked for: arrays of one number by point, and by cell of the volume
};

/// Lengths at the points of a mesh, as a file tells them.
struct PointLengths {
  std::string wanted = {};          ///< array by point that holds them; empty: one of the usual names, or the only one
  std::string array = {};           ///< the one that was taken
  std::vector<double> values = {};  ///< n_points, as they stand there
};

namespace detail {

/// An array by cell or point of a file, before its values are read.
struct CellArrayName {
  std::string name;
  bool is_integer = false;
  std::size_t n_components = 1;
};

/// Of values by cell of a file, those of the cells of a volume, which are what a mesh's cells are.
///
/// @param types  VTK's, of the file's cells.
inline std::vector<double> of_volume(const std::vector<double>& values, const std::vector<std::int64_t>& types) {
  std::vector<double> kept;
  for (std::size_t c = 0; c < types.size(); ++c)
    if (types[c] >= vtk::tetrahedron && types[c] <= vtk::pyramid) kept.push_back(values[c]);
  return kept;
}

/// Adds rows to the array of a name, or begins one.
inline void append_rows(std::vector<DataArray>& arrays, const std::string& name, std::vector<double> rows) {
  auto array = std::find_if(arrays.begin(), arrays.end(), [&](const DataArray& a) { return a.name == name; });
  if (array == arrays.end()) {
    arrays.push_back({name, std::move(rows)});
    return;
  }
  auto& values = std::get<std::vector<double>>(array->values);
  values.insert(values.end(), rows.begin(), rows.end());
}

/// The array that holds the labels: the one asked for, or the first of the usual names (in any case) that is there.
///
/// @return its place among `arrays`, or their number when there is none.
/// @throws io_error  when the one asked for is not there, or has not one component.
inline std::size_t choose_label_array(const std::string& file, const std::vector<CellArrayName>& arrays,
                                      const MeshReadOptions& options, MeshReadNotes& notes) {
  constexpr std::array<std::string_view, 22> usual{
      "label",       "labels",      "region", "regions",       "region_id",        "material",      "materials",
      "material_id", "materialids", "mat_id", "gmsh:physical", "medit:ref",        "cellentityids", "attribute",
      "subdomain",   "zone",        "part",   "cell_tags",     "gmsh:geometrical", "patch",         "patch_id",
      "group"};
  std::size_t chosen = arrays.size();
  if (!options.regions.empty()) {
    std::string known;
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      if (arrays[i].name == options.regions) chosen = i;
      known += (i == 0 ? "" : ", ") + arrays[i].name;
    }
    if (chosen == arrays.size())
      throw io_error(file + ": has no array by cell \"" + options.regions + "\" (it has " +
                     (known.empty() ? "none" : known) + ")");
    if (arrays[chosen].n_components != 1)
      throw io_error(file + ": array \"" + options.regions + "\" has " + std::to_string(arrays[chosen].n_components) +
                     " components, not one label a cell");
  }
  // Numbers with a fraction under such a name may be anything: they are labels when asked for only.
  for (std::size_t u = 0; u < usual.size() && chosen == arrays.size(); ++u)
    for (std::size_t i = 0; i < arrays.size() && chosen == arrays.size(); ++i)
      if (arrays[i].is_integer && arrays[i].n_components == 1 && lower_text(arrays[i].name) == usual[u]) chosen = i;
  if (chosen < arrays.size()) notes.label_array = arrays[chosen].name;
  // Beside labels of our own, what our files always hold is not worth a word.
  const bool ours = notes.label_array == "label";
  for (std::size_t i = 0; i < arrays.size(); ++i)
    if (i != chosen && arrays[i].is_integer && arrays[i].n_components == 1 &&
        !(ours && (arrays[i].name == "kind" || arrays[i].name == "open_quads")))
      notes.unused_arrays.push_back(arrays[i].name);
  return chosen;
}

/// The array that holds lengths: the one asked for, else the first of the usual names (in any case) that is there, else the
/// only one of one component.
///
/// @throws io_error  when that leaves none, with the names of those of one component.
inline std::string choose_length_array(const std::string& file, const std::vector<CellArrayName>& arrays,
                                       const std::string& wanted) {
  constexpr std::array<std::string_view, 10> usual{"size",       "sizes",  "size_field", "mesh_size", "edge_length",
                                                   "edgelength", "length", "lc",         "h",         "sizing"};
  std::vector<std::string> known;
  for (const CellArrayName& array : arrays)
    if (array.n_components == 1) known.push_back(array.name);
  if (!wanted.empty() && std::find(known.begin(), known.end(), wanted) != known.end()) return wanted;
  for (std::size_t u = 0; u < usual.size() && wanted.empty(); ++u)
    for (const std::string& name : known)
      if (lower_text(name) == usual[u]) return name;
  if (wanted.empty() && known.size() == 1) return known[0];
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  throw io_error(file +
                 (wanted.empty() ? ": which array by point holds the lengths?"
                                 : ": has no array by point \"" + wanted + "\" of one number a point") +
                 " (it has " + (list.empty() ? "none" : list) + ")");
}

/// Labels from values of any type. @throws io_error  for one that is no integer.
inline std::vector<std::int64_t> labels_of(const std::string& file, const std::string& array,
                                           const std::vector<double>& values) {
  std::vector<std::int64_t> labels;
  labels.reserve(values.size());
  for (std::size_t c = 0; c < values.size(); ++c) {
    if (!(std::abs(values[c]) < 0x1p53) || values[c] != std::floor(values[c]))
      throw io_error(file + ": array \"" + array + "\" is no label: it is " + std::to_string(values[c]) + " at cell " +
                         std::to_string(c),
                     Entity::cell, {c});
    labels.push_back(static_cast<std::int64_t>(values[c]));
  }
  return labels;
}

}  // namespace detail

}  // namespace framehex
