// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/pipeline/detail/better_mesh.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "framehex/surface/boundary_slider.hpp"
#include "framehex/surface/refinement.hpp"
#include "framehex/surface/regions.hpp"
#include "framehex/surface/self_intersection.hpp"
#include "framehex/surface/surface_locator.hpp"
#include "framehex/tetrahedralization/background.hpp"
#include "framehex/verify/boundary_deviation.hpp"
#include "framehex/verify/conformity.hpp"
#include "framehex/verify/validity.hpp"
#include "support/complexes.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/listener.hpp"
#include "support/ply.hpp"
#include "support/stl.hpp"
#include "support/surface_samples.hpp"
#include "support/surfaces.hpp"

#include <catch2/catch.hpp>

#include <list>
#include <map>
#include <set>

using namespace framehex;

namespace {

/// A box of a x b x c as few triangles, turned about an odd axis.
IndexedTriangleMesh box(const Vector3& sides, double turn) {
  const IndexedTetMesh cell = test::kuhn_lattice(1);
  IndexedTriangleMesh surface = extract_boundary(cell, make_adjacency(cell)).surface;
  const Eigen::AngleAxisd rotation(turn, Vector3(1, 2, -0.5).normalized());
  for (Vector3& p : surface.points) p = rotation * Vector3(p.cwiseProduct(sides));
  return surface;
}

/// A host of pointers in single precision, which cannot be copied.
struct HostSurface {
  struct Vertex {
    float x, y, z;
    unsigned number;
  };
  using Triangle = std::array<const Vertex*, 3>;
  std::list<Vertex> vertices;
  std::list<Triangle> triangles;

  HostSurface() = default;
  HostSurface(const HostSurface&) = delete;
  HostSurface& operator=(const HostSurface&) = delete;
};

/// Gives the host the shape of a mesh, whose coordinates are rounded to single precision too.
void fill(HostSurface& host, IndexedTriangleMesh& mesh) {
  std::vector<const HostSurface::Vertex*> at;
  for (const Vector3& p : mesh.points)
    at.push_back(&host.vertices.emplace_back(
        HostSurface::Vertex{float(p.x()), float(p.y()), float(p.z()), unsigned(at.size())}));
  // Read back from the host: g++ 12 takes a cast to float and back for nothing, at -O3.
  for (std::size_t v = 0; v < at.size(); ++v) mesh.points[v] = Vector3(at[v]->x, at[v]->y, at[v]->z);
  for (const auto& t : mesh.triangles) host.triangles.push_back({at[t[0]], at[t[1]], at[t[2]]});
}

/// Volume of each region, by its cells.
std::map<index_t, double> region_volumes(const MixedMesh& mesh) {
  std::map<index_t, MixedMesh> parts;
  for (index_t cell = 0; cell < mesh.n_cells(); ++cell) {
    MixedMesh& part = parts[mesh.regions.empty() ? 0 : mesh.regions[cell]];
    part.points = mesh.points;
    part.add(mesh.kinds[cell], mesh.cells[cell]);
  }
  std::map<index_t, double> volumes;
  for (const auto& [region, part] : parts) volumes[region] = verify::volume(part).cells;
  return volumes;
}

struct Constant {
  double value;
  double operator()(const Vector3&) const { return value; }
};

std::size_t n_of(const MixedMesh& mesh, CellKind kind) {
  return static_cast<std::size_t>(std::count(mesh.kinds.begin(), mesh.kinds.end(), kind));
}

}  // namespace

template <>
struct framehex::mesh_traits<HostSurface> {
  using vertex_type = const HostSurface::Vertex*;
  using cell_type = const HostSurface::Triangle*;
  using scalar_type = float;
  static auto vertices(const HostSurface& m) {
    return m.vertices | std::views::transform([](const HostSurface::Vertex& v) { return &v; });
  }
  static auto cells(const HostSurface& m) {
    return m.triangles | std::views::transform([](const HostSurface::Triangle& t) { return &t; });
  }
  static std::size_t index(const HostSurface&, vertex_type v) { return v->number; }
  static std::array<float, 3> point(const HostSurface&, vertex_type v) { return {v->x, v->y, v->z}; }
  static std::array<vertex_type, 3> cell_vertices(const HostSurface&, cell_type t) { return *t; }
};

