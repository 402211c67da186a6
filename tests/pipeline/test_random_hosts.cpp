// SPDX-License-Identifier: BSL-1.0
// Results of `recombine` lead back to the host: vertices, cells, labels. Or the host is told what is wrong, by number.
#include "framehex/assembly/detail/cell_complex.hpp"
#include "framehex/pipeline/recombine.hpp"
#include "framehex/verify/validity.hpp"
#include "support/jittered_delaunay.hpp"

#include <catch2/catch.hpp>

#include <map>
#include <numeric>
#include <set>

using namespace framehex;

namespace {

/// Handles have gaps and are in no order; a vertex and a cell know the number that results are given in.
struct GappedMesh {
  std::vector<Vector3> place;                   // by handle
  std::vector<std::size_t> number;              // by handle
  std::vector<long> vertices, cells;            // handles, in the order of the numbers
  std::vector<std::array<long, 4>> corners_of;  // by handle
};

}  // namespace

template <>
struct framehex::mesh_traits<GappedMesh> {
  using vertex_type = long;
  using cell_type = long;
  using scalar_type = double;
  static const std::vector<long>& vertices(const GappedMesh& m) { return m.vertices; }
  static const std::vector<long>& cells(const GappedMesh& m) { return m.cells; }
  static std::size_t index(const GappedMesh& m, long v) { return m.number[static_cast<std::size_t>(v)]; }
  static std::array<double, 3> point(const GappedMesh& m, long v) {
    const Vector3& p = m.place[static_cast<std::size_t>(v)];
    return {p.x(), p.y(), p.z()};
  }
  static std::array<long, 4> cell_vertices(const GappedMesh& m, long c) {
    return m.corners_of[static_cast<std::size_t>(c)];
  }
};

