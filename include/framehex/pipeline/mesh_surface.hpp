// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/compute_frame_field.hpp"
#include "framehex/field/singular_graph.hpp"
#include "framehex/geometry/bounding_box.hpp"
#include "framehex/insertion/curve_inserter.hpp"
#include "framehex/insertion/estimate.hpp"
#include "framehex/insertion/lattice_filling.hpp"
#include "framehex/insertion/surface_inserter.hpp"
#include "framehex/insertion/volume_inserter.hpp"
#include "framehex/lattice/periodic_parameterization.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/pipeline/recombine.hpp"
#include "framehex/surface/boundary_slider.hpp"
#include "framehex/surface/cross_field.hpp"
#include "framehex/surface/refinement.hpp"
#include "framehex/surface/regions.hpp"
#include "framehex/surface/retriangulation.hpp"
#include "framehex/surface/surface.hpp"
#include "framehex/tetrahedralization/background.hpp"
#include "framehex/tetrahedralization/tetrahedralizer.hpp"

#include <optional>

namespace framehex {

/// How points are placed: by fronts, in the order in which points propose their neighbours, or all at once.
enum class PointOrder {
  fifo,        ///< first in, first out: layer by layer from the boundary
  smoothness,  ///< where the frame field is smoothest first
  lattice      ///< of one lattice for the whole volume, filled in order of smoothness where it has gaps
};

/// Whether the frame field follows the interfaces between regions.
enum class InterfaceFrames {
  aligned,  ///< as it follows the boundary
  free,     ///< it passes through them
};

/// Options of all stages; each stage's own options say more.
///
/// What refers to vertices or tetrahedra of a mesh by number (`field.vertex_of`; labels and `finder.free_tets` of
/// `recombination`) is not looked at: the meshes are made on the way.
struct MeshingOptions {
  FeatureOptions features = {};
  CrossFieldOptions cross_field = {};
  FieldOptions field = {};
  InterfaceFrames interfaces = InterfaceFrames::aligned;
  PointOrder order = PointOrder::smoothness;
  LatticeOptions lattice = {};
  CurveOptions curves = {};
  SurfaceOptions surface = {};
  RetriangulationOptions retriangulation = {};
  VolumeOptions volume = {};
  RecombineOptions recombination = {};  ///< its boundary projection, when empty, becomes one to the surface
  std::optional<double> background_edge =
      {};                              ///< > 0, edge of the background mesh; the mean size on the surface when empty
  double max_background_points = 2e7;  ///< refuse an edge that asks for more
  Observer observer = {};              ///< replaces those of the stages when set

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    FeatureOptions::each_number(o.features, visit);
    CrossFieldOptions::each_number(o.cross_field, visit);
    FieldOptions::each_number(o.field, visit);
    LatticeOptions::each_number(o.lattice, visit);
    CurveOptions::each_number(o.curves, visit);
    SurfaceOptions::each_number(o.surface, visit);
    RetriangulationOptions::each_number(o.retriangulation, visit);
    VolumeOptions::each_number(o.volume, visit);
    RecombineOptions::each_number(o.recombination, visit);
    visit("MeshingOptions::background_edge", o.background_edge, least_positive, largest_finite);
    visit("MeshingOptions::max_background_points", o.max_background_points, 0, unbounded);
  }
};

/// What the stages found on their way.
struct MeshingStatistics {
  std::size_t n_feature_curves = 0;
  std::size_t n_patches = 0;
  std::size_t n_regions = 0;
  std::size_t n_background_tets = 0;
  double smoothness_mean = 0;  ///< over the background vertices
  double fraction_smooth = 0;  ///< share of them with smoothness >= 0.85
  double dirichlet_energy = 0;
  std::size_t n_singular_edges = 0;  ///< facets through which a singular line of the field passes
  double lattice_volume = 0;  ///< share of the volume in which the lattice is regular; 0 also where fronts replace it
  std::size_t n_surface_points = 0;  ///< corners, curves and surfaces
  std::size_t n_volume_points = 0;
  std::size_t n_unremoved_vertices = 0;  ///< vertices of the input that the retriangulation had to keep
  std::size_t n_repair_vertices = 0;     ///< added where triangles of the wished size would leave the input, or cross
  std::size_t n_tets = 0;                ///< of the second mesh
};

