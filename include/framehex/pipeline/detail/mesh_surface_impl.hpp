// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/bounding_box.hpp"
#include "framehex/insertion/curve_inserter.hpp"
#include "framehex/insertion/estimate.hpp"
#include "framehex/insertion/lattice_filling.hpp"
#include "framehex/insertion/surface_inserter.hpp"
#include "framehex/insertion/volume_inserter.hpp"
#include "framehex/pipeline/detail/better_mesh.hpp"
#include "framehex/pipeline/detail/field_statistics.hpp"
#include "framehex/pipeline/detail/obstacle.hpp"
#include "framehex/pipeline/detail/surface_labels.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "framehex/pipeline/recombine.hpp"
#include "framehex/surface/boundary_slider.hpp"
#include "framehex/surface/input_wedges.hpp"
#include "framehex/surface/refinement.hpp"
#include "framehex/surface/regions.hpp"
#include "framehex/surface/self_intersection.hpp"
#include "framehex/surface/surface_locator.hpp"
#include "framehex/tetrahedralization/background.hpp"
#include "framehex/tetrahedralization/flat_tets.hpp"
#include "framehex/tetrahedralization/repeated.hpp"

#include <optional>

namespace framehex::detail {

/// The job of `mesh_surface`, stage by stage; each method leaves what the next ones read.
class SurfaceMesher {
public:
  SurfaceMesher(const TetrahedralizerRef& tetrahedralizer, const SizeFieldRef& size, MeshingOptions options,
                const ExecutorRef& executor)
      : tetrahedralizer_(tetrahedralizer), size_(size), options_(std::move(options)), executor_(executor) {
    // Numbers of vertices and tetrahedra of other meshes than those made here.
    options_.field.vertex_of.clear();
    options_.recombination.regions = {};
    options_.recombination.finder.free_tets = {};
    MeshingOptions& o = options_;
    if (!o.observer) return;
    for (Observer* observer :
         {&o.cross_field.observer, &o.field.observer, &o.lattice.observer, &o.curves.observer, &o.surface.observer,
          &o.retriangulation.observer, &o.volume.observer, &o.recombination.observer})
      *observer = o.observer;
  }

  /// @param input  with its features.
  MeshingResult run(Surface input) {
    input_ = std::move(input);
    // Else its samples would cross at any size, and no side of a triangle would be a region's.
    if (!refuse_self_intersection(input_, options_.observer)) return cancelled<MeshingResult>();
    regions_ = find_regions(input_);
    locator_ = SurfaceLocator(input_);
    check_sizes();
    if (!refine_surface() || !make_field()) return cancelled<MeshingResult>();
    result_.statistics.order = options_.order;
    if (options_.order == PointOrder::lattice && !make_lattice()) return cancelled<MeshingResult>();
    if (!make_mesh()) return cancelled<MeshingResult>();
    if (result_.statistics.order == PointOrder::lattice && !try_other_points()) return cancelled<MeshingResult>();
    sample_field(*field_, result_);
    return std::move(result_);
  }

private:
  using Field = FrameField<IndexedTetMesh>;

  bool going(std::string_view stage, double fraction) const { return keep_going(options_.observer, stage, fraction); }

  /// Points, tetrahedra and cells. Where cells are poor these are made anew, first without the tetrahedra that lie flat
  /// under the surface, then with smaller sizes, then by fronts if a lattice has done no better with these; the best mesh
  /// stays.
  ///
  /// Ends after `most_rounds`, after two with smaller sizes that made it no better, or when these would ask for too many
  /// points: quality is not worth more.
  bool make_mesh() {
    constexpr int most_rounds = 5, most_vain = 2;
    const double wanted = options_.least_quality;
    const auto peel = [&] { return peel_flat_tets(tets_.mesh, tets_.adjacency, tet_regions_, surface_, wanted); };
    if (!place_points() || !recombine_tets()) return false;
    for (int round = 0, vain = 0; round < most_rounds && vain < most_vain; ++round) {
      const auto limits = limits_at_poor_cells(result_.poor_cells, result_.recombination.mesh, wanted, size_);
      if (limits.empty()) break;
      MeshingResult before = result_;
      bool peeled = false;
      try {
        peeled = peel() > 0;
        if (!peeled) {
          size_.add(limits);
          if (asks_for_too_much()) break;
          if (options_.order == PointOrder::lattice && vain > 0) use_fronts();
          if (options_.order == PointOrder::lattice && !make_lattice()) return false;
          if (!place_points()) return false;
          peel();
        }
        if (!recombine_tets()) return false;
      } catch (const error&) {  // smaller sizes have led nowhere
        result_ = std::move(before);
        break;
      }
      if (poverty(result_.poor_cells, wanted) < poverty(before.poor_cells, wanted)) continue;
      if (!peeled) ++vain;
      result_ = std::move(before);
    }
    result_.recombination.seconds = seconds_;
    return true;
  }

