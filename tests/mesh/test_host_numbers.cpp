// SPDX-License-Identifier: BSL-1.0
// Hosts whose numbers, counts or types of points are not what a careless reader of the concept would write.
#include "framehex/mesh/boundary.hpp"
#include "framehex/mesh/validation.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

#include <functional>

using namespace framehex;
using Catch::Matchers::Contains;

namespace {

/// A point of the host's own: no range, no array, only a conversion.
struct HostPoint {
  double x, y, z;
  operator std::array<double, 3>() const { return {x, y, z}; }
};

/// Numbers its vertices as it likes.
template <std::size_t Corners>
struct NumberedMesh {
  std::vector<HostPoint> points;
  std::vector<std::array<int, Corners>> cells;
  std::function<std::size_t(int)> index = [](int v) { return static_cast<std::size_t>(v); };
};

/// As many vertices and cells as it says, at no memory.
template <std::size_t Corners>
struct CountlessMesh {
  std::uint64_t n_vertices, n_cells;
};

NumberedMesh<4> numbered(const IndexedTetMesh& mesh) {
  NumberedMesh<4> host;
  for (const Vector3& p : mesh.points) host.points.push_back({p.x(), p.y(), p.z()});
  for (const auto& t : mesh.tets)
    host.cells.push_back(
        {static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]), static_cast<int>(t[3])});
  return host;
}

NumberedMesh<3> numbered(const IndexedTriangleMesh& mesh) {
  NumberedMesh<3> host;
  for (const Vector3& p : mesh.points) host.points.push_back({p.x(), p.y(), p.z()});
  for (const auto& t : mesh.triangles)
    host.cells.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  return host;
}

template <class Call>
void check_refused(Call&& call, std::size_t vertex) {
  try {
    call();
    FAIL("accepted");
  } catch (const invalid_connectivity& e) {
    CHECK(e.entity() == Entity::vertex);
    CHECK(e.indices() == std::vector<std::size_t>{vertex});
  }
}

}  // namespace

template <std::size_t Corners>
struct framehex::mesh_traits<NumberedMesh<Corners>> {
  using M = NumberedMesh<Corners>;
  using vertex_type = int;
  using cell_type = int;
  using scalar_type = double;
  static auto vertices(const M& m) { return std::views::iota(0, static_cast<int>(m.points.size())); }
  static auto cells(const M& m) { return std::views::iota(0, static_cast<int>(m.cells.size())); }
  static std::size_t index(const M& m, int v) { return m.index(v); }
  static HostPoint point(const M& m, int v) { return m.points[static_cast<std::size_t>(v)]; }
  static std::array<int, Corners> cell_vertices(const M& m, int c) { return m.cells[static_cast<std::size_t>(c)]; }
};

template <std::size_t Corners>
struct framehex::mesh_traits<CountlessMesh<Corners>> {
  using M = CountlessMesh<Corners>;
  using vertex_type = std::uint64_t;
  using cell_type = std::uint64_t;
  using scalar_type = double;
  static auto vertices(const M& m) { return std::views::iota(std::uint64_t{0}, m.n_vertices); }
  static auto cells(const M& m) { return std::views::iota(std::uint64_t{0}, m.n_cells); }
  static std::size_t index(const M&, std::uint64_t v) { return v; }
  static std::array<double, 3> point(const M&, std::uint64_t) { return {0, 0, 0}; }
  static std::array<std::uint64_t, Corners> cell_vertices(const M&, std::uint64_t) { return {}; }
};

static_assert(TetMesh<NumberedMesh<4>> && TriangleMesh<NumberedMesh<3>>);

TEST_CASE("a point that converts to an array is enough", "[regression]") {
  const IndexedTetMesh lattice = test::kuhn_lattice(2);
  const auto host = numbered(lattice);
  CHECK(validated_adjacency(host).neighbours == make_adjacency(lattice).neighbours);
  CHECK(positions(host) == lattice.points);
  CHECK_NOTHROW(validate_closed(numbered(extract_boundary(lattice, make_adjacency(lattice)).surface)));
}

TEST_CASE("index() must count the vertices in their order, in full", "[regression]") {
  const IndexedTetMesh lattice = test::kuhn_lattice(3);
  auto host = numbered(lattice);
  auto surface = numbered(extract_boundary(lattice, make_adjacency(lattice)).surface);
  const auto check = [&](auto&& index, std::size_t first_wrong) {
    host.index = surface.index = [&](int v) { return static_cast<std::size_t>(index(v)); };
    check_refused([&] { validate(host); }, first_wrong);
    check_refused([&] { validate_closed(surface); }, first_wrong);
  };
  const auto u = [](int v) { return static_cast<std::uint64_t>(v); };
  check([&](int v) { return u(v) + 1; }, 0);
  check([&](int v) { return u(v) + (std::uint64_t{7} << 32); }, 0);  // is v, cut to 32 bits
  check([&](int v) { return v == 9 ? 10 : v == 10 ? 9 : u(v); }, 9);
  check([&](int v) { return u(v) / 2; }, 1);
  // Turned by half a turn about z: every cell stays positive.
  check([&](int v) { return (3 - u(v) % 4) + 4 * (3 - u(v) / 4 % 4) + u(v) / 16 * 16; }, 0);
}

TEST_CASE("a handle of a cell that is no vertex is refused with the number it has") {
  auto host = numbered(test::kuhn_lattice(2));
  host.cells[7][2] = -1;
  CHECK_THROWS_WITH(validate(host), Contains("cell 7") && Contains("vertex -1 of 27"));
}

TEST_CASE("more vertices, cells or half edges than 32 bits count are refused before they are looked at",
          "[regression]") {
  constexpr std::uint64_t most = no_index;
  CHECK_THROWS_WITH(validate(CountlessMesh<4>{most + 1, 0}), Contains("4294967296 vertices"));
  CHECK_THROWS_WITH(make_adjacency(CountlessMesh<4>{most + 1, 0}), Contains("4294967296 vertices"));
  CHECK_THROWS_WITH(validate(CountlessMesh<4>{4, most + 1}), Contains("4294967296 cells"));
  CHECK_THROWS_WITH(validate_closed(CountlessMesh<3>{4, most / 3 + 1}), Contains("1431655766 cells"));
  CHECK_THROWS_AS(detail::check_count(most / 3 + 1, TriangleAdjacency::most_triangles, "triangles"),
                  invalid_connectivity);
  CHECK_NOTHROW(detail::check_count(most / 3, TriangleAdjacency::most_triangles, "triangles"));
}
