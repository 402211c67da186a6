// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/mesh/concepts.hpp"

#include <cstddef>

// Up to Netgen 6.2.1905 (Debian 12) nglib.h leaves it to its user to open the namespace that the library has. Whoever has
// another version includes nglib.h before this header, as that version wants.
#ifndef NGLIB
namespace nglib {
#include <nglib.h>
}
#endif

/// Netgen, through nglib: tetrahedra as a TetMesh. nglib has no hexahedra, so that results go elsewhere.

namespace framehex {

namespace detail {

using NetgenHandle = nglib::Ng_Mesh;

inline int n_netgen_points(NetgenHandle& mesh) {
  return nglib::Ng_GetNP(&mesh);
}
inline int n_netgen_elements(NetgenHandle& mesh) {
  return nglib::Ng_GetNE(&mesh);
}
inline std::array<double, 3> netgen_point(NetgenHandle& mesh, int point) {
  std::array<double, 3> p{};
  nglib::Ng_GetPoint(&mesh, point, p.data());
  return p;
}
/// The corners of a volume element, counted from 1 and positive, where Netgen's are negative; all zero when it is no
/// tetrahedron.
inline std::array<int, 4> netgen_tet(NetgenHandle& mesh, int element) {
  std::array<int, NG_VOLUME_ELEMENT_MAXPOINTS> v{};
  const nglib::Ng_Volume_Element_Type type = nglib::Ng_GetVolumeElement(&mesh, element, v.data());
  if (type != nglib::NG_TET && type != nglib::NG_TET10) return {};
  return {v[1], v[0], v[2], v[3]};
}

}  // namespace detail

/// The volume elements of a mesh of nglib, which must outlive it. Second-order nodes are passed over, as vertices
/// without a cell.
class NetgenTets {
public:
  /// @throws invalid_connectivity  with the first element that is no tetrahedron, counted from 0.
  explicit NetgenTets(detail::NetgenHandle& mesh) : mesh_(&mesh) {
    for (int c = 0; c < n_cells(); ++c)
      if (detail::netgen_tet(mesh, c + 1)[0] == 0)
        throw invalid_connectivity("element " + std::to_string(c) + " is no tetrahedron", Entity::cell,
                                   {static_cast<std::size_t>(c)});
  }

  int n_points() const { return detail::n_netgen_points(*mesh_); }
  int n_cells() const { return detail::n_netgen_elements(*mesh_); }
  detail::NetgenHandle& data() const { return *mesh_; }

private:
  detail::NetgenHandle* mesh_;
};

template <>
struct mesh_traits<NetgenTets> {
  using vertex_type = int;  // from 0; nglib counts from 1
  using cell_type = int;
  using scalar_type = double;

  static auto vertices(const NetgenTets& view) { return std::views::iota(0, view.n_points()); }
  static auto cells(const NetgenTets& view) { return std::views::iota(0, view.n_cells()); }
  static std::size_t index(const NetgenTets&, int v) { return static_cast<std::size_t>(v); }
  static std::array<double, 3> point(const NetgenTets& view, int v) { return detail::netgen_point(view.data(), v + 1); }
  static std::array<int, 4> cell_vertices(const NetgenTets& view, int c) {
    const std::array<int, 4> v = detail::netgen_tet(view.data(), c + 1);
    return {v[0] - 1, v[1] - 1, v[2] - 1, v[3] - 1};
  }
};
static_assert(TetMesh<NetgenTets>);

}  // namespace framehex