namespace {

using Engine = std::mt19937_64;

template <class T>
void shuffle(std::vector<T>& v, Engine& engine) {
  for (std::size_t i = v.size(); i > 1; --i) std::swap(v[i - 1], v[engine() % i]);
}

/// The mesh with its vertices and cells in another order, isolated vertices among them and handles with gaps.
GappedMesh as_host(const IndexedTetMesh& mesh, Engine& engine) {
  GappedMesh host;
  std::vector<index_t> order(mesh.points.size() + engine() % 4);  // what is beyond the mesh is isolated
  std::iota(order.begin(), order.end(), index_t{0});
  shuffle(order, engine);
  std::vector<long> handles(2 * order.size());
  std::iota(handles.begin(), handles.end(), 0);
  shuffle(handles, engine);
  host.place.assign(handles.size(), Vector3::Constant(std::nan("")));
  host.number.assign(handles.size(), 12345);
  std::vector<long> handle_of(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const long handle = handles[i];
    const auto h = static_cast<std::size_t>(handle);
    host.place[h] = order[i] < mesh.points.size() ? mesh.points[order[i]] : Vector3(50, static_cast<double>(i), 0);
    host.number[h] = i;
    host.vertices.push_back(handle);
    handle_of[order[i]] = handle;
  }
  host.corners_of.assign(2 * mesh.tets.size(), {-1, -1, -1, -1});
  std::vector<std::size_t> tets(mesh.tets.size());
  std::iota(tets.begin(), tets.end(), std::size_t{0});
  shuffle(tets, engine);
  for (std::size_t i = 0; i < tets.size(); ++i) {
    const auto& t = mesh.tets[tets[i]];
    host.cells.push_back(static_cast<long>(2 * tets[i] + 1));
    host.corners_of[2 * tets[i] + 1] = {handle_of[t[0]], handle_of[t[1]], handle_of[t[2]], handle_of[t[3]]};
  }
  return host;
}

/// Regions by a plane or at random, labels on random facets and edges.
struct Labels {
  std::vector<index_t> regions;
  std::vector<LabelledFace> faces;
  std::vector<LabelledEdge> edges;
};

Labels random_labels(const TetAdjacency& adjacency, const std::vector<Vector3>& points, Engine& engine) {
  Labels labels;
  const std::uint64_t kind = engine() % 3;
  if (kind > 0)
    for (const auto& t : adjacency.tets) {
      const double x = (points[t[0]] + points[t[1]] + points[t[2]] + points[t[3]]).x() / 4;
      labels.regions.push_back(kind == 1 ? (x < 1.5 ? 4 : 9) : static_cast<index_t>(engine() % 20 / 19));
    }
  const std::size_t n_faces = engine() % 12, n_edges = engine() % 6;
  std::set<std::array<index_t, 3>> taken;
  while (labels.faces.size() < n_faces) {
    const auto t = facet(adjacency.tets[engine() % adjacency.tets.size()], static_cast<int>(engine() % 4));
    if (!taken.insert(detail::sorted(t)).second) continue;
    // Each facet has a label of its own: it has to come back as it was.
    labels.faces.push_back({{t[0], t[1], t[2], no_index}, static_cast<index_t>(100 + labels.faces.size())});
  }
  for (std::size_t i = 0; i < n_edges; ++i) {
    const auto& t = adjacency.tets[engine() % adjacency.tets.size()];
    const std::size_t a = engine() % 4;
    labels.edges.push_back({{t[a], t[(a + 1 + engine() % 3) % 4]}, static_cast<index_t>(i)});
  }
  return labels;
}

void check_vertices(const Recombination& result, const std::vector<Vector3>& host, bool all_stay) {
  REQUIRE(result.result_of.size() == host.size());
  REQUIRE(result.vertex_of.size() == result.mesh.points.size());
  REQUIRE(result.mesh.points.size() >= host.size());
  std::set<index_t> moved;
  for (index_t v = 0; v < host.size(); ++v) {
    CHECK((result.result_of[v] == v || result.result_of[v] == no_index));
    CHECK(result.vertex_of[v] == result.result_of[v]);
    if (result.mesh.points[v] != host[v]) moved.insert(v);
  }
  CHECK(result.moved == std::vector<index_t>(moved.begin(), moved.end()));
  for (std::size_t v = host.size(); v < result.vertex_of.size(); ++v) CHECK(result.vertex_of[v] == no_index);
  std::vector<std::uint8_t> used(result.mesh.points.size(), 0);
  for (const index_t v : result.mesh.cells.values) used[v] = 1;
  std::size_t n_removed = 0;
  for (index_t v = 0; v < host.size(); ++v)
    if (result.result_of[v] == no_index) {
      CHECK(!used[v]);
      ++n_removed;
    }
  CHECK(n_removed == result.assembly.n_removed_vertices);
  if (all_stay) CHECK((n_removed == 0 && moved.empty()));
}

/// The facets that only one of some tetrahedra has are the faces of the cell, cut in triangles.
void check_filled(const MixedMesh& mesh, std::size_t cell, std::span<const index_t> tets,
                  const TetAdjacency& adjacency) {
  std::set<std::array<index_t, 3>> once;
  for (const index_t tet : tets)
    for (int i = 0; i < 4; ++i) {
      const auto key = detail::sorted(facet(adjacency.tets[tet], i));
      if (!once.insert(key).second) once.erase(key);
    }
  const auto corners = mesh.cells[cell];
  std::size_t n_expected = 0;
  for (const LocalFace& face : faces_of(mesh.kinds[cell])) {
    const auto n = static_cast<std::size_t>(face.size());
    std::set<index_t> vertices;
    for (std::size_t i = 0; i < n; ++i) vertices.insert(corners[static_cast<std::size_t>(face.corners[i])]);
    n_expected += n - 2;
    const auto on_face = std::ranges::count_if(once, [&](const auto& t) {
      return vertices.contains(t[0]) && vertices.contains(t[1]) && vertices.contains(t[2]);
    });
    CHECK(static_cast<std::size_t>(on_face) == n - 2);
  }
  CHECK(once.size() == n_expected);
}

void check_cells(const Recombination& result, const TetAdjacency& adjacency, std::span<const index_t> regions) {
  REQUIRE(result.cell_of.size() == result.mesh.n_cells());
  REQUIRE(result.candidate_of.size() == result.mesh.n_cells());
  std::vector<std::uint8_t> taken(adjacency.tets.size(), 0);
  for (std::size_t cell = 0; cell < result.mesh.n_cells(); ++cell) {
    const auto tets = result.cell_of[cell];
    const bool is_hexahedron = result.mesh.kinds[cell] == CellKind::hexahedron;
    CHECK((result.candidate_of[cell] != no_index) == is_hexahedron);
    if (is_hexahedron) CHECK(tets.size() >= 5);
    CHECK(std::ranges::is_sorted(tets));
    for (const index_t tet : tets) {
      REQUIRE(tet < taken.size());
      CHECK(std::exchange(taken[tet], std::uint8_t{1}) == 0);
      if (!regions.empty()) CHECK(regions[tet] == result.mesh.regions[cell]);
    }
    if (!tets.empty()) check_filled(result.mesh, cell, tets, adjacency);
  }
}

void check_labels(const Recombination& result, const Labels& labels) {
  std::map<index_t, std::vector<std::array<index_t, 4>>> by_label;
  for (const LabelledFace& face : result.mesh.faces) by_label[face.label].push_back(face.vertices);
  for (const LabelledFace& face : labels.faces) {
    const auto& found = by_label[face.label];
    CAPTURE(face.label);
    REQUIRE(found.size() == 1);
    CHECK(detail::rotated(found[0]) == detail::rotated(face.vertices));
  }
  // What is left is the boundary without labels, and has a label that nobody gave.
  const index_t unlabelled = labels.faces.empty() ? 0 : labels.faces.back().label + 1;
  for (const auto& [label, faces] : by_label) CHECK((label == unlabelled || label >= 100));
  std::set<std::array<index_t, 2>> edges;
  for (std::size_t cell = 0; cell < result.mesh.n_cells(); ++cell)
    for (const auto& e : edges_of(result.mesh.kinds[cell])) {
      const index_t v = result.mesh.cells[cell][static_cast<std::size_t>(e[0])];
      const index_t w = result.mesh.cells[cell][static_cast<std::size_t>(e[1])];
      edges.insert({std::min(v, w), std::max(v, w)});
    }
  REQUIRE(result.mesh.edges.size() == labels.edges.size());
  for (std::size_t i = 0; i < labels.edges.size(); ++i) {
    const auto [v, w] = result.mesh.edges[i].vertices;
    CHECK(result.mesh.edges[i].vertices == labels.edges[i].vertices);  // host numbers are kept
    CHECK(result.mesh.edges[i].label == labels.edges[i].label);
    CHECK(edges.contains({std::min(v, w), std::max(v, w)}));
  }
}

}  // namespace

