// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/prism_chooser.hpp"
#include "framehex/field/boundary_frames.hpp"
#include "framehex/insertion/detail/curve_sites.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/selection/tomita.hpp"
#include "framehex/surface/boundary_slider.hpp"
#include "framehex/surface/cross_field.hpp"
#include "framehex/surface/retriangulation.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/surface_samples.hpp"
#include "support/surfaces.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <random>

/// Work that once took quadratic time. Each is made for a number n of things, and then done as often as wanted; with
/// `typical` of them linear work takes milliseconds.
namespace framehex::test {

/// A box n segments long: four long curves.
struct SlidingOnLongCurves {
  static constexpr int typical = 2000;
  Surface surface;
  std::vector<LabelledEdge> edges;

  explicit SlidingOnLongCurves(int n) : surface(box_surface({1.0 * n, 1, 1}, n, 1, 1)) {
    const FeatureGraph& features = surface.features;
    for (std::size_t c = 0; c < features.curves.size(); ++c)
      for (std::size_t i = 0; i + 1 < features.curves[c].size(); ++i)
        edges.push_back({{features.curves[c][i], features.curves[c][i + 1]}, static_cast<index_t>(c)});
  }
  std::size_t run() const {
    const BoundarySlider slider(surface, surface.points, edges, 1e-6);
    std::size_t n_moved = 0;
    for (index_t v = 0; v < surface.points.size(); ++v) {
      Vector3 place = surface.points[v] + Vector3::Constant(0.01);
      n_moved += slider(v, place);
    }
    return n_moved;
  }
};

/// A sharp double cone of n facets each, in no order.
struct FramesOfNeedle {
  static constexpr int typical = 250;
  Surface surface;
  std::vector<Quaternion> crosses;

  explicit FramesOfNeedle(int n) : surface(needle(n)), crosses(compute_cross_field(surface).frames) {}
  static IndexedTriangleMesh needle(int n) {
    IndexedTriangleMesh mesh;
    const auto m = static_cast<index_t>(n);
    for (index_t i = 0; i < m; ++i) {
      const double a = 2 * std::numbers::pi * i / m;
      mesh.points.emplace_back(0.1 * std::cos(a), 0.1 * std::sin(a), 0);
    }
    mesh.points.emplace_back(0, 0, 3);
    mesh.points.emplace_back(0, 0, -3);
    for (index_t i = 0; i < m; ++i) {
      mesh.triangles.push_back({i, (i + 1) % m, m});
      mesh.triangles.push_back({(i + 1) % m, i, m + 1});
    }
    std::mt19937 engine(1);
    for (std::size_t i = mesh.triangles.size(); i > 1; --i)
      std::swap(mesh.triangles[i - 1], mesh.triangles[engine() % i]);
    return mesh;
  }
  std::size_t run() const { return make_boundary_frames(surface, crosses).frames.size(); }
};

/// n cycles of five candidates: components that need the search.
struct SelectionOfCycles {
  static constexpr int typical = 2500;
  IncompatibilityGraph graph;

  static IncompatibilityGraph cycles(int n) {
    std::vector<std::array<index_t, 2>> conflicts;
    for (index_t c = 0; c < static_cast<index_t>(n); ++c)
      for (index_t i = 0; i < 5; ++i) conflicts.push_back({5 * c + i, 5 * c + (i + 1) % 5});
    return make_incompatibility_graph(std::vector<double>(5 * static_cast<std::size_t>(n), 1.0), conflicts);
  }
  explicit SelectionOfCycles(int n) : graph(cycles(n)) {}
  std::size_t run() const { return select_by_branch_and_bound(graph).members.size(); }
};

/// n closed surfaces without features, which have a field each.
struct FieldOfManyParts {
  static constexpr int typical = 1500;
  Surface surface;

  explicit FieldOfManyParts(int n) : surface(octahedra(n), {.angle = 3.1, .corner_angle = 3.1}) {}
  static IndexedTriangleMesh octahedra(int n) {
    IndexedTriangleMesh mesh;
    for (int part = 0; part < n; ++part) {
      const auto first = static_cast<index_t>(mesh.points.size());
      const Vector3 centre(3 * part, 0, 0);
      for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) mesh.points.push_back(centre + side * Vector3::Unit(axis));
      for (index_t octant = 0; octant < 8; ++octant) {
        std::array<index_t, 3> t{first + (octant & 1), first + 2 + (octant >> 1 & 1), first + 4 + (octant >> 2)};
        if (std::popcount(octant) % 2 == 0) std::swap(t[1], t[2]);
        mesh.triangles.push_back(t);
      }
    }
    return mesh;
  }
  std::size_t run() const { return compute_cross_field(surface).frames.size(); }
};