/// A hex-dominant mesh of the inside of a surface, and how it came about.
struct MeshingResult {
  Recombination recombination;     ///< `.mesh`, `.selection`, `.assembly`, `.seconds` (of all stages)
  std::vector<Quaternion> frames;  ///< frame at each point of the mesh
  std::vector<double> smoothness;  ///< smoothness of the field there, at most 1
  Csr<Vector3> singular_lines;     ///< of the field, as polylines
  MeshingStatistics statistics;
  Status status = Status::complete;  ///< cancelled: the mesh is empty
};

namespace detail {

/// The job of `mesh_surface`, stage by stage; each method leaves what the next ones read.
template <Tetrahedralizer T, SizeField Size, Executor E>
class SurfaceMesher {
public:
  SurfaceMesher(const T& tetrahedralizer, const Size& size, MeshingOptions options, const E& executor)
      : tetrahedralizer_(tetrahedralizer), size_(size), options_(std::move(options)), executor_(executor) {
    // Numbers of vertices and tetrahedra of other meshes than those made here.
    options_.field.vertex_of.clear();
    options_.recombination.regions = {};
    options_.recombination.finder.free_tets = {};
    if (!options_.observer) return;
    for (Observer* observer : {&options_.cross_field.observer, &options_.field.observer, &options_.lattice.observer,
                               &options_.surface.observer, &options_.volume.observer, &options_.recombination.observer})
      *observer = options_.observer;
  }

  /// @param input  with its features; its patches bound `regions`.
  MeshingResult run(Surface input, SurfaceRegions regions) {
    input_ = std::move(input);
    regions_ = std::move(regions);
    locator_ = SurfaceLocator(input_);
    check_sizes();
    refine_surface();
    if (!make_field()) return cancelled();
    if (options_.order == PointOrder::lattice && !make_lattice()) return cancelled();
    if (!sample_surface()) return cancelled();
    watch_.lap(seconds_.insertion);
    if (!retriangulate_surface()) return cancelled();
    watch_.lap(seconds_.tetrahedralization);
    if (!fill_volume()) return cancelled();
    watch_.lap(seconds_.insertion);
    if (!make_tets()) return cancelled();
    watch_.lap(seconds_.tetrahedralization);
    if (!recombine_tets()) return cancelled();
    sample_field();
    return std::move(result_);
  }

private:
  using Field = FrameField<IndexedTetMesh>;

  MeshingResult cancelled() {
    MeshingResult nothing;
    nothing.status = Status::cancelled;
    return nothing;
  }

  bool going(std::string_view stage, double fraction) const { return keep_going(options_.observer, stage, fraction); }

  /// Sizes that ask for too much are refused before anything is made of them.
  void check_sizes() const {
    check_estimate("surface", estimate_surface_points(input_, size_).n_points, options_.surface.max_points);
    double n_points = 0;
    for (index_t region = 0; region < regions_.n_regions; ++region) {
      const RegionSurface part = region_surface(input_, regions_, region);
      const Eigen::AlignedBox3d box = bounding_box(part.surface.points);
      const SurfaceLocator locator(part.surface);
      n_points += estimate_volume_points(box.min(), box.max(), SurfaceDomain{locator}, size_).n_points;
    }
    check_estimate("volume", n_points, options_.volume.max_points);
    check_background_edge(input_, background_edge(input_), options_.max_background_points);
  }