static_assert(TriangleMesh<HostSurface>);

TEST_CASE("a box at a size that divides its sides is all hexahedra, however it is turned, in every variant") {
  const auto turn = GENERATE(0.0, 0.7);
  const auto order = GENERATE(PointOrder::fifo, PointOrder::smoothness, PointOrder::lattice);
  const auto method = GENERATE(FieldMethod::nearest, FieldMethod::smoothed, FieldMethod::best);
  MeshingOptions options;
  options.order = order;
  options.field.method = method;
  const MeshingResult result = mesh_surface(box({4, 3, 2}, turn), Constant{0.5}, TetgenProcess{}, options);
  const MixedMesh& mesh = result.recombination.mesh;
  CHECK(mesh.n_cells() == 8 * 6 * 4);
  CHECK(n_of(mesh, CellKind::hexahedron) == 8 * 6 * 4);
  CHECK(mesh.points.size() == 9 * 7 * 5);
  CHECK(result.recombination.assembly.n_open_quadrilaterals == 0);
  CHECK(result.statistics.n_patches == 6);
  CHECK(result.statistics.n_feature_curves == 12);
  CHECK(result.frames.size() == mesh.points.size());
}

TEST_CASE("a prism of three sides, which blocks can fill, is filled by hexahedra, but for a place if it is turned") {
  const auto turn = GENERATE(0.0, 0.7, 2.1);
  const double size = GENERATE(0.1, 0.12, 0.14);
  IndexedTriangleMesh prism = test::extruded_polygon({{0, 0}, {1, 0}, {0.5, std::sqrt(0.75)}}, 1);
  const Quaternion rotation(Eigen::AngleAxisd(turn, Vector3(1, -2, 0.5).normalized()));
  for (Vector3& p : prism.points) p = rotation * p;
  const MeshingResult result = mesh_surface(prism, Constant{size}, TetgenProcess{});
  CHECK(result.statistics.mapping == LatticeMapping::seamless);
  const MixedMesh& mesh = result.recombination.mesh;
  if (turn == 0) CHECK(n_of(mesh, CellKind::hexahedron) == mesh.n_cells());
  CHECK(detail::share_of_hexahedra(mesh) > 0.95);
  CHECK(verify::is_conforming(mesh));
}

TEST_CASE("the result is the same for any number of threads, and for a second run") {
  const IndexedTriangleMesh surface = box({3, 2.2, 1.7}, 0.3);
  const auto run = [&](const auto& executor) {
    return mesh_surface(surface, Constant{0.4}, TetgenProcess{}, MeshingOptions{}, executor).recombination.mesh;
  };
  const MixedMesh once = run(SerialExecutor{});
  for (const std::size_t threads : {std::size_t{1}, std::size_t{2}, std::size_t{5}}) {
    const MixedMesh again = run(ThreadExecutor(threads));
    CHECK(again.points == once.points);
    CHECK(again.kinds == once.kinds);
    CHECK(again.cells.values == once.cells.values);
  }
}

TEST_CASE("boundary vertices may slide, and the mesh fills the surface to its corners as without") {
  const Vector3 sides(3, 2.2, 1.7);
  const IndexedTriangleMesh surface = box(sides, 0.3);
  const auto mesh_of = [&](bool slides) {
    MeshingOptions options;
    if (!slides) options.recombination.assembly.boundary_projection = [](index_t, Vector3&) { return false; };
    return mesh_surface(surface, Constant{0.4}, TetgenProcess{}, options).recombination.mesh;
  };
  const MixedMesh mesh = mesh_of(true), fixed = mesh_of(false);
  CHECK(verify::is_conforming(mesh));
  CHECK(verify::is_valid(mesh));
  CHECK(verify::volume(mesh).cells == Approx(sides.prod()).epsilon(1e-9));
  const auto deviation = verify::boundary_deviation(mesh, surface);
  CHECK(deviation.mesh_to_surface_max < 1e-9);
  CHECK(deviation.surface_to_mesh_max < 1e-9);
  CHECK(mesh.edges.size() == fixed.edges.size());
  CHECK(mesh.faces.size() == fixed.faces.size());
}