/// Samples all along curves of n segments.
struct SitesOnLongCurves {
  static constexpr int typical = 2000;
  SlidingOnLongCurves box;
  std::vector<SurfaceSample> samples;

  explicit SitesOnLongCurves(int n) : box(n) {
    const FeatureGraph& features = box.surface.features;
    for (index_t c = 0; c < features.curves.size(); ++c)
      for (std::size_t i = 0; i + 1 < features.curves[c].size(); ++i)
        samples.push_back({Vector3::Zero(), SampleKind::curve, c, static_cast<double>(i) + 0.5});
  }
  std::size_t run() const {
    const SurfaceWalker walker(box.surface);
    const detail::CurveSites sites(box.surface, walker);
    std::size_t n_sectors = 0;
    for (const SurfaceSample& sample : samples) n_sectors += sites.sectors(sample).size();
    return n_sectors;
  }
};

/// A few cubes among many points, searched vertex by vertex.
struct SearchAtVertices {
  static constexpr int typical = 800;
  IndexedTetMesh mesh = kuhn_lattice(6);
  std::unique_ptr<PotentialHexFinder<IndexedTetMesh>> finder;

  explicit SearchAtVertices(int n) {
    const std::size_t n_used = mesh.points.size();
    for (int i = 0; i < 1000 * n; ++i) mesh.points.emplace_back(100 + i, 0, 0);
    finder = std::make_unique<PotentialHexFinder<IndexedTetMesh>>(mesh);
    n_vertices = static_cast<index_t>(n_used);
  }
  std::size_t run() const {
    std::size_t n_found = 0;
    for (index_t v = 0; v < n_vertices; ++v) n_found += finder->find_at(v).size();
    return n_found;
  }
  index_t n_vertices;
};

/// A thin wavy strip, whose top and bottom cross wherever samples stand too far apart: cut at its long curves.
struct RepairOfThinStrip {
  static constexpr int typical = 16;
  Surface surface;
  std::vector<SurfaceSample> samples;

  explicit RepairOfThinStrip(int n) : surface(strip(n), {.angle = 1.2}), samples(scatter_samples(surface, 0.45)) {}
  static IndexedTriangleMesh strip(int n) {
    IndexedTriangleMesh mesh = box_surface({1.0 * n, 1, 0.02}, 8 * n, 4, 1);
    for (Vector3& p : mesh.points) p.z() += 0.3 * std::sin(3 * p.x() + (p.z() > 0.01 ? 0.05 : 0.0));
    return mesh;
  }
  std::size_t run() const {
    return retriangulate(surface, samples, {.max_deviation = std::numeric_limits<double>::infinity()}).n_added;
  }
};

/// n prisms side by side, the heaviest in the middle, each of which fits better once a lighter neighbour has come.
struct PrismsInRow {
  static constexpr int typical = 500;
  AssemblyOptions options;
  std::vector<Vector3> points;
  TetAdjacency adjacency;
  PotentialPrisms prisms;

  explicit PrismsInRow(int n) {
    IndexedTetMesh mesh;
    for (int i = 0; i < n + 2; ++i)
      for (const double side : {0.0, 1.0 + 0.5 * std::min(i, n + 1 - i) / n})
        mesh.points.emplace_back(0.5 * i, i % 2, side);
    for (index_t i = 0; i < static_cast<index_t>(n); ++i) {
      const auto at = [i](index_t column, index_t side) { return 2 * (i + column) + side; };
      for (std::array<index_t, 4> tet :
           {std::array{at(0, 0), at(1, 0), at(2, 0), at(2, 1)}, std::array{at(0, 0), at(1, 0), at(1, 1), at(2, 1)},
            std::array{at(0, 0), at(0, 1), at(1, 1), at(2, 1)}}) {
        if (orientation_determinant(mesh.points[tet[0]], mesh.points[tet[1]], mesh.points[tet[2]],
                                    mesh.points[tet[3]]) < 0)
          std::swap(tet[0], tet[1]);
        mesh.tets.push_back(tet);
      }
    }
    points = mesh.points;
    adjacency = make_adjacency(mesh);
    prisms = detail::find_free_prisms(detail::ComplexBuilder(points, adjacency, options), adjacency, options,
                                      {.quality_floor = 0.1});
  }
  std::size_t run() const {
    detail::ComplexBuilder builder(points, adjacency, options);
    detail::choose_prisms(builder, prisms, 1);
    return builder.complex.cells.size();
  }
};

}  // namespace framehex::test