  double background_edge(const Surface& surface) const {
    if (options_.background_edge) return *options_.background_edge;
    double sum = 0;
    index_t hint = no_index;
    for (const Vector3& p : surface.points) sum += checked_size(size_, p, hint);
    return sum / static_cast<double>(surface.points.size());
  }

  /// Features are those of the input; the rest works on triangles no longer than the background's.
  void refine_surface() {
    const double edge = background_edge(input_);
    surface_ = refine(input_, [edge](const Vector3&) { return edge; }, {.locator = &locator_}).surface;
    result_.statistics.n_feature_curves = surface_.features.curves.size();
    result_.statistics.n_patches = surface_.features.n_patches;
    result_.statistics.n_regions = regions_.n_regions;
  }

  /// Tetrahedra in each region; regions share the vertices of the surface between them.
  ///
  /// @param interior  callable: surface of a region, its number -> points inside.
  template <class Interior>
  Tetrahedralization fill_regions(Interior&& interior) {
    Tetrahedralization all;
    all.mesh.points = surface_.points;
    tet_regions_.clear();
    for (index_t region = 0; region < regions_.n_regions; ++region) {
      const RegionSurface part = region_surface(surface_, regions_, region);
      const std::vector<Vector3> points = interior(part.surface, region);
      Tetrahedralization filled = tetrahedralize(tetrahedralizer_, part.surface, points, options_.observer);
      if (filled.status != Status::complete) return filled;
      const std::size_t n_surface = part.vertex_of.size(), first = all.mesh.points.size();
      const auto number = [&](index_t v) {
        return v < n_surface ? part.vertex_of[v] : static_cast<index_t>(first + v - n_surface);
      };
      for (const auto& t : filled.mesh.tets)
        all.mesh.tets.push_back({number(t[0]), number(t[1]), number(t[2]), number(t[3])});
      all.mesh.points.insert(all.mesh.points.end(), filled.mesh.points.begin() + static_cast<std::ptrdiff_t>(n_surface),
                             filled.mesh.points.end());
      all.n_extra_points += filled.n_extra_points;
      tet_regions_.resize(all.mesh.tets.size(), region);
      if (regions_.n_regions == 1) all.adjacency = std::move(filled.adjacency);
    }
    if (regions_.n_regions > 1) all.adjacency = make_adjacency(all.mesh);
    return all;
  }

  /// The background mesh is the field's own business.
  bool make_field() {
    if (!going("background mesh", 0)) return false;
    const double edge = background_edge(surface_);
    Tetrahedralization background = fill_regions([&](const IndexedTriangleMesh& part, index_t) {
      const SurfaceLocator own = regions_.n_regions == 1 ? SurfaceLocator() : SurfaceLocator(part);
      return background_points(part, regions_.n_regions == 1 ? locator_ : own, edge, executor_,
                               options_.max_background_points);
    });
    result_.statistics.n_background_tets = background.mesh.tets.size();
    if (background.status != Status::complete) return false;
    watch_.lap(seconds_.background);

    cross_field_ = compute_cross_field(surface_, options_.cross_field);
    if (cross_field_.status == Status::cancelled) return false;
    FieldReport report;
    if (options_.interfaces == InterfaceFrames::free && has_interfaces()) {
      const auto [outer, vertex_of] = outer_boundary();
      FieldOptions options = options_.field;
      options.vertex_of = vertex_of;
      const SurfaceCrossField outer_crosses = compute_cross_field(outer, options_.cross_field);
      if (outer_crosses.status == Status::cancelled) return false;
      field_.emplace(compute_frame_field(background.mesh, std::move(background.adjacency), outer, outer_crosses.frames,
                                         options, executor_, &report));
    } else {
      field_.emplace(compute_frame_field(background.mesh, std::move(background.adjacency), surface_,
                                         cross_field_.frames, options_.field, executor_, &report));
    }
    if (report.status == Status::cancelled) return false;
    // Surface points that follow the volume's idea of the cross meet the volume's points in step.
    if (options_.field.method == FieldMethod::best && options_.field.surface_cross == SurfaceCross::free)
      cross_field_.frames = surface_crosses(*field_, surface_);
    note_field();
    watch_.lap(seconds_.field);
    return true;
  }

