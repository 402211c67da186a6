// SPDX-License-Identifier: BSL-1.0
#include "support/host_reference.hpp"
#include "support/kuhn_lattice.hpp"

namespace framehex::test {

namespace {

HostReference make_reference() {
  HostReference r;
  r.mesh = kuhn_lattice(4, 3, 3);
  for (const auto& t : r.mesh.tets) {
    double x = 0;
    for (const index_t v : t) x += r.mesh.points[v].x() / 4;
    r.regions.push_back(x < 2 ? 1 : 4);
  }
  const BoundarySurface boundary = extract_boundary(r.mesh, make_adjacency(r.mesh));
  for (const auto& t : boundary.surface.triangles) {
    const std::array<index_t, 4> v{boundary.vertex_of[t[0]], boundary.vertex_of[t[1]], boundary.vertex_of[t[2]],
                                   no_index};
    const bool at_zero = std::all_of(v.begin(), v.begin() + 3, [&](index_t i) { return r.mesh.points[i].x() == 0; });
    if (at_zero) r.faces.push_back({v, 7});
  }
  const auto vertex = [](index_t i, index_t j, index_t k) { return i + 5 * (j + 4 * k); };
  // Through a cube inside, which is left in tetrahedra behind pyramids; across a column of cubes, which become prisms.
  r.edges.push_back({{vertex(1, 1, 1), vertex(2, 2, 2)}, 2});
  for (index_t k = 0; k <= 3; ++k) r.edges.push_back({{vertex(3, 2, k), vertex(4, 3, k)}, 2});
  for (Vector3& p : r.mesh.points) p += Vector3(0.1 * p.y(), 0.07 * p.z(), 0.03 * p.x());
  r.candidates = find_potential_hexahedra(r.mesh);
  r.result = recombine(r.mesh, {.regions = r.regions, .faces = r.faces, .edges = r.edges});
  for (const CellKind kind : all_cell_kinds)
    if (std::ranges::find(r.result.mesh.kinds, kind) == r.result.mesh.kinds.end())
      throw std::logic_error("the reference lacks a kind of cells");
  r.result.mesh.groups = {{3, 0, "steel", {1}}, {3, 1, "copper", {4}}, {2, 0, "inlet", {7}}};
  return r;
}

}  // namespace

const HostReference& host_reference() {
  static const HostReference reference = make_reference();
  return reference;
}

}  // namespace framehex::test