TEST_CASE("improvement slides boundary vertices of a curved body, and none leaves its surface") {
  const IndexedTriangleMesh surface = test::sphere_surface(1, 3);
  AssemblyOptions assembly{.hexahedron_target = 0.6};  // much to do
  const auto mesh_of = [&] {
    MeshingOptions options;
    options.recombination.assembly = assembly;
    options.lattice.mapping = LatticeMapping::phases;  // else it depends on the cells which mapping stays
    return mesh_surface(surface, Constant{0.3}, TetgenProcess{}, options).recombination.mesh;
  };
  const auto boundary_points = [](const MixedMesh& mesh) {
    std::set<std::array<double, 3>> points;
    for (const LabelledFace& face : mesh.faces)
      for (const index_t v : face.vertices)
        if (v != no_index) points.insert({mesh.points[v].x(), mesh.points[v].y(), mesh.points[v].z()});
    return points;
  };
  const MixedMesh improved = mesh_of();
  assembly.boundary_projection = [](index_t, Vector3&) { return false; };
  const auto held = boundary_points(mesh_of());
  assembly.improvement = ImprovementMode::none;
  CHECK(boundary_points(mesh_of()) == held);

  const SurfaceLocator locator(surface);
  std::size_t n_moved = 0;
  for (const auto& p : boundary_points(improved)) {
    CHECK(locator.nearest(Vector3(p[0], p[1], p[2])).distance < 1e-9);
    n_moved += 1 - held.count(p);
  }
  CHECK(n_moved > 0);
  CHECK(verify::is_conforming(improved));
  CHECK(verify::is_valid(improved));
}

TEST_CASE("a job can be cancelled at any stage, and then leaves no mesh") {
  const IndexedTriangleMesh surface = box({3, 2, 2}, 0.3);
  std::size_t n_calls = 0;
  MeshingOptions options;
  options.observer = [&](const Progress&) { return ++n_calls, true; };
  CHECK(mesh_surface(surface, Constant{0.4}, TetgenProcess{}, options).status == Status::complete);
  REQUIRE(n_calls > 10);
  // How often it is heard while TetGen works depends on the clock: a run may end before it is told to stop.
  std::size_t n_stopped = 0;
  for (std::size_t stop = 1; stop < n_calls; stop += 1 + n_calls / 12) {
    std::size_t n = 0;
    options.observer = [&](const Progress&) { return ++n < stop; };
    const MeshingResult result = mesh_surface(surface, Constant{0.4}, TetgenProcess{}, options);
    CHECK(result.status == (n < stop ? Status::complete : Status::cancelled));
    CHECK((result.recombination.mesh.n_cells() == 0) == (n >= stop));
    CHECK(n <= stop + 2);
    n_stopped += n >= stop;
  }
  CHECK(n_stopped >= 5);
}

TEST_CASE("numbers of other meshes than those made on the way are not looked at", "[regression]") {
  const IndexedTriangleMesh surface = box({2, 1, 1}, 0.3);
  const MixedMesh mesh = mesh_surface(surface, Constant{0.5}, TetgenProcess{}).recombination.mesh;
  MeshingOptions options;
  const std::vector<index_t> regions{1, 2, 3};
  const std::vector<std::uint8_t> is_free{0, 1};
  options.field.vertex_of = {2, 1, 0};
  options.recombination.regions = regions;
  options.recombination.finder.free_tets = is_free;
  const MixedMesh again = mesh_surface(surface, Constant{0.5}, TetgenProcess{}, options).recombination.mesh;
  CHECK(again.points == mesh.points);
  CHECK(again.cells.values == mesh.cells.values);
}