TEST_CASE("results on random hosts lead back to their vertices, cells and labels", "[regression]") {
  std::size_t n_hexahedra = 0, n_faces = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    CAPTURE(seed);
    Engine engine(seed);
    const GappedMesh host =
        as_host(test::jittered_delaunay(3 + seed % 2, seed, 0.05 * static_cast<double>(seed % 10)), engine);
    const TetAdjacency adjacency = validated_adjacency(host);
    const std::vector<Vector3> points = positions(host);
    const Labels labels = random_labels(adjacency, points, engine);
    RecombineOptions options{.regions = labels.regions, .faces = labels.faces, .edges = labels.edges};
    options.finder.quality_floor = seed % 4 == 0 ? 0.02 : 0.2;
    options.finder.boundary_rule = seed % 5 == 0 ? BoundaryRule::ignore : BoundaryRule::both_or_neither;
    options.selection.method = SelectMethod::greedy;
    options.assembly.interfaces = seed % 3 == 0   ? InterfaceMode::no_pyramids
                                  : seed % 7 == 0 ? InterfaceMode::open
                                                  : InterfaceMode::conforming;
    options.assembly.improvement = seed % 2 == 0 ? ImprovementMode::none : ImprovementMode::improve;
    const Recombination result = recombine(host, options);
    check_vertices(result, points, options.assembly.improvement == ImprovementMode::none);
    check_cells(result, adjacency, labels.regions);
    check_labels(result, labels);
    CHECK(verify::is_valid(result.mesh));
    if (options.assembly.interfaces != InterfaceMode::open) CHECK(verify::is_conforming(result.mesh));
    for (const index_t c : result.candidate_of) n_hexahedra += c != no_index;
    n_faces += labels.faces.size();

    options.assembly.vertex_numbers = VertexNumbers::compact;
    const Recombination compact = recombine(host, options);
    CHECK(compact.mesh.n_cells() == result.mesh.n_cells());
    std::vector<std::uint8_t> used(compact.mesh.points.size(), 0);
    for (const index_t v : compact.mesh.cells.values) used[v] = 1;
    CHECK(std::ranges::count(used, 0) == 0);
    for (index_t v = 0; v < compact.vertex_of.size(); ++v)
      if (compact.vertex_of[v] != no_index) {
        CHECK(compact.result_of[compact.vertex_of[v]] == v);
        CHECK(compact.mesh.points[v] == result.mesh.points[compact.vertex_of[v]]);
      }
  }
  CHECK(n_hexahedra > 1000);
  CHECK(n_faces > 500);
}

