// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/lemon_matcher.hpp"
#include "framehex/adapters/mesh_reader.hpp"
#include "framehex/io/outline_reader.hpp"
#include "framehex/pipeline/mesh_planar.hpp"
#include "framehex/pipeline/mesh_shell.hpp"
#include "framehex/surface/detail/outline_names.hpp"
#include "framehex/verify/quad_quality.hpp"

#include "commands.hpp"
#include "library_options.hpp"
#include "report.hpp"

#include <filesystem>

namespace program {

namespace {

framehex::QuadMeshingOptions meshing_options(const Options& options, const framehex::Observer& observer) {
  framehex::QuadMeshingOptions meshing;
  meshing.features = feature_options(options);
  // One angle for all: bends that stand out between straight parts are corners from a quarter of it on, as by default.
  meshing.features.corner_angle = meshing.features.angle;
  meshing.bends.angle = meshing.features.angle / 4;
  meshing.order = options.front_order == "fifo" ? framehex::FrontOrder::fifo : framehex::FrontOrder::smoothness;
  if (options.match == "greedy") meshing.quads.goal = framehex::QuadGoal::pairs;
  if (!options.improve) meshing.improvement.scope = framehex::QuadImprovementScope::folded;
  meshing.observer = observer;
  return meshing;
}

framehex::PlanarOutline read_input_outline(const std::string& name) {
  const std::string extension = std::filesystem::path(name).extension().string();
  for (const char* const known : {".vtu", ".vtk", ".msh", ".mesh", ".meshb"})
    if (extension == known)
      return framehex::outline_of_edges(name, framehex::read_mesh(name, {.volume = framehex::Volume::optional}));
  return framehex::read_outline(name);
}

/// The triangles on which the cross field is, with its axes and smoothness.
void write_crosses(const Options& options, const framehex::QuadMeshing& result) {
  if (options.crosses.empty()) return;
  framehex::MixedMesh mesh;
  mesh.points = result.background.points;
  for (const auto& t : result.background.triangles()) mesh.faces.push_back({{t[0], t[1], t[2], framehex::no_index}, 0});
  framehex::MeshData data{.cells = {framehex::frame_array(result.cross_field.frames)},
                          .points = {{"smoothness", result.cross_field.smoothness}}};
  framehex::write_mesh(options.crosses, mesh, data);
}

/// Counts and quality of a mesh.
nlohmann::ordered_json report(const framehex::QuadMesh& mesh, const framehex::verify::QuadQuality& quality) {
  nlohmann::ordered_json json;
  json["counts"] = {{"vertices", mesh.points.size()},
                    {"cells", mesh.cells.size()},
                    {"quadrilaterals", quality.n_quads},
                    {"triangles", quality.n_triangles}};
  const auto n = static_cast<double>(mesh.cells.size());
  json["quad_ratio"] = {{"number", static_cast<double>(quality.n_quads) / n},
                        {"area", quality.quad_area / quality.area}};
  json["quality"] = {{"scaled_jacobian_min", quality.least}, {"scaled_jacobian_mean", quality.mean},
                     {"folded_cells", quality.folded},       {"irregular_vertices", quality.n_irregular},
                     {"index_sum", quality.index_sum},       {"euler_characteristic", quality.euler_characteristic}};
  return json;
}

void add_course(nlohmann::ordered_json& json, const framehex::QuadMeshing& result) {
  const framehex::QuadMeshingStatistics& s = result.statistics;
  const framehex::QuadStageSeconds& t = result.seconds;
  json["field"] = {{"singularities", s.n_singularities}};
  json["points"] = {{"samples", s.n_points},
                    {"unremoved", s.n_unremoved_vertices},
                    {"added", s.n_added_vertices},
                    {"triangles", s.n_triangles},
                    {"opened_vertices", s.n_opened_vertices},
                    {"lengthened_curves", s.lengthened_curves},
                    {"split_edges", s.n_split_edges},
                    {"widened", s.n_widened_edges},
                    {"shrunk", s.n_shrunk_places},
                    {"unfolded", s.n_unfolded},
                    {"tried_changes", s.n_tried_changes},
                    {"left_triangles", s.n_left_triangles}};
  json["deviation"] = s.deviation;
  json["seconds"] = {{"preparation", t.preparation},
                     {"field", t.field},
                     {"insertion", t.insertion},
                     {"triangulation", t.triangulation},
                     {"quadrangulation", t.quadrangulation},
                     {"improvement", t.improvement},
                     {"total", t.total()}};
}

void print_summary(const framehex::QuadMesh& mesh, const framehex::verify::QuadQuality& quality) {
  std::printf(
      "%zu quadrilaterals, %zu triangles (quadrilaterals %.1f %% by number, %.1f %% by area), scaled Jacobian "
      "%.3f at least, %.3f on average, %zu irregular vertices",
      quality.n_quads, quality.n_triangles,
      100 * static_cast<double>(quality.n_quads) / static_cast<double>(mesh.cells.size()),
      100 * quality.quad_area / quality.area, quality.least, quality.mean, quality.n_irregular);
}

/// Where a result is less than what was asked for.
std::vector<std::string> shortcomings_of(const framehex::QuadMeshingStatistics& s, const char* input) {
  constexpr double far = 0.01;
  std::vector<std::string> texts;
  if (s.n_left_triangles > 0)
    texts.push_back(
        std::to_string(s.n_left_triangles) +
        " triangles are left: no attempt found convex quadrilaterals alone, as where corners are very sharp");
  if (s.deviation > far) {
    std::array<char, 120> text{};
    std::snprintf(text.data(), text.size(),
                  "the mesh is up to %.2f %% of the diagonal away from the %s: a smaller size comes nearer",
                  100 * s.deviation, input);
    texts.emplace_back(text.data());
  }
  return texts;
}

/// A curve by its ends, with the polyline that it is of.
std::string name_of_curve(const framehex::QuadMeshing& result, framehex::index_t curve,
                          const framehex::PlanarOutline* outline) {
  const framehex::Surface& background = result.background;
  const auto row = background.features.curves[curve];
  const auto place = [&](framehex::index_t v) {
    const framehex::Vector3& p = background.points[v];
    std::array<char, 100> text{};
    if (outline)
      std::snprintf(text.data(), text.size(), "(%g, %g)", p.x(), p.y());
    else
      std::snprintf(text.data(), text.size(), "(%g, %g, %g)", p.x(), p.y(), p.z());
    return std::string(text.data());
  };
  std::string text = "the curve";
  if (outline) {
    // Vertices of the outline keep their numbers; those between them come after.
    std::vector<framehex::index_t> given;
    for (const framehex::index_t v : row)
      if (v < outline->points.size() && given.size() < 2) given.push_back(v);
    if (given.size() == 2)
      if (const std::string owner = framehex::detail::OutlineNames(*outline).owner_of_segment(given[0], given[1]);
          !owner.empty())
        text = owner;
  }
  return text + ", from " + place(row.front()) + " to " + place(row.back()) + ",";
}

/// What both commands do with a result. @param outline  of a planar domain. @return false: interrupted.
bool write_quads(const Options& options, const framehex::QuadMeshing& result, const framehex::PlanarOutline* outline) {
  if (result.status == framehex::Status::cancelled) return false;
  const framehex::verify::QuadQuality quality = framehex::verify::quad_quality(result.mesh);
  nlohmann::ordered_json json = report(result.mesh, quality);
  add_course(json, result);
  const std::vector<std::string> shortcomings = shortcomings_of(result.statistics, outline ? "outline" : "surface");
  if (!shortcomings.empty()) json["warnings"] = shortcomings;
  finish(json, options);
  write_crosses(options, result);
  write_results(options, framehex::mixed_mesh(result.mesh),
                {.cells = {{"scaled_jacobian", quality.scaled_jacobian}}, .points = {}}, json);
  end_progress();
  for (const framehex::index_t curve : result.statistics.lengthened_curves)
    remark(options, name_of_curve(result, curve, outline) +
                        " has one interval more than its length gives, so that the region has an even number");
  for (const std::string& text : shortcomings) remark(options, text);
  if (!options.quiet) {
    print_summary(result.mesh, quality);
    std::printf(", %.2f s\n", result.seconds.total());
  }
  return true;
}

template <class Mesh>
bool mesh_quads(const Options& options, const framehex::Observer& observer, const framehex::PlanarOutline* outline,
                Mesh&& mesh) {
  const framehex::QuadMeshingOptions meshing = meshing_options(options, observer);
  const framehex::ConstantSize size{*options.size};
  return write_quads(options,
                     options.match == "greedy" ? mesh(size, framehex::GreedyMatcher{}, meshing)
                                               : mesh(size, framehex::LemonMatcher{}, meshing),
                     outline);
}

}  // namespace

bool plane(const Options& options, const framehex::Observer& observer) {
  const framehex::PlanarOutline outline = read_input_outline(options.input);
  return mesh_quads(options, observer, &outline, [&](const auto& size, const auto& matcher, const auto& meshing) {
    return framehex::mesh_planar(outline, size, matcher, meshing);
  });
}

bool shell(const Options& options, const framehex::Observer& observer) {
  const framehex::SoupSurface soup = framehex::read_any_surface(options.input);
  return mesh_quads(options, observer, nullptr, [&](const auto& size, const auto& matcher, auto meshing) {
    meshing.features.patches = soup.patches;
    return framehex::mesh_shell(soup.surface, size, matcher, meshing);
  });
}

bool inspect_faces(const Options& options, const framehex::MixedMesh& mesh) {
  if (mesh.faces.empty()) throw framehex::io_error(options.input + ": holds neither cells nor faces");
  framehex::QuadMesh quads;
  quads.points = mesh.points;
  for (const framehex::LabelledFace& face : mesh.faces) quads.cells.push_back(face.vertices);
  const framehex::verify::QuadQuality quality = framehex::verify::quad_quality(quads);
  nlohmann::ordered_json json = report(quads, quality);
  add_groups(json, mesh);
  finish(json, options);
  write_report(options, json);
  if (options.quiet) return true;
  print_summary(quads, quality);
  std::printf("\n");
  if (!quality.folded.empty())
    std::printf("folded cells: %zu (the first is %u)\n", quality.folded.size(), quality.folded.front());
  return true;
}

}  // namespace program