  /// A lattice with holes, or whose cells did not become hexahedra, can do worse than other points, and only the meshes
  /// tell: the best one stays. A seamless map may be bent where another has dislocations. A wall of one layer, which
  /// finite volumes do not take, may have two where no step is longer than the size; and there are fronts.
  bool try_other_points() {
    if (is_seamless() && share_of_hexahedra(result_.recombination.mesh) < least_good_hexahedra &&
        !remake([this] { return leave_lattice(); }))
      return false;
    if (is_sure()) return true;
    const auto shorter_steps = [this] {
      options_.lattice.scale.longest = 1;
      return make_lattice();
    };
    const bool no_layers = options_.recombination.assembly.fit == CellFit::finite_volume;
    if (no_layers && options_.lattice.scale.longest > 1 && !remake(shorter_steps)) return false;
    if (is_sure() || options_.order != PointOrder::lattice) return true;
    return remake([this] {
      use_fronts();
      return true;
    });
  }

  bool is_sure() const {
    return result_.statistics.lattice_volume > least_sure_lattice &&
           share_of_hexahedra(result_.recombination.mesh) > least_sure_hexahedra;
  }

  /// Makes the mesh anew after some change. The better one stays.
  template <class Change>
  bool remake(Change&& change) {
    MeshingResult before = result_;
    bool better = false;
    try {
      if (!change() || !make_mesh()) return false;
      better = is_better(result_, before, options_.least_quality);
    } catch (const error&) {  // of points that the mesh before did without
    }
    if (!better) result_ = std::move(before);
    result_.recombination.seconds = seconds_;
    return true;
  }

  bool asks_for_too_much() const {
    return estimate_surface_points(refined_, size_).n_points > 6 * n_points_wished_ + 3000;
  }

  /// From samples on the surface to the second tetrahedra. Where the surface comes so near to itself that this fails,
  /// the size is halved there, and points are placed anew.
  ///
  /// Ends after `most_rounds`: a surface that does not cross itself, and has not been meshed when its samples are a
  /// thousand times nearer to each other than wished, needs more points than anybody has memory for.
  bool place_points() {
    constexpr int most_rounds = 10;
    for (int round = 0;; ++round) {
      obstacle_ = {};
      if (!place_once()) return false;
      if (!obstacle_) return true;
      if (options_.order == PointOrder::lattice) {
        if (!leave_lattice()) return false;  // others may do without smaller sizes
        continue;
      }
      if (round == most_rounds || obstacle_.places.empty()) std::rethrow_exception(obstacle_.failure);
      size_.add(halved_sizes(obstacle_, size_));
    }
  }

  /// @return false when cancelled; the stage that fails leaves an obstacle.
  bool place_once() {
    if (!sample_surface()) return false;
    watch_.lap(seconds_.insertion);
    if (!retriangulate_surface()) return false;
    watch_.lap(seconds_.tetrahedralization);
    if (obstacle_) return true;
    if (!fill_volume()) return false;
    watch_.lap(seconds_.insertion);
    const bool complete = make_tets();
    watch_.lap(seconds_.tetrahedralization);
    return complete;
  }