  bool has_interfaces() const {
    for (index_t patch = 0; patch < regions_.sides.size(); ++patch)
      if (regions_.is_interface(patch)) return true;
    return false;
  }

  /// The surface without its interfaces, and the vertices that it keeps.
  std::pair<Surface, std::vector<index_t>> outer_boundary() const {
    SurfaceRegions outer = regions_;
    for (auto& [behind, front] : outer.sides) behind = front == no_index ? 0 : 1;
    RegionSurface part = region_surface(surface_, outer, 0);
    return {Surface(part.surface, {.angle = options_.features.angle, .corner_angle = options_.features.corner_angle}),
            std::move(part.vertex_of)};
  }

  void note_field() {
    const auto& smoothness = field_->smoothness();
    MeshingStatistics& s = result_.statistics;
    for (const double value : smoothness) {
      s.smoothness_mean += value / static_cast<double>(smoothness.size());
      s.fraction_smooth += (value >= 0.85 ? 1.0 : 0.0) / static_cast<double>(smoothness.size());
    }
    s.dirichlet_energy = field_->dirichlet_energy();
    SingularGraph singular = singular_graph(field_->adjacency(), field_->points(), field_->frames());
    s.n_singular_edges = singular.facets.size();
    result_.singular_lines = std::move(singular.polylines);
  }

  bool make_lattice() {
    if (!going("lattice", 0)) return false;
    if (regions_.n_regions > 1) {  // a lattice knows of no interfaces yet
      use_fronts();
      return true;
    }
    LatticeReport report;
    lattice_ = place_lattice(field_->adjacency(), field_->points(), field_->frames(), surface_, size_, options_.lattice,
                             executor_, &report);
    result_.statistics.lattice_volume = lattice_.complete_volume;
    constexpr double least_volume = 0.5;
    if (lattice_.complete_volume < least_volume) use_fronts();
    watch_.lap(seconds_.insertion);
    return report.status == Status::complete;
  }

  /// In place of a lattice of which too little is left.
  void use_fronts() {
    options_.order = PointOrder::smoothness;
    result_.statistics.lattice_volume = 0;
  }

  bool sample_surface() {
    if (!going("surface insertion", 0)) return false;
    if (options_.order == PointOrder::lattice) {
      const CurveInsertion curves = insert_curve_points(surface_, size_, options_.curves, &lattice_.curves);
      samples_ = fill_lattice_surface(surface_, cross_field_.frames, cross_field_.smoothness, curves, size_, lattice_,
                                      options_.surface);
      result_.statistics.n_surface_points = samples_.samples.size();
      return samples_.status != Status::cancelled;
    }
    const CurveInsertion curves = insert_curve_points(surface_, size_, options_.curves);
    const SurfaceCrossField cross = std::exchange(cross_field_, {});
    const auto insert = [&](auto order) {
      return insert_surface_points(surface_, cross.frames, cross.smoothness, curves, size_, options_.surface, order);
    };
    samples_ = options_.order == PointOrder::fifo ? insert(FifoOrder{}) : insert(SmoothnessOrder{});
    result_.statistics.n_surface_points = samples_.samples.size();
    return samples_.status != Status::cancelled;
  }

  bool retriangulate_surface() {
    if (!going("retriangulation", 0)) return false;
    Retriangulation again = retriangulate(surface_, samples_.samples, options_.retriangulation);
    result_.statistics.n_unremoved_vertices = again.n_unremoved;
    result_.statistics.n_repair_vertices = again.n_added;
    if (again.n_crossings > 0 && options_.order == PointOrder::lattice) {
      use_fronts();
      return sample_surface() && retriangulate_surface();
    }
    if (again.n_crossings > 0)
      throw invalid_surface(
          "the surface crosses itself, or comes so near to itself that triangles of the wished size do (" +
          std::to_string(again.n_crossings) + " pairs); use a smaller size");
    surface_ = std::move(again.surface);
    return true;
  }

