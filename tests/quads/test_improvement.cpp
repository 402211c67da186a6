// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/lemon_matcher.hpp"
#include "framehex/quads/even_intervals.hpp"
#include "framehex/quads/improvement.hpp"
#include "framehex/quads/quadrangulate.hpp"

#include "support/complexes.hpp"
#include "support/flat_delaunay.hpp"
#include "support/quad_checks.hpp"
#include "support/surfaces.hpp"

#include <boost/random/uniform_int_distribution.hpp>
#include <catch2/catch.hpp>

using namespace framehex;
using namespace framehex::test;

namespace {

QuadMesh written(const detail::EditableQuads& quads) {
  QuadMesh mesh;
  for (index_t v = 0; v < quads.points.size(); ++v) mesh.points.push_back(quads.points[v]);
  for (index_t q = 0; q < quads.corners.size(); ++q)
    if (quads.alive(q)) mesh.cells.push_back(quads.corners[q]);
  return mesh;
}

/// Are neighbours mutual, counts right, and fans whole?
void check_whole(const detail::EditableQuads& quads) {
  std::vector<index_t> n_cells(quads.points.size(), 0);
  for (index_t q = 0; q < quads.corners.size(); ++q) {
    if (!quads.alive(q)) continue;
    for (index_t h = 4 * q; h < 4 * q + quads.size(q); ++h) {
      ++n_cells[quads.from(h)];
      const index_t g = quads.opposite[h];
      if (g == no_index) continue;
      REQUIRE(quads.alive(g / 4));
      REQUIRE(quads.opposite[g] == h);
      REQUIRE(quads.from(g) == quads.to(h));
      REQUIRE(quads.to(g) == quads.from(h));
    }
  }
  for (index_t v = 0; v < n_cells.size(); ++v) {
    REQUIRE(quads.n_cells[v] == n_cells[v]);
    index_t n_reached = 0;
    quads.for_each_outgoing(v, [&](index_t h) {
      REQUIRE(quads.from(h) == v);
      ++n_reached;
    });
    REQUIRE(n_reached == n_cells[v]);
  }
}

}  // namespace

TEST_CASE("changes of quadrilaterals leave a whole mesh, and are taken back without a trace") {
  std::mt19937_64 engine(12);
  const auto pick = [&](std::size_t n) {
    return boost::random::uniform_int_distribution<index_t>(0, static_cast<index_t>(n - 1))(engine);
  };
  const Surface surface(box_surface({1, 1, 1}, 6, 6, 6));
  const QuadMesh mesh = quadrangulate(surface, LemonMatcher{}).mesh;
  detail::EditableQuads quads(mesh);
  check_whole(quads);
  std::size_t n_done = 0;
  for (int i = 0; i < 600; ++i) {
    const index_t h = pick(4 * quads.corners.size());
    if (!quads.alive(h / 4) || quads.opposite[h] == no_index) continue;
    const index_t g = quads.opposite[h], a = quads.from(h), b = quads.to(h);
    std::set<index_t> corners;
    for (const index_t q : {h / 4, g / 4})
      for (const index_t v : quads.corners[q]) corners.insert(quads.name[v]);
    const auto few = [&](index_t v) { return quads.n_cells[v] < (quads.is_inside(v) ? 4U : 2U); };
    if (corners.size() != 6 || few(a) || few(b)) continue;
    const QuadMesh before = written(quads);
    quads.mark();
    switch (i % 4) {
      case 0: quads.rotate(h); break;
      case 1:
        quads.insert(
            h, i % 8 == 1 ? detail::EditableQuads::Corners::with_end : detail::EditableQuads::Corners::with_start);
        break;
      case 2: quads.pillow(h / 4); break;
      default: {
        index_t k = h;
        for (int step = 0; step < 2; ++step)
          k = quads.opposite[quads.previous(k)] == no_index ? k : quads.opposite[quads.previous(k)];
        if (k == h || quads.opposite[k] == no_index || quads.n_cells[a] < 4) break;
        const index_t w = quads.split(h, k);
        check_whole(quads);
        if (i % 8 == 3) {
          // The new cell's corner that is the new vertex goes back onto the old one.
          const index_t cell = static_cast<index_t>(quads.corners.size() - 1);
          REQUIRE(quads.from(4 * cell + 2) == w);
          if (quads.n_cells[quads.to(h)] > 2 && quads.n_cells[quads.to(k)] > 2) quads.collapse(4 * cell + 2);
        }
      }
    }
    check_whole(quads);
    ++n_done;
    if (i % 3 == 0) {
      quads.keep();
    } else {
      quads.take_back();
      check_whole(quads);
      const QuadMesh after = written(quads);
      CHECK(after.cells == before.cells);
      CHECK(after.points == before.points);
    }
  }
  CHECK(n_done > 200);
}