  /// Sizes that ask for too much are refused before anything is made of them.
  void check_sizes() {
    n_points_wished_ = estimate_surface_points(input_, size_).n_points;
    check_estimate("surface", n_points_wished_, options_.surface.max_points);
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
  bool refine_surface() {
    const double edge = background_edge(input_);
    RefinedSurface refined =
        refine(input_, [edge](const Vector3&) { return edge; }, {.locator = &locator_, .observer = options_.observer});
    if (refined.status == Status::cancelled) return false;
    refined_ = std::move(refined.surface);
    result_.statistics.n_feature_curves = refined_.features.curves.size();
    result_.statistics.n_patches = refined_.features.n_patches;
    result_.statistics.n_regions = regions_.n_regions;
    return true;
  }

  /// Tetrahedra in each region; regions share the vertices of the surface between them. Where that fails it leaves an
  /// obstacle.
  ///
  /// @param interior  callable: surface of a region, its number -> points inside, not all of which need be used.
  template <class Interior>
  Tetrahedralization fill_regions(const Surface& surface, Interior&& interior) {
    Tetrahedralization all;
    all.mesh.points = surface.points;
    tet_regions_.clear();
    for (index_t region = 0; region < regions_.n_regions; ++region) {
      const RegionSurface part = region_surface(surface, regions_, region);
      Tetrahedralization filled = fill(part.surface, interior(part.surface, region));
      if (filled.status != Status::complete || obstacle_) return filled;
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

  Tetrahedralization fill(const IndexedTriangleMesh& surface, const std::vector<Vector3>& interior) {
    try {
      return tetrahedralize_repeatedly(tetrahedralizer_, surface, interior, options_.observer).result;
    } catch (const tetrahedralization_error& failure) {
      obstacle_ = failed_tetrahedralization(failure, surface, interior);
    } catch (const invalid_surface& failure) {
      obstacle_ = failed_tetrahedralization(failure, surface, interior);
    }
    return {};
  }

  /// The background mesh is the field's own business.
  bool make_field() {
    if (!going("background mesh", 0)) return false;
    const double edge = background_edge(refined_);
    Tetrahedralization background = fill_regions(refined_, [&](const IndexedTriangleMesh& part, index_t) {
      const SurfaceLocator own = regions_.n_regions == 1 ? SurfaceLocator() : SurfaceLocator(part);
      return background_points(part, regions_.n_regions == 1 ? locator_ : own, edge, executor_,
                               options_.max_background_points);
    });
    if (obstacle_) std::rethrow_exception(obstacle_.failure);
    result_.statistics.n_background_tets = background.mesh.tets.size();
    if (background.status != Status::complete) return false;
    watch_.lap(seconds_.background);

    cross_field_ = compute_cross_field(refined_, options_.cross_field);
    if (cross_field_.status == Status::cancelled) return false;
    FieldReport report;
    if (options_.interfaces == InterfaceFrames::free && regions_.has_interfaces()) {
      const auto [outer, vertex_of] = outer_boundary(refined_, regions_, options_.features);
      FieldOptions options = options_.field;
      options.vertex_of = vertex_of;
      const SurfaceCrossField outer_crosses = compute_cross_field(outer, options_.cross_field);
      if (outer_crosses.status == Status::cancelled) return false;
      field_.emplace(compute_frame_field(background.mesh, std::move(background.adjacency), outer, outer_crosses.frames,
                                         options, executor_, &report));
    } else {
      field_.emplace(compute_frame_field(background.mesh, std::move(background.adjacency), refined_,
                                         cross_field_.frames, options_.field, executor_, &report));
    }
    if (report.status == Status::cancelled) return false;
    // Surface points that follow the volume's idea of the cross meet the volume's points in step.
    if (options_.field.method == FieldMethod::best && options_.field.surface_cross == SurfaceCross::free)
      cross_field_.frames = surface_crosses(*field_, refined_);
    result_.singular_lines = describe(*field_, result_.statistics);
    watch_.lap(seconds_.field);
    return true;
  }

  bool make_lattice() {
    if (!going("lattice", 0)) return false;
    if (options_.interfaces == InterfaceFrames::free && regions_.has_interfaces()) {
      use_fronts();  // frames that cross an interface as they please have no whole coordinate there
      return true;
    }
    LatticeReport report;
    lattice_ = place_lattice(field_->adjacency(), field_->points(), field_->frames(), refined_, size_, options_.lattice,
                             executor_, &report);
    result_.statistics.lattice_volume = lattice_.complete_volume;
    result_.statistics.mapping = report.mapping;
    watch_.lap(seconds_.insertion);
    if (report.status != Status::complete) return false;
    return lattice_.complete_volume >= 0.5 || leave_lattice();  // no more than scraps of it
  }

  /// Takes a lattice with the other mapping, or else fronts.
  bool leave_lattice() {
    if (!is_seamless()) {
      use_fronts();
      return true;
    }
    options_.lattice.mapping = LatticeMapping::phases;
    return make_lattice();
  }

  bool is_seamless() const { return result_.statistics.mapping == LatticeMapping::seamless; }

  void use_fronts() {
    options_.order = result_.statistics.order = PointOrder::smoothness;
    result_.statistics.mapping = LatticeMapping::phases;
    result_.statistics.lattice_volume = 0;
  }

  bool sample_surface() {
    if (!going("surface insertion", 0)) return false;
    if (options_.order == PointOrder::lattice) {
      const CurveInsertion curves = insert_curve_points(refined_, size_, options_.curves, &lattice_.curves);
      if (curves.status == Status::cancelled) return false;
      samples_ = fill_lattice_surface(refined_, cross_field_.frames, cross_field_.smoothness, curves, size_, lattice_,
                                      options_.surface);
      result_.statistics.n_surface_points = samples_.samples.size();
      return samples_.status != Status::cancelled;
    }
    const CurveInsertion curves = insert_curve_points(refined_, size_, options_.curves);
    if (curves.status == Status::cancelled) return false;
    const auto insert = [&](auto order) {
      return insert_surface_points(refined_, cross_field_.frames, cross_field_.smoothness, curves, size_,
                                   options_.surface, order);
    };
    samples_ = options_.order == PointOrder::fifo ? insert(FifoOrder{}) : insert(SmoothnessOrder{});
    result_.statistics.n_surface_points = samples_.samples.size();
    return samples_.status != Status::cancelled;
  }

  bool retriangulate_surface() {
    Retriangulation again = retriangulate(refined_, samples_.samples, options_.retriangulation);
    if (again.status == Status::cancelled) return false;
    result_.statistics.n_unremoved_vertices = again.n_unremoved;
    result_.statistics.n_repair_vertices = again.n_added;
    surface_ = std::move(again.surface);
    if (!again.crossings.empty()) obstacle_ = crossing_triangles(surface_, again.crossings);
    return true;
  }

  bool fill_volume() {
    seeds_ = std::exchange(samples_, {}).seeds();
    interior_.clear();
    result_.statistics.n_volume_points = 0;
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
    tets_ = fill_regions(
        surface_, [&](const IndexedTriangleMesh&, index_t region) { return std::exchange(interior_[region], {}); });
    interior_.clear();
    result_.statistics.n_tets = tets_.mesh.tets.size();
    return tets_.status == Status::complete;
  }

  bool recombine_tets() {
    const std::vector<LabelledFace> faces = patch_labels(surface_);
    const std::vector<LabelledEdge> edges = curve_labels(surface_);
    RecombineOptions options = options_.recombination;
    options.assembly.vertex_numbers = VertexNumbers::compact;  // nobody knows the tetrahedra's
    options.faces = faces;
    options.edges = edges;
    options.adjacency = &tets_.adjacency;
    if (regions_.n_regions > 1) options.regions = tet_regions_;
    if (options.assembly.improvement == ImprovementMode::improve && !options.assembly.boundary_projection)
      options.assembly.boundary_projection = boundary_slider(edges);
    result_.recombination = recombine(tets_.mesh, options, executor_);
    const StageSeconds& s = result_.recombination.seconds;
    seconds_.search += s.search;
    seconds_.selection += s.selection;
    seconds_.assembly += s.assembly;
    watch_ = {};
    if (result_.recombination.status != Status::complete || !going("checks", 1)) return false;
    name_patches(result_.recombination.mesh, input_.features, options_.features.patches);
    result_.poor_cells = find_poor_cells(result_.recombination.mesh, options_.least_quality,
                                         [this](const Vector3& p) { return is_in_wedge(p); });
    result_.size_limits = size_.limits();
    return true;
  }

  /// Is a point so near to an edge of the input where two faces enclose a small angle that there is no room for cells of
  /// the size?
  bool is_in_wedge(const Vector3& p) {
    if (!wedges_) wedges_.emplace(input_, regions_);
    return wedges_->hold(p, size_(p));
  }

  /// Keeps boundary vertices on the input as it was given. Those that do not lie on it stay where they are.
  BoundarySlider boundary_slider(std::span<const LabelledEdge> edges) const {
    const double tolerance = 1e-6 * bounding_box(input_.points).diagonal().norm();
    return BoundarySlider(input_, locator_, tets_.mesh.points, edges, tolerance);
  }

  // Shares of the volume, in a lattice and in hexahedra, with less of which fronts have been ahead on some bodies.
  static constexpr double least_sure_lattice = 0.975, least_sure_hexahedra = 0.9;
  // With less another mapping has been ahead.
  static constexpr double least_good_hexahedra = 0.985;

  const TetrahedralizerRef& tetrahedralizer_;
  LimitedSize<SizeFieldRef> size_;
  MeshingOptions options_;
  const ExecutorRef& executor_;

  Stopwatch watch_;
  StageSeconds seconds_;
  MeshingResult result_;
  // Each stage takes what it needs and lets go of what no later one reads.
  Surface input_;
  SurfaceRegions regions_;             // of the input's patches, and of those made of them
  SurfaceLocator locator_;             // of the input
  std::optional<InputWedges> wedges_;  // of the input, when they are asked for
  double n_points_wished_ = 0;         // on the surface, about
  Surface refined_;                    // the input with short edges
  SurfaceCrossField cross_field_;
  std::optional<Field> field_;
  LatticePoints lattice_;
  Obstacle obstacle_;
  SurfaceInsertion samples_;
  Surface surface_;                             // the triangulation through them
  std::vector<BoundarySeed> seeds_;             // one a sample
  std::vector<std::vector<Vector3>> interior_;  // of each region
  Tetrahedralization tets_;
  std::vector<index_t> tet_regions_;
};

FRAMEHEX_INLINE MeshingResult mesh_valid_surface(Surface input, const SizeFieldRef& size,
                                                 const TetrahedralizerRef& tetrahedralizer, MeshingOptions options,
                                                 const ExecutorRef& executor) {
  return SurfaceMesher(tetrahedralizer, size, std::move(options), executor).run(std::move(input));
}

}  // namespace framehex::detail