  bool fill_volume() {
    seeds_ = std::exchange(samples_, {}).seeds();
    interior_.clear();
    for (index_t region = 0; region < regions_.n_regions; ++region) {
      const RegionSurface part = region_surface(surface_, regions_, region);
      const std::vector<BoundarySeed> seeds = seeds_of(part, region);
      // The boundary of the result, and not the input's, is what the points keep away from.
      const SurfaceLocator locator(part.surface);
      const SurfaceDomain domain{locator};
      const auto insert = [&](auto order) {
        return insert_volume_points(seeds, *field_, size_, domain, options_.volume, order);
      };
      VolumeInsertion volume =
          options_.order == PointOrder::fifo ? insert(FifoOrder{})
          : options_.order == PointOrder::smoothness
              ? insert(SmoothnessOrder{})
              : fill_lattice_volume(seeds, *field_, size_, domain, lattice_, *field_->locator(), options_.volume);
      if (volume.status == Status::cancelled) return false;
      interior_.emplace_back(volume.points.begin() + static_cast<std::ptrdiff_t>(volume.n_seeds), volume.points.end());
      result_.statistics.n_volume_points += interior_.back().size();
    }
    seeds_ = {};
    return true;
  }

  /// The samples on the boundary of a region, their normals out of it.
  std::vector<BoundarySeed> seeds_of(const RegionSurface& part, index_t region) const {
    std::vector<BoundarySeed> seeds;
    for (const index_t v : part.vertex_of) {
      if (v >= seeds_.size()) break;  // of the retriangulation's own
      BoundarySeed seed = seeds_[v];
      const index_t patch = surface_.features.triangle_patch[surface_.adjacency.triangles_of_vertex[v][0]];
      // Only samples inside patches have a normal.
      if (regions_.sides[patch][0] != region) seed.normal = -seed.normal;
      seeds.push_back(seed);
    }
    return seeds;
  }

  bool make_tets() {
    tets_ =
        fill_regions([&](const IndexedTriangleMesh&, index_t region) { return std::exchange(interior_[region], {}); });
    interior_.clear();
    result_.statistics.n_tets = tets_.mesh.tets.size();
    return tets_.status == Status::complete;
  }

  bool recombine_tets() {
    const FeatureGraph& features = surface_.features;
    std::vector<LabelledFace> faces;
    for (std::size_t t = 0; t < surface_.triangles().size(); ++t) {
      const auto& v = surface_.triangles()[t];
      faces.push_back({{v[0], v[1], v[2], no_index}, features.triangle_patch[t]});
    }
    std::vector<LabelledEdge> edges;
    for (std::size_t curve = 0; curve < features.curves.size(); ++curve) {
      const auto row = features.curves[curve];
      for (std::size_t i = 0; i + 1 < row.size(); ++i)
        edges.push_back({{row[i], row[i + 1]}, static_cast<index_t>(curve)});
    }
    surface_ = {};
    RecombineOptions options = options_.recombination;
    options.assembly.vertex_numbers = VertexNumbers::compact;  // nobody knows the tetrahedra's
    options.faces = faces;
    options.edges = edges;
    options.adjacency = &tets_.adjacency;
    if (regions_.n_regions > 1) options.regions = tet_regions_;
    if (options.assembly.improvement == ImprovementMode::improve && !options.assembly.boundary_projection)
      options.assembly.boundary_projection = boundary_slider(edges);
    result_.recombination = recombine(tets_.mesh, options, executor_);
    name_patches();
    StageSeconds& s = result_.recombination.seconds;
    s.background = seconds_.background;
    s.field = seconds_.field;
    s.insertion = seconds_.insertion;
    s.tetrahedralization = seconds_.tetrahedralization;
    return result_.recombination.status == Status::complete;
  }