TEST_CASE("improvement of random meshes: no doublets, rims and corners in their places, no folded cell") {
  std::mt19937_64 engine(31);
  for (int i = 0; i < 8; ++i) {
    const Surface surface(flat_delaunay(random_flat_points(44, engine)));
    const Quadrangulation raw = quadrangulate(surface, LemonMatcher{});
    const QuadImprovement better = improve_quads(raw.mesh, FeatureCarriers(surface));
    CAPTURE(i);
    CHECK(topology_fault(better.mesh) == std::nullopt);
    CHECK(better.mesh.n_triangles() == raw.mesh.n_triangles());
    CHECK(euler_characteristic(better.mesh) == 1);
    CHECK(rim_sides(better.mesh).size() == rim_sides(raw.mesh).size());
    std::map<index_t, int> n_cells;
    for (const auto& cell : better.mesh.cells)
      for (const index_t v : cell)
        if (v != no_index) ++n_cells[v];
    std::set<index_t> rim;
    for (const auto& [a, b] : rim_sides(better.mesh)) rim.insert({a, b});
    for (const auto& [v, n] : n_cells) CHECK((rim.contains(v) || n > 2));
    for (std::size_t k = 0; k < better.mesh.corners.size(); ++k)
      CHECK(better.mesh.points[better.mesh.corners[k]] == raw.mesh.points[raw.mesh.corners[k]]);
    for (const index_t v : rim) {  // on their curve
      double nearest = 1;
      for (std::size_t c = 0; c < surface.features.curves.size(); ++c)
        nearest =
            std::min(nearest, (FeatureCarriers(surface).onto_curve(static_cast<index_t>(c), better.mesh.points[v]) -
                               better.mesh.points[v])
                                  .norm());
      CHECK(nearest < 1e-12);
    }
  }
}

TEST_CASE("a doublet goes, and a grid stays as it is") {
  QuadMesh mesh;
  mesh.points = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}};
  mesh.cells = {{0, 1, 2, 4}, {0, 4, 2, 3}};
  mesh.patches = {0, 0};
  const Surface square(IndexedTriangleMesh{{mesh.points.begin(), mesh.points.begin() + 4}, {{0, 1, 2}, {0, 2, 3}}});
  const QuadImprovement better = improve_quads(mesh, FeatureCarriers(square));
  REQUIRE(better.mesh.cells.size() == 1);
  CHECK(better.vertex_of == std::vector<index_t>{0, 1, 2, 3});
  CHECK(better.folded.empty());

  const Surface box(box_surface({1, 2, 3}, 3, 4, 5));
  const QuadMesh grid = quadrangulate(box, LemonMatcher{}).mesh;
  const QuadImprovement same = improve_quads(grid, FeatureCarriers(box));
  CHECK(same.n_changes == 0);
  CHECK(same.mesh.cells == grid.cells);
}

TEST_CASE("improvement checks its options and labels, and can be cancelled") {
  const Surface box(box_surface({1, 1, 1}, 2, 2, 2));
  QuadMesh mesh = quadrangulate(box, LemonMatcher{}).mesh;
  const FeatureCarriers carriers(box);
  CHECK_THROWS_AS(improve_quads(mesh, carriers, {.sweeps = -1}), invalid_option);
  CHECK(improve_quads(mesh, carriers, {.observer = [](const Progress&) { return false; }}).status == Status::cancelled);
  mesh.patches[3] = 17;
  CHECK_THROWS_AS(improve_quads(mesh, carriers), invalid_connectivity);
}

