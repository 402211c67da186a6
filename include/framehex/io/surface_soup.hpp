// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/triangle_soup.hpp"
#include "framehex/mesh/csr.hpp"

#include <map>
#include <span>
#include <string_view>

namespace framehex {

/// The triangles of a file in its order, as they stand there.
struct SurfaceSoup {
  IndexedTriangleMesh mesh;              ///< polygons cut into triangles
  std::vector<index_t> polygons;         ///< n_triangles: number in the file of the polygon a triangle is of, from 0
  std::vector<index_t> patches;          ///< n_triangles labels; empty where the file tells fewer than two
  std::vector<std::string> patch_names;  ///< by label
  double rounding = 0;                   ///< most that a coordinate lost when it was stored in single precision
};

namespace detail {

/// Gathers polygons, which may refer to points that come later, and names of patches.
class SoupBuilder {
public:
  explicit SoupBuilder(std::string name) : name_(std::move(name)) {}

  std::size_t n_points() const { return soup_.mesh.points.size(); }

  void add_point(double x, double y, double z) {
    if (n_points() + 1 >= no_index) throw io_error(name_ + ": holds more vertices than 32 bits can number");
    soup_.mesh.points.emplace_back(x, y, z);
  }

  /// Label of a name, a new one when it is new.
  index_t patch(const std::string& name) {
    const auto [at, is_new] = label_of_name_.try_emplace(name, static_cast<index_t>(soup_.patch_names.size()));
    if (is_new) soup_.patch_names.push_back(name);
    return at->second;
  }

  /// @param corners  points from 0, checked in the end.
  void add_polygon(std::span<const std::int64_t> corners, index_t patch) {
    polygons_.values.insert(polygons_.values.end(), corners.begin(), corners.end());
    polygons_.end_row();
    n_triangles_ += corners.size() < 3 ? 0 : corners.size() - 2;
    if (n_triangles_ >= no_index) throw io_error(name_ + ": holds more triangles than 32 bits can number");
    patches_.push_back(patch);
  }

  /// @throws invalid_connectivity (the polygon) for a point that does not exist; io_error when there is no triangle.
  SurfaceSoup finish() {
    std::vector<index_t> corners;
    for (std::size_t p = 0; p < polygons_.size(); ++p) {
      corners.clear();
      for (const std::int64_t v : polygons_[p]) {
        if (v < 0 || v >= static_cast<std::int64_t>(n_points()))
          throw invalid_connectivity(name_ + ": polygon " + std::to_string(p) + " refers to vertex " +
                                         std::to_string(v) + " of " + std::to_string(n_points()),
                                     Entity::triangle, {p});
        corners.push_back(static_cast<index_t>(v));
      }
      append_polygon(soup_.mesh, corners);
      soup_.polygons.resize(soup_.mesh.triangles.size(), static_cast<index_t>(p));
      soup_.patches.resize(soup_.mesh.triangles.size(), patches_[p]);
    }
    if (soup_.mesh.triangles.empty()) throw io_error(name_ + ": holds no triangles");
    keep_used_patches();
    return std::move(soup_);
  }

private:
  /// Labels count those patches only that have triangles; a single one tells nothing.
  void keep_used_patches() {
    std::vector<index_t> number(soup_.patch_names.size(), no_index);
    std::vector<std::string> names;
    for (index_t& label : soup_.patches) {
      if (number[label] == no_index) {
        number[label] = static_cast<index_t>(names.size());
        names.push_back(soup_.patch_names[label]);
      }
      label = number[label];
    }
    if (names.size() < 2) soup_.patches.clear(), names.clear();
    soup_.patch_names = std::move(names);
  }

  std::string name_;
  SurfaceSoup soup_;
  Csr<std::int64_t> polygons_;
  std::vector<index_t> patches_;  // by polygon
  std::size_t n_triangles_ = 0;
  std::map<std::string, index_t, std::less<>> label_of_name_;
};

/// Half a unit in the last place of a single precision number as large as the largest coordinate.
inline double float_rounding(const std::vector<Vector3>& points) {
  double largest = 0;
  for (const Vector3& p : points)
    if (p.allFinite()) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  return largest * 0x1p-24;
}

}  // namespace detail

/// `surface_of_soup` of the triangles of a file: numbers of polygons and labels of patches go with them.
inline SoupSurface surface_of_soup(const SurfaceSoup& soup) {
  SoupSurface result = surface_of_soup(soup.mesh);
  for (const index_t t : result.soup_triangles) {
    result.polygons.push_back(soup.polygons[t]);
    if (!soup.patches.empty()) result.patches.push_back(soup.patches[t]);
  }
  result.patch_names = soup.patch_names;
  result.rounding = soup.rounding;
  return result;
}

}  // namespace framehex