  /// Faces get the host's labels where it has given some.
  void name_patches() {
    const std::vector<index_t>& given = options_.features.patches;
    if (given.empty()) return;
    std::vector<index_t> label(input_.features.n_patches);
    for (std::size_t t = 0; t < given.size(); ++t) label[input_.features.triangle_patch[t]] = given[t];
    for (LabelledFace& face : result_.recombination.mesh.faces)
      if (face.label != no_index) face.label = label[face.label];
  }

  /// Keeps boundary vertices on the input as it was given. Those that do not lie on it stay where they are.
  BoundarySlider boundary_slider(std::span<const LabelledEdge> edges) const {
    const double tolerance = 1e-6 * bounding_box(input_.points).diagonal().norm();
    return BoundarySlider(input_, locator_, tets_.mesh.points, edges, tolerance);
  }

  void sample_field() {
    index_t hint = no_index;
    for (const Vector3& p : result_.recombination.mesh.points) {
      const FrameSample sample = field_->sample(p, hint);
      result_.frames.push_back(sample.frame);
      result_.smoothness.push_back(sample.smoothness);
    }
  }

  const T& tetrahedralizer_;
  const Size& size_;
  MeshingOptions options_;
  const E& executor_;

  Stopwatch watch_;
  StageSeconds seconds_;
  MeshingResult result_;
  // Each stage takes what it needs and lets go of what no later one reads.
  Surface input_;
  SurfaceRegions regions_;  // of the input's patches, and of those made of them
  SurfaceLocator locator_;  // of the input
  Surface surface_;         // the input with short edges, then its new triangulation
  SurfaceCrossField cross_field_;
  std::optional<Field> field_;
  LatticePoints lattice_;
  SurfaceInsertion samples_;
  std::vector<BoundarySeed> seeds_;             // one a sample
  std::vector<std::vector<Vector3>> interior_;  // of each region
  Tetrahedralization tets_;
  std::vector<index_t> tet_regions_;
};

}  // namespace detail

/// The whole job: from a surface to a hex-dominant mesh of what it encloses.
///
/// The surface may separate several materials: edges where their patches meet have three or more triangles. Every region
/// is filled (see `find_regions`), and what lies between two is meshed once, so that they conform.
///
/// @param surface          any TriangleMesh without open edges; checked first. Normals of the outer boundary point
///                         outward. Coordinates in the host's unit.
/// @param size             wished edge length at a point: a callable `double(const Vector3&)` > 0, host's unit.
/// @param tetrahedralizer  fills surfaces with tetrahedra, e.g. `TetgenProcess`; its answers are checked.
/// @return the mesh with labels (regions when there are several; patches: those of `options.features.patches`, else of
///         `detect_features`; feature curves), frames, statistics and seconds of each stage.
/// @throws what `validate_surface`, `find_regions`, `tetrahedralize` and the stages throw; nothing is left behind.
/// @par Complexity   about O(n log n) in the number of points, but for the selection, which has its budget.
/// @par Determinism  The same for any executor, unless the selection is stopped by its time budget.
/// @par Source       The paper, section 1, and the stages' own. Departs: regions.
template <TriangleMesh M, Tetrahedralizer T, SizeField Size, Executor E = SerialExecutor>
MeshingResult mesh_surface(const M& surface, const Size& size, const T& tetrahedralizer,
                           const MeshingOptions& options = {}, const E& executor = {}) {
  check_options(options);
  validate_surface(surface);
  Surface input(surface, options.features);
  SurfaceRegions regions = find_regions(input);
  return detail::SurfaceMesher<T, Size, E>(tetrahedralizer, size, options, executor)
      .run(std::move(input), std::move(regions));
}

}  // namespace framehex