TEST_CASE("intervals are added so that every patch is even, no more than one a patch") {
  std::mt19937_64 engine(8);
  for (const Surface& surface :
       {Surface(box_surface({1, 2, 3}, 2, 2, 2)), Surface(flat_delaunay(random_flat_points(12, engine)))}) {
    for (int i = 0; i < 64; ++i) {
      std::vector<index_t> n;
      for (std::size_t c = 0; c < surface.features.curves.size(); ++c)
        n.push_back(1 + static_cast<index_t>(engine() % 4));
      const auto sides = detail::odd_sides(surface);
      const auto odd = [&] {
        std::vector<index_t> count(surface.features.n_patches, 0);
        for (std::size_t c = 0; c < n.size(); ++c)
          for (const index_t patch : sides[c]) count[patch] += n[c];
        return std::count_if(count.begin(), count.end(), [](index_t x) { return x % 2 == 1; });
      };
      const auto before = odd();
      const std::vector<index_t> longer = curves_to_lengthen(surface, n);
      CHECK(longer.empty() == (before == 0));
      CHECK(longer.size() <= static_cast<std::size_t>(surface.features.n_patches));
      for (const index_t c : longer) ++n[c];
      CHECK(odd() == 0);
    }
  }
}

TEST_CASE("improvement that keeps cells sound never folds one, and does improve") {
  std::mt19937_64 engine(31);
  double before = 0, after = 0;
  for (int i = 0; i < 40; ++i) {
    CAPTURE(i);
    const Surface surface(flat_delaunay(random_flat_points(20 + static_cast<std::size_t>(i), engine)));
    const FeatureCarriers carriers(surface);
    QuadMesh mesh = quadrangulate(surface, LemonMatcher{}, {.goal = QuadGoal::pairs}).mesh;
    const auto is_convex_exactly = [](const QuadMesh& m, const QuadMesh::Cell& cell) {
      const std::size_t n = QuadMesh::n_corners(cell);
      for (std::size_t k = 0; k < n; ++k)
        if (projected_orientation(2, m.points[cell[k]], m.points[cell[(k + 1) % n]], m.points[cell[(k + 2) % n]]) <= 0)
          return false;
      return true;
    };
    // Pairs that are folded fall back into their triangles.
    const QuadImprovement judged = improve_quads(mesh, carriers, {.rounds = 0, .sweeps = 0});
    CHECK(judged.n_folded_given == judged.folded.size());
    for (const index_t cell : judged.folded) {
      const QuadMesh::Cell c = mesh.cells[cell];
      REQUIRE(c[3] != no_index);
      mesh.cells[cell] = {c[0], c[1], c[2], no_index};
      mesh.cells.push_back({c[0], c[2], c[3], no_index});
      mesh.patches.push_back(0);
    }
    for (const auto& cell : mesh.cells) REQUIRE(is_convex_exactly(mesh, cell));
    const QuadImprovement improved = improve_quads(mesh, carriers, {.scope = QuadImprovementScope::sound});
    CHECK(improved.n_folded_given == 0);
    CHECK(improved.folded.empty());
    for (const auto& cell : improved.mesh.cells) REQUIRE(is_convex_exactly(improved.mesh, cell));
    CHECK(topology_fault(improved.mesh) == std::nullopt);
    CHECK(euler_characteristic(improved.mesh) == 1);
    const auto mean = [](const QuadMesh& m) {
      double sum = 0;
      for (const auto& cell : m.cells) {
        std::vector<Vector3> p;
        for (std::size_t k = 0; k < QuadMesh::n_corners(cell); ++k) p.push_back(m.points[cell[k]]);
        sum += scaled_jacobian(p, Vector3::UnitZ()) / static_cast<double>(m.cells.size());
      }
      return sum;
    };
    before += mean(mesh) / 40;
    after += mean(improved.mesh) / 40;
  }
  CHECK(after > before + 0.05);
}