TEST_CASE("labels that name nothing of the mesh are refused with their position", "[regression]") {
  Engine engine(7);
  const GappedMesh host = as_host(test::jittered_delaunay(3, 1, 0.2), engine);
  const TetAdjacency adjacency = validated_adjacency(host);
  const auto n = static_cast<index_t>(adjacency.n_vertices());
  const auto good = facet(adjacency.tets[5], 1);
  index_t far = 0;  // no neighbour of good[0]
  while (std::ranges::binary_search(adjacency.vertices_of_vertex[good[0]], far) || far == good[0]) ++far;
  const auto refused = [&](RecombineOptions options, Entity entity, std::vector<std::size_t> positions) {
    const auto check = [&](auto&& call) {
      try {
        call();
        FAIL("accepted");
      } catch (const invalid_option& e) {
        CHECK(e.entity() == entity);
        CHECK(e.indices() == positions);
      }
    };
    check([&] { recombine(host, options); });
    options.assembly.regions = options.regions;
    options.assembly.faces = options.faces;
    options.assembly.edges = options.edges;
    check([&] { assemble(host, adjacency, PotentialHexahedra{}, {}, options.assembly); });
  };
  const std::array<index_t, 4> face{good[0], good[1], good[2], no_index};
  for (const std::array<index_t, 4>& bad :
       {std::array<index_t, 4>{good[0], good[1], far, no_index}, std::array<index_t, 4>{good[0], good[1], good[2], far},
        std::array<index_t, 4>{good[0], good[1], n, no_index},
        std::array<index_t, 4>{good[0], good[0], good[1], no_index},
        std::array<index_t, 4>{no_index, good[0], good[1], no_index}}) {
    const std::vector<LabelledFace> faces{{face, 3}, {face, 3}, {bad, 4}};
    refused({.faces = faces}, Entity::labelled_face, {2});
  }
  const std::vector<LabelledFace> twice{{face, 3}, {{good[1], good[0], good[2], no_index}, 4}};
  refused({.faces = twice}, Entity::labelled_face, {0, 1});
  const std::vector<LabelledFace> none{{face, no_index}};
  refused({.faces = none}, Entity::labelled_face, {0});
  for (const std::array<index_t, 2>& bad :
       {std::array<index_t, 2>{good[0], far}, std::array<index_t, 2>{good[0], good[0]},
        std::array<index_t, 2>{good[0], n}, std::array<index_t, 2>{no_index, good[0]}}) {
    const std::vector<LabelledEdge> edges{{{good[0], good[1]}, 1}, {bad, 1}};
    refused({.edges = edges}, Entity::labelled_edge, {1});
  }
  const std::vector<index_t> regions(5, 0);
  refused({.regions = regions}, Entity::none, {});
}
