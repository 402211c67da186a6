// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/detail/points_in_cavities.hpp"
#include "framehex/mesh/concepts.hpp"
#include "framehex/mesh/mixed_mesh.hpp"
#include "framehex/surface/self_intersection.hpp"
#include "framehex/tetrahedralization/tetrahedralizer.hpp"

#ifndef TETLIBRARY
#define TETLIBRARY
#endif
#include <tetgen.h>

/// TetGen's `tetgenio` as a TetMesh, its labels, and TetGen as a Tetrahedralizer within the process.
///
/// TetGen is under the AGPL: a program that includes this header is bound by it. `tetgen_process.hpp` is not.
namespace framehex {

template <>
struct mesh_traits<tetgenio> {
  using vertex_type = int;
  using cell_type = int;
  using scalar_type = double;

  static auto vertices(const tetgenio& mesh) { return std::views::iota(0, mesh.numberofpoints); }
  static auto cells(const tetgenio& mesh) { return std::views::iota(0, mesh.numberoftetrahedra); }
  static std::size_t index(const tetgenio&, int v) { return static_cast<std::size_t>(v); }
  static std::array<double, 3> point(const tetgenio& mesh, int v) {
    const double* const p = mesh.pointlist + 3 * static_cast<std::ptrdiff_t>(v);
    return {p[0], p[1], p[2]};
  }
  /// The four corners, also of tetrahedra with nodes on their edges.
  static std::array<int, 4> cell_vertices(const tetgenio& mesh, int c) {
    const int* const t = mesh.tetrahedronlist + static_cast<std::ptrdiff_t>(mesh.numberofcorners) * c;
    return {t[0] - mesh.firstnumber, t[1] - mesh.firstnumber, t[2] - mesh.firstnumber, t[3] - mesh.firstnumber};
  }
};
static_assert(TetMesh<tetgenio>);

/// Regions of the tetrahedra: their last attribute (TetGen's switch A), empty when there are none.
///
/// @throws invalid_option  with the first tetrahedron whose attribute is no whole number from 0 on.
inline std::vector<index_t> tetgen_regions(const tetgenio& mesh) {
  std::vector<index_t> regions;
  const int n = mesh.numberoftetrahedronattributes;
  if (n == 0) return regions;
  for (std::size_t c = 0; c < static_cast<std::size_t>(mesh.numberoftetrahedra); ++c) {
    const double attribute = mesh.tetrahedronattributelist[(c + 1) * static_cast<std::size_t>(n) - 1];
    if (!(attribute >= 0 && attribute < no_index) || attribute != std::floor(attribute))
      throw invalid_option("tetrahedron " + std::to_string(c) + " has an attribute that is no label of a region",
                           Entity::cell, {c});
    regions.push_back(static_cast<index_t>(attribute));
  }
  return regions;
}

/// Faces with a positive marker; TetGen marks those that lie on no facet of its input with 0 or -1.
inline std::vector<LabelledFace> tetgen_faces(const tetgenio& mesh) {
  std::vector<LabelledFace> faces;
  if (!mesh.trifacemarkerlist) return faces;
  for (std::ptrdiff_t f = 0; f < mesh.numberoftrifaces; ++f) {
    if (mesh.trifacemarkerlist[f] <= 0) continue;
    const int* const v = mesh.trifacelist + 3 * f;
    const auto number = [&](int i) { return static_cast<index_t>(v[i] - mesh.firstnumber); };
    faces.push_back({{number(0), number(1), number(2), no_index}, static_cast<index_t>(mesh.trifacemarkerlist[f])});
  }
  return faces;
}

/// Edges with a positive marker.
inline std::vector<LabelledEdge> tetgen_edges(const tetgenio& mesh) {
  std::vector<LabelledEdge> edges;
  if (!mesh.edgemarkerlist) return edges;
  for (std::ptrdiff_t e = 0; e < mesh.numberofedges; ++e) {
    if (mesh.edgemarkerlist[e] <= 0) continue;
    const int* const v = mesh.edgelist + 2 * e;
    edges.push_back({{static_cast<index_t>(v[0] - mesh.firstnumber), static_cast<index_t>(v[1] - mesh.firstnumber)},
                     static_cast<index_t>(mesh.edgemarkerlist[e])});
  }
  return edges;
}

namespace detail {

/// A surface, points and where its cavities are as TetGen's input. What `tetgenio` frees is allocated as it frees it.
inline void fill_tetgen_input(const TetrahedralizationRequest& request, tetgenio& in) {
  in.numberofpoints = static_cast<int>(request.points.size());
  in.pointlist = new double[3 * request.points.size()];
  for (std::size_t v = 0; v < request.points.size(); ++v)
    std::copy_n(request.points[v].data(), 3, in.pointlist + 3 * v);
  in.facetlist = new tetgenio::facet[request.triangles.size()];
  for (const auto& triangle : request.triangles) {
    tetgenio::facet& facet = in.facetlist[in.numberoffacets++];
    tetgenio::init(&facet);
    facet.polygonlist = new tetgenio::polygon[1];
    facet.numberofpolygons = 1;
    tetgenio::polygon& polygon = facet.polygonlist[0];
    tetgenio::init(&polygon);
    polygon.vertexlist = new int[3];
    polygon.numberofvertices = 3;
    for (std::size_t i = 0; i < 3; ++i) polygon.vertexlist[i] = static_cast<int>(triangle[i]);
  }
  const std::vector<Vector3> holes = points_in_cavities(request.points, request.triangles);
  in.numberofholes = static_cast<int>(holes.size());
  in.holelist = new double[3 * holes.size()];
  for (std::size_t h = 0; h < holes.size(); ++h) std::copy_n(holes[h].data(), 3, in.holelist + 3 * h);
}

}  // namespace detail

/// Tetrahedralizer that calls the library TetGen 1.5 within the process: no files, but a crash of TetGen is one of the
/// host, and it cannot be stopped while it works. TetGen aborts on surfaces that cross themselves; they are refused
/// before.
///
/// @throws invalid_surface naming two triangles that cross; tetrahedralization_error when TetGen fails otherwise.
/// @par Determinism   TetGen's: the same input gives the same mesh. TetGen has global state: one call at a time.
struct TetgenLibrary {
  /// As those of `TetgenProcess`.
  std::string switches = "pYJO2/1M0/1FQ";

  TetrahedralizationResult operator()(const TetrahedralizationRequest& request) const {
    if (!refuse_self_intersection(TriangleView{request.points, request.triangles}, request.observer))
      return {{}, {}, Status::cancelled};
    tetgenio in, out;
    detail::fill_tetgen_input(request, in);
    std::string text = switches;
    try {
      ::tetrahedralize(text.data(), &in, &out);
    } catch (const int code) {
      throw tetrahedralization_error("tetgen failed with code " + std::to_string(code));
    }
    TetrahedralizationResult result;
    const std::size_t n = request.points.size();
    const std::vector<Vector3> points = positions(out);
    for (std::size_t v = 0; v < n; ++v)
      if (v >= points.size() || points[v] != request.points[v])
        throw tetrahedralization_error("tetgen renumbered its input at point " + std::to_string(v), Entity::vertex,
                                       {v});
    result.extra_points.assign(points.begin() + static_cast<std::ptrdiff_t>(n), points.end());
    result.tets = tetrahedra(out);
    return result;
  }
};
static_assert(Tetrahedralizer<TetgenLibrary>);

}  // namespace framehex
