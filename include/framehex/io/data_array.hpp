// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/errors.hpp"
#include "framehex/mesh/csr.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace framehex {

/// Values by cell or by point under a name, for a file.
struct DataArray {
  std::string name;
  std::variant<std::vector<double>, std::vector<index_t>, std::vector<std::uint8_t>, std::vector<std::int64_t>>
      values;  ///< row by row
  std::size_t n_components = 1;

  std::size_t size() const {
    return std::visit([](const auto& v) { return v.size(); }, values) / n_components;
  }
};

/// What a file holds beside the mesh.
struct MeshData {
  std::vector<DataArray> cells;   ///< n_cells rows each
  std::vector<DataArray> points;  ///< n_points rows each
  Csr<Vector3> lines = {};        ///< polylines: singular lines of the frame field; .html holds them
};

namespace detail {

/// @throws invalid_option  for an array that has not as many rows as there are cells, or points.
inline void check_rows(const std::string& file, std::size_t n_cells, std::size_t n_points, const MeshData& data) {
  const auto check = [&](const std::vector<DataArray>& arrays, std::size_t n) {
    for (const DataArray& array : arrays)
      if (array.n_components == 0 || array.size() != n)
        throw invalid_option(file + ": array \"" + array.name + "\" has " +
                             std::to_string(array.n_components == 0 ? 0 : array.size()) + " rows instead of " +
                             std::to_string(n));
  };
  check(data.cells, n_cells);
  check(data.points, n_points);
}

}  // namespace detail

/// Frames as the four components w x y z of their quaternions, under the name "frame".
inline DataArray frame_array(const std::vector<Quaternion>& frames) {
  std::vector<double> values;
  values.reserve(4 * frames.size());
  for (const Quaternion& q : frames) values.insert(values.end(), {q.w(), q.x(), q.y(), q.z()});
  return {"frame", std::move(values), 4};
}

}  // namespace framehex
