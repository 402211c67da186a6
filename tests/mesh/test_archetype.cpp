// SPDX-License-Identifier: BSL-1.0
// A host mesh that offers nothing beyond the concept: every algorithm over a TetMesh must make do with it.
#include "framehex/mesh/boundary.hpp"
#include "framehex/mesh/validation.hpp"
#include "framehex/recombination/pattern_search.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/recombination/potential_prism_finder.hpp"
#include "framehex/recombination/potential_pyramid_finder.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

#include <forward_list>

using namespace framehex;

namespace {

/// Handles that can be copied and nothing else: no default, no comparison, no conversion.
class VertexHandle {
public:
  explicit VertexHandle(unsigned id) : id_(id) {}
  unsigned id() const { return id_; }
  bool operator==(const VertexHandle&) const = delete;

private:
  unsigned id_;
};

class CellHandle {
public:
  explicit CellHandle(const void* cell) : cell_(cell) {}
  const void* cell() const { return cell_; }
  bool operator==(const CellHandle&) const = delete;

private:
  const void* cell_;
};

/// Neither copied nor moved; single precision; ranges that can be walked forward only.
struct ArchetypeMesh {
  ArchetypeMesh() = default;
  ArchetypeMesh(const ArchetypeMesh&) = delete;
  ArchetypeMesh& operator=(const ArchetypeMesh&) = delete;

  struct Cell {
    std::array<unsigned, 4> corners;
  };
  std::forward_list<VertexHandle> vertices;
  std::forward_list<Cell> cells;
  std::vector<std::array<float, 3>> points;
};

struct HostTriangles {};

}  // namespace

template <>
struct framehex::mesh_traits<ArchetypeMesh> {
  using vertex_type = VertexHandle;
  using cell_type = CellHandle;
  using scalar_type = float;
  static const std::forward_list<VertexHandle>& vertices(const ArchetypeMesh& m) { return m.vertices; }
  static auto cells(const ArchetypeMesh& m) {
    return m.cells | std::views::transform([](const ArchetypeMesh::Cell& cell) { return CellHandle(&cell); });
  }
  static std::size_t index(const ArchetypeMesh&, VertexHandle v) { return v.id(); }
  static std::array<float, 3> point(const ArchetypeMesh& m, VertexHandle v) { return m.points[v.id()]; }
  static std::array<VertexHandle, 4> cell_vertices(const ArchetypeMesh&, CellHandle c) {
    const auto& k = static_cast<const ArchetypeMesh::Cell*>(c.cell())->corners;
    return {VertexHandle(k[0]), VertexHandle(k[1]), VertexHandle(k[2]), VertexHandle(k[3])};
  }
};

static_assert(TetMesh<ArchetypeMesh>);
static_assert(!TriangleMesh<ArchetypeMesh>);
static_assert(!TetMesh<HostTriangles>, "an unadapted type is no mesh");
static_assert(!TetMesh<IndexedTriangleMesh> && !TriangleMesh<IndexedTetMesh>);
static_assert(!TetMesh<int>);

TEST_CASE("The least that a host mesh can offer is enough") {
  const auto reference = test::kuhn_lattice(3);
  ArchetypeMesh host;
  auto last_vertex = host.vertices.before_begin();
  for (unsigned v = 0; v < reference.points.size(); ++v) {
    last_vertex = host.vertices.insert_after(last_vertex, VertexHandle(v));
    const auto p = reference.points[v].cast<float>();
    host.points.push_back({p.x(), p.y(), p.z()});
  }
  auto last_cell = host.cells.before_begin();
  for (const auto& tet : reference.tets) last_cell = host.cells.insert_after(last_cell, {tet});

  CHECK(n_vertices(host) == reference.points.size());
  CHECK(tetrahedra(host) == reference.tets);
  CHECK(positions(host) == reference.points);
  CHECK_NOTHROW(validate(host));
  CHECK(extract_boundary(host, make_adjacency(host)).surface.triangles.size() == 108);
  CHECK(find_potential_hexahedra(host).vertices == find_potential_hexahedra(reference).vertices);
  CHECK(find_potential_prisms(host).vertices == find_potential_prisms(reference).vertices);
  CHECK(find_potential_pyramids(host).vertices == find_potential_pyramids(reference).vertices);
  CHECK(find_pattern_hexahedra(host).vertices == find_pattern_hexahedra(reference).vertices);
}