TEST_CASE("numbers outside their range are refused before any work") {
  const IndexedTriangleMesh open{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  MeshingOptions options;
  options.recombination.assembly.quality_target = -0.1;
  CHECK_THROWS_AS(mesh_surface(open, Constant{0.5}, TetgenProcess{}, options), invalid_option);
  options = {};
  options.background_edge = std::nan("");
  CHECK_THROWS_AS(mesh_surface(open, Constant{0.5}, TetgenProcess{}, options), invalid_option);
  CHECK_THROWS_AS(mesh_surface(open, Constant{0.5}, TetgenProcess{}), open_surface);
}

TEST_CASE("bad sizes are refused before any work") {
  const IndexedTriangleMesh surface = box({1, 1, 1}, 0);
  for (const double size : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    CHECK_THROWS_AS(mesh_surface(surface, Constant{size}, TetgenProcess{}), error);
  CHECK_THROWS_AS(mesh_surface(surface, Constant{1e-6}, TetgenProcess{}), invalid_option);
}

TEST_CASE("points in smoothness order make more hexahedra than first in, first out") {
  const auto [surface, size] = GENERATE(std::pair(test::read_ply(FRAMEHEX_TEST_DATA "/dome.ply"), 0.156),
                                        std::pair(test::read_stl(FRAMEHEX_TEST_DATA "/bunny.stl"), 0.26));
  const auto hexahedra_by_volume = [&, &surface = surface, &size = size](PointOrder order) {
    MeshingOptions options;
    options.order = order;
    options.field.method = FieldMethod::smoothed;
    options.recombination.selection.method = SelectMethod::greedy;
    const MixedMesh mesh = mesh_surface(surface, Constant{size}, TetgenProcess{}, options).recombination.mesh;
    const verify::VolumeReport volume = verify::volume(mesh);
    return volume.by_kind[static_cast<std::size_t>(CellKind::hexahedron)] / volume.cells;
  };
  CHECK(hexahedra_by_volume(PointOrder::smoothness) > hexahedra_by_volume(PointOrder::fifo));
}

TEST_CASE("a host's surface of pointers goes through every stage as the same surface in arrays does") {
  IndexedTriangleMesh mesh = test::cylinder_surface(0.5, 1, 24);
  HostSurface host;
  fill(host, mesh);
  const Constant size{0.25};
  const auto length = [](const Vector3&) { return 0.3; };
  CHECK_NOTHROW(validate_closed(host));
  CHECK(find_self_intersections(host).empty());
  CHECK(enclosed_volume(host) == enclosed_volume(mesh));
  const FeatureGraph features = detect_features(host);
  CHECK(features.curves.values == detect_features(mesh).curves.values);
  CHECK(features.triangle_patch == detect_features(mesh).triangle_patch);
  CHECK(find_regions(host).n_regions == 1);
  CHECK(refine(host, length).surface.triangles() == refine(mesh, length).surface.triangles());
  const SurfaceCrossField cross = compute_cross_field(host);
  CHECK(cross.smoothness == compute_cross_field(mesh).smoothness);
  const CurveInsertion curves = insert_curve_points(host, size);
  const SurfaceInsertion samples = insert_surface_points(host, cross.frames, cross.smoothness, curves, size);
  CHECK(samples.samples.size() ==
        insert_surface_points(mesh, cross.frames, cross.smoothness, curves, size).samples.size());
  CHECK(retriangulate(host, samples.samples).surface.triangles() ==
        retriangulate(mesh, samples.samples).surface.triangles());
  CHECK(estimate_surface_points(host, size).n_points == estimate_surface_points(mesh, size).n_points);
  const SurfaceLocator locator(host);
  const auto interior = background_points(host, locator, 0.3);
  CHECK(interior == background_points(mesh, SurfaceLocator(mesh), 0.3));
  const Tetrahedralization tets = tetrahedralize(TetgenProcess{}, host, interior);
  CHECK(tets.mesh.points.size() == mesh.points.size() + interior.size());
  CHECK(tets.adjacency.tets == tets.mesh.tets);
  CHECK_NOTHROW(make_boundary_frames(host, cross.frames));
  CHECK_NOTHROW(compute_frame_field(tets.mesh, host, cross.frames));
  Vector3 place(0.4, 0, 2);
  CHECK(BoundarySlider(host, std::vector<Vector3>{{0, 0, 1}}, {}, 1e-6)(0, place));
  CHECK((place - Vector3(0.4, 0, 1)).norm() < 1e-6);

  MeshingOptions options;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    options.features.patches.push_back(features.triangle_patch[t] == 0 ? 70 : 80);
  const MeshingResult result = mesh_surface(host, size, TetgenProcess{}, options);
  CHECK(verify::is_conforming(result.recombination.mesh));
  CHECK(verify::boundary_deviation(result.recombination.mesh, host).mesh_to_surface_max < 0.05);  // chords
  std::set<index_t> labels;
  for (const LabelledFace& face : result.recombination.mesh.faces) labels.insert(face.label);
  CHECK(labels == std::set<index_t>{70, 80});
}

TEST_CASE("every region of a complex is filled, and what lies between two is meshed once") {
  struct Case {
    IndexedTriangleMesh mesh;
    double h;
    double tolerance;  // of the volumes: what chords cut off
  };
  const PointOrder order = GENERATE(PointOrder::smoothness, PointOrder::lattice);
  // Steps of a lattice are up to a quarter longer.
  const double h_of_ball = order == PointOrder::lattice ? 0.2 / AxisScaleOptions{}.longest : 0.2;
  for (const Case& c : {Case{test::two_material_box(), 0.2, 1e-9}, Case{test::nested_shells(2), 0.2, 0.15},
                        Case{test::ball_half_in_box(16), h_of_ball, 0.1}}) {
    const Surface surface(c.mesh);
    const SurfaceRegions regions = find_regions(surface);
    const MeshingResult result = mesh_surface(c.mesh, Constant{c.h}, TetgenProcess{}, {.order = order});
    const MixedMesh& mesh = result.recombination.mesh;
    CHECK(result.statistics.n_regions == regions.n_regions);
    CHECK(verify::is_conforming(mesh));
    CHECK(verify::is_valid(mesh));
    CHECK(n_of(mesh, CellKind::hexahedron) > 50);
    const auto volumes = region_volumes(mesh);
    REQUIRE(volumes.size() == regions.n_regions);
    for (const auto& [region, volume] : volumes)
      CHECK(volume == Approx(enclosed_volume(region_surface(surface, regions, region).surface)).epsilon(c.tolerance));

    // A face lies between the regions that its patch separates, and every face between two regions is labelled.
    std::map<std::array<index_t, 4>, index_t> label;
    const auto key = [](std::array<index_t, 4> vertices) {
      std::sort(vertices.begin(), vertices.end());
      return vertices;
    };
    for (const LabelledFace& face : mesh.faces) label[key(face.vertices)] = face.label;
    CHECK(label.size() == mesh.faces.size());
    const FaceTable table = make_face_table(mesh);
    std::size_t n_between = 0;
    for (std::size_t i = 0; i < table.n_groups(); ++i) {
      std::vector<index_t> sides;
      for (const CellFace& face : table.group(i)) sides.push_back(mesh.regions[face.cell]);
      if (sides.size() == 1) sides.push_back(no_index);
      std::sort(sides.begin(), sides.end());
      const auto found = label.find(key(table.group(i)[0].vertices));
      CHECK((found != label.end()) == (sides[0] != sides[1]));
      if (found == label.end()) continue;
      auto wanted = regions.sides[found->second];
      std::sort(wanted.begin(), wanted.end());
      CHECK(std::ranges::equal(wanted, sides));
      n_between += sides[1] != no_index;
    }
    CHECK(n_between > 10);
  }
}

TEST_CASE("a complex comes out the same for any number of threads, and its field may pass through the interfaces") {
  const IndexedTriangleMesh mesh = test::two_material_box();
  const auto run = [&](const MeshingOptions& options, const auto& executor) {
    return mesh_surface(mesh, Constant{0.25}, TetgenProcess{}, options, executor);
  };
  const MeshingResult one = run({}, SerialExecutor{});
  for (const unsigned threads : {2u, 3u}) {
    const MeshingResult more = run({}, ThreadExecutor(threads));
    CHECK(more.recombination.mesh.points == one.recombination.mesh.points);
    CHECK(more.recombination.mesh.cells.values == one.recombination.mesh.cells.values);
    CHECK(more.recombination.mesh.regions == one.recombination.mesh.regions);
  }
  // Without the leaning wall the field of a box is constant.
  const MeshingResult free = run({.interfaces = InterfaceFrames::free}, SerialExecutor{});
  CHECK(free.statistics.smoothness_mean == Approx(1).margin(1e-6));
  CHECK(one.statistics.smoothness_mean < 0.99);
  CHECK(verify::is_conforming(free.recombination.mesh));
  CHECK(region_volumes(free.recombination.mesh).size() == 2);
}

TEST_CASE("a lattice goes through an interface in step") {
  // Neither material is a whole number of sizes thick.
  const MeshingResult result = mesh_surface(test::two_material_box(0.9, 0.9), Constant{0.25}, TetgenProcess{});
  CHECK(result.statistics.order == PointOrder::lattice);
  const MixedMesh& mesh = result.recombination.mesh;
  CHECK(n_of(mesh, CellKind::hexahedron) == mesh.n_cells());
  CHECK(region_volumes(mesh).size() == 2);
  CHECK(verify::is_conforming(mesh));
}

TEST_CASE("where a lattice has holes or is lost there are as many hexahedra as with fronts at least") {
  struct Case {
    IndexedTriangleMesh mesh;
    double h;
    CellFit fit = CellFit::any;
  };
  IndexedTriangleMesh leaning = test::tetrahedron_surface(1);
  for (Vector3& p : leaning.points) p.z() = 2.5 * p.z() + p.x();
  std::set<PointOrder> seen;
  // Finite volumes refuse the one layer of cells that a lattice has in the wall of the tube.
  for (const Case& c : {Case{test::tetrahedron_surface(1), 0.2}, Case{test::sphere_surface(1, 3), 0.5},
                        Case{leaning, 0.12}, Case{test::tube_surface(0.85, 1, 1, 48), 0.12, CellFit::finite_volume}}) {
    MeshingOptions options;
    options.recombination.assembly.fit = c.fit;
    const MeshingResult best = mesh_surface(c.mesh, Constant{c.h}, TetgenProcess{}, options);
    options.order = PointOrder::smoothness;
    const MeshingResult fronts = mesh_surface(c.mesh, Constant{c.h}, TetgenProcess{}, options);
    CHECK(detail::share_of_hexahedra(best.recombination.mesh) >= detail::share_of_hexahedra(fronts.recombination.mesh));
    CHECK(verify::is_conforming(best.recombination.mesh));
    seen.insert(best.statistics.order);
  }
  CHECK(seen == std::set{PointOrder::smoothness, PointOrder::lattice});
}

TEST_CASE(
    "where one layer of a lattice is refused in a wall, steps no longer than the size leave more hexahedra than fronts",
    "[regression]") {
  const IndexedTriangleMesh wing = test::read_ply(FRAMEHEX_TEST_DATA "/naca.ply");
  MeshingOptions options{.recombination = {.assembly = {.fit = CellFit::finite_volume}}};
  const MeshingResult lattice = mesh_surface(wing, Constant{0.064}, TetgenProcess{}, options);
  options.order = PointOrder::smoothness;
  const MeshingResult fronts = mesh_surface(wing, Constant{0.064}, TetgenProcess{}, options);
  CHECK(lattice.statistics.order == PointOrder::lattice);
  CHECK(lattice.recombination.assembly.n_unfit == 0);
  CHECK(detail::share_of_hexahedra(lattice.recombination.mesh) >
        detail::share_of_hexahedra(fronts.recombination.mesh) + 0.02);
}

TEST_CASE("meshing a surface is heard of all the time", "[pipeline][progress]") {
  const IndexedTriangleMesh bunny = test::read_stl(FRAMEHEX_TEST_DATA "/bunny.stl");
  test::Listener listener;
  MeshingOptions options;
  options.observer = listener.observer();
  options.order = GENERATE(PointOrder::smoothness, PointOrder::lattice);
  mesh_surface(bunny, ConstantSize{0.26}, TetgenProcess{}, options);
  listener.check_silences();
}

namespace {

/// A square plate as thin as a few ten thousandths of its side, bent so much that triangles of the wished size cut through
/// it.
IndexedTriangleMesh bent_sheet() {
  IndexedTriangleMesh sheet = test::box_surface({1, 1, 0.0005}, 12, 12, 1);
  for (Vector3& p : sheet.points) p.z() += 0.08 * std::sin(4.4 * p.x()) * std::sin(4.4 * p.y());
  return sheet;
}

/// A ball with a round void that leaves a wall of `wall` on one side.
IndexedTriangleMesh hollow_ball(double wall) {
  IndexedTriangleMesh ball = test::sphere_surface(1, 4);
  const IndexedTriangleMesh inner = test::sphere_surface(0.6, 4);
  const auto first = static_cast<index_t>(ball.points.size());
  for (const Vector3& p : inner.points) ball.points.push_back(p + Vector3(0.4 - wall, 0, 0));
  for (const auto& t : inner.triangles) ball.triangles.push_back({first + t[0], first + t[2], first + t[1]});
  return ball;
}

void check_sound(const MeshingResult& result) {
  const MixedMesh& mesh = result.recombination.mesh;
  CHECK(mesh.n_cells() > 0);
  CHECK(verify::is_conforming(mesh));
  CHECK(verify::is_valid(mesh));
}

}  // namespace

TEST_CASE("a body so thin that its triangles would cross is meshed with smaller sizes, and it is told where",
          "[regression]") {
  MeshingOptions options;
  options.order = PointOrder::smoothness;  // a lattice has the same points on both sides, which do not cross
  options.least_quality = 0;               // its cells are a matter of their own
  options.recombination.assembly.improvement = ImprovementMode::none;
  const MeshingResult result = mesh_surface(bent_sheet(), Constant{0.4}, TetgenProcess{}, options);
  check_sound(result);
  REQUIRE_FALSE(result.size_limits.empty());
  CHECK(verify::volume(result.recombination.mesh).cells == Approx(0.0005).epsilon(0.05));
  for (const SizeLimit& limit : result.size_limits) {
    CHECK(limit.length <= 0.2);
    CHECK(limit.length >= 0.4 / 1024);
    CHECK(SurfaceLocator(bent_sheet()).nearest(limit.place).distance < 0.1);
  }
}

TEST_CASE("a flat plate much thinner than a hundredth of the size needs no smaller one") {
  const MeshingResult result = mesh_surface(box({1.1, 0.83, 0.001}, 0), Constant{0.3}, TetgenProcess{});
  check_sound(result);
  CHECK(result.size_limits.empty());
  CHECK(result.poor_cells.empty());
  CHECK(n_of(result.recombination.mesh, CellKind::hexahedron) == result.recombination.mesh.n_cells());
  // Turned, rounding moves the points of its two sides apart.
  const MeshingResult turned = mesh_surface(box({1.1, 0.83, 0.001}, 0.4), Constant{0.3}, TetgenProcess{});
  check_sound(turned);
  CHECK(turned.poor_cells.empty());
}

TEST_CASE("a wall too thin for good cells of the size gets smaller ones, there only") {
  const MeshingResult result = mesh_surface(hollow_ball(0.003), Constant{0.4}, TetgenProcess{});
  check_sound(result);
  CHECK(result.poor_cells.empty());
  const verify::ValidityReport valid = verify::is_valid(result.recombination.mesh);
  CHECK(valid);
  std::array<Vector3, 8> corners;
  for (index_t cell = 0; cell < result.recombination.mesh.n_cells(); ++cell) {
    const auto row = result.recombination.mesh.cells[cell];
    for (std::size_t i = 0; i < row.size(); ++i) corners[i] = result.recombination.mesh.points[row[i]];
    CHECK(scaled_jacobian(result.recombination.mesh.kinds[cell], {corners.data(), row.size()}) >= 0.05);
  }
  REQUIRE_FALSE(result.size_limits.empty());
  for (const SizeLimit& limit : result.size_limits) CHECK(limit.place.x() > 0.4);
}

TEST_CASE("cells in a wedge of the input are poor, and named, and the sizes stay") {
  const double angle = 0.03;
  const IndexedTriangleMesh splinter =
      test::extruded_polygon({{0, 0}, {1, 0}, {std::cos(angle), std::sin(angle)}}, 0.5);
  const MeshingResult result = mesh_surface(splinter, Constant{0.1}, TetgenProcess{});
  check_sound(result);
  CHECK(result.size_limits.empty());
  REQUIRE_FALSE(result.poor_cells.empty());
  for (const PoorCell& poor : result.poor_cells) {
    CHECK(poor.input_angle);
    CHECK(poor.quality < 0.05);
    CHECK(poor.place.x() * angle < 0.05);
  }
}

namespace {

/// TetGen, but for the second mesh it loses the triangles at the origin that have a long edge.
struct Picky {
  double longest;
  int* n_calls;

  TetrahedralizationResult operator()(const TetrahedralizationRequest& request) const {
    TetrahedralizationResult result = TetgenProcess{}(request);
    if ((*n_calls)++ == 0) return result;  // the background
    const auto is_lost = [&](const std::array<index_t, 4>& t) {
      bool at_origin = false, has_long_edge = false;
      for (const index_t v : t) {
        at_origin = at_origin || request.points[v].norm() < 1e-9;
        for (const index_t w : t)
          has_long_edge = has_long_edge || (request.points[v] - request.points[w]).norm() > longest;
      }
      return at_origin && has_long_edge;
    };
    std::erase_if(result.tets, is_lost);
    return result;
  }
};

}  // namespace

TEST_CASE("where the tetrahedraliser loses triangles of the surface the size shrinks, until it does not") {
  int n_calls = 0;
  const MeshingResult result = mesh_surface(test::box_surface({2, 2, 2}), Constant{0.5}, Picky{0.5, &n_calls});
  check_sound(result);
  REQUIRE_FALSE(result.size_limits.empty());
  for (const SizeLimit& limit : result.size_limits) CHECK(limit.place.norm() < 1.1);
}

TEST_CASE("a surface that crosses itself is refused before anything is made of it", "[regression]") {
  IndexedTriangleMesh two = test::box_surface({1, 1, 1});
  const IndexedTriangleMesh one = two;
  for (const auto& t : one.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  for (const Vector3& p : one.points) two.points.push_back(p + Vector3(0.5, 0.4, 0.3));
  const auto never = [](const TetrahedralizationRequest&) -> TetrahedralizationResult {
    throw std::logic_error("asked for tetrahedra");
  };
  try {
    mesh_surface(two, Constant{0.4}, never);
    FAIL();
  } catch (const invalid_surface& e) {
    REQUIRE(e.indices().size() == 2);
    CHECK(e.indices()[0] < 12);
    CHECK(e.indices()[1] >= 12);
  }
  IndexedTriangleMesh doubled = one;
  doubled.triangles.push_back(one.triangles[7]);
  try {
    mesh_surface(doubled, Constant{0.4}, never);
    FAIL();
  } catch (const invalid_surface& e) {
    CHECK(e.indices() == std::vector<std::size_t>{7, 12});
  }
}
