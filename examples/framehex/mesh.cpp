// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/compiled.hpp"
#include "framehex/adapters/mesh_reader.hpp"
#include "framehex/adapters/tetgen_process.hpp"

#include "framehex/geometry/bounding_box.hpp"
#include "framehex/io/bodies.hpp"
#include "framehex/io/surface_faults.hpp"
#include "framehex/pipeline/memory_estimate.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "framehex/surface/feature_carriers.hpp"
#include "framehex/surface/narrow_features.hpp"
#include "framehex/surface/regions.hpp"

#include "commands.hpp"
#include "library_options.hpp"
#include "report.hpp"
#include "sizes.hpp"

namespace program {

namespace {

framehex::SoupSurface read_repaired(const Options& options, framehex::MeshReadNotes& notes) {
  framehex::SoupRepair repair;
  const auto touching =
      options.bodies == "regions" ? framehex::TouchingFaces::divided : framehex::TouchingFaces::opened;
  framehex::SoupSurface soup = framehex::read_any_surface_repaired(options.input, *options.repair, repair,
                                                                   {.regions = options.regions}, &notes, touching);
  if (repair.n_repeated > 0) remark(options, "repeated triangles were dropped: " + std::to_string(repair.n_repeated));
  if (repair.n_split > 0)
    remark(options, "edges were split at vertices in their middle: " + std::to_string(repair.n_split));
  if (repair.weld_tolerance > 0) {
    char text[80];
    std::snprintf(text, sizeof text, "vertices within %.3g were welded", repair.weld_tolerance);
    remark(options, text);
  }
  return soup;
}

bool repair_mends(const Options& options) {
  framehex::SurfaceSoup soup = framehex::read_any_surface_soup(options.input, {.regions = options.regions});
  framehex::repair_soup(soup);
  try {
    framehex::check_closed(framehex::surface_of_soup(soup));
    return true;
  } catch (const framehex::error&) {
    return false;
  }
}

/// Are these bodies that touch in whole triangles?
bool bodies_touch(framehex::SoupSurface soup) {
  try {
    framehex::merge_walls(soup);
    framehex::check_complex(soup);
    framehex::check_crossings(soup);
    framehex::turn_to_regions(soup.surface);
    return framehex::find_regions(framehex::Surface(soup.surface)).n_regions > 1;
  } catch (const framehex::error&) {
    return false;
  }
}

/// Bodies that touch share what is between them, and each is a region.
void make_regions(framehex::SoupSurface& soup, const Options& options) {
  if (const std::size_t n = framehex::merge_walls(soup); n > 0)
    remark(options,
           std::to_string(n) + " triangles in which bodies touch others were dropped: each pair of faces is one");
  framehex::check_complex(soup);
  framehex::check_crossings(soup);
  framehex::turn_to_regions(soup.surface);
}

/// Checks the surface, and turns it to bound what is wanted.
void check_input(framehex::SoupSurface& soup, const Options& options) {
  if (options.bodies == "regions") return make_regions(soup, options);
  try {
    framehex::check_closed(soup);
  } catch (const framehex::nonmanifold&) {
    const bool touch = bodies_touch(soup);
    if (touch && options.repair) {
      remark(options, "bodies touch: each is a region");
      return make_regions(soup, options);
    }
    if (touch)
      remark(options, "--bodies regions would make a region of each body:");
    else if (!options.repair && repair_mends(options))
      remark(options, "--repair would mend this:");
    throw;
  } catch (const framehex::open_surface&) {
    if (!options.repair && repair_mends(options)) remark(options, "--repair would mend this:");
    throw;
  }
  framehex::check_crossings(soup);
  if (soup.n_cavities > 0)
    remark(options, (soup.n_cavities == 1 ? std::string("a closed part of the surface lies")
                                          : std::to_string(soup.n_cavities) + " closed parts of the surface lie") +
                        " within another: void, or a region with --bodies regions");
}

framehex::SoupSurface read_input(const Options& options) {
  framehex::MeshReadNotes notes;
  framehex::SoupSurface soup = options.repair
                                   ? read_repaired(options, notes)
                                   : framehex::read_any_surface(options.input, {.regions = options.regions}, &notes);
  remark_arrays(options, notes, "patches");
  if (options.bodies != "regions" && soup.n_turned_triangles > 0)
    remark(options, std::to_string(soup.n_turned_triangles) + " of " + std::to_string(soup.surface.triangles.size()) +
                        " triangles were turned to look away from the material");
  if (soup.welded_by_tolerance) remark(options, "vertices within a millionth of its box were welded to close it");
  const double share = soup.rounding / framehex::bounding_box(soup.surface.points).diagonal().norm();
  if (share > 1e-5) {
    char text[200];
    std::snprintf(
        text, sizeof text,
        "its coordinates are single precision, rounded by up to %.2g, %.2g of its size: move it to the origin "
        "before it is written",
        soup.rounding, share);
    remark(options, text);
  }
  return soup;
}

std::string near(const framehex::Vector3& p) {
  char text[120];
  std::snprintf(text, sizeof text, "near (%.4g, %.4g, %.4g)", p.x(), p.y(), p.z());
  return text;
}

std::string and_more(std::size_t n) {
  return n > 1 ? " and " + std::to_string(n - 1) + " other places" : "";
}

/// Where the sizes are smaller than asked for, and which cells are poor all the same.
void tell_exceptions(const Options& options, const framehex::MeshingResult& result, double size,
                     nlohmann::ordered_json& json) {
  const auto place = [](const framehex::Vector3& p) { return std::vector<double>{p.x(), p.y(), p.z()}; };
  auto& sizes = json["sizes"];
  sizes["least"] = size;
  sizes["limited_places"] = result.size_limits.size();
  for (const framehex::SizeLimit& limit : result.size_limits)
    sizes["limits"].push_back({{"place", place(limit.place)}, {"length", limit.length}});
  if (!result.size_limits.empty()) {
    const framehex::SizeLimit& least = result.size_limits.front();
    sizes["least"] = least.length;
    char text[80];
    std::snprintf(text, sizeof text, "the size is smaller, down to %.3g of %.3g, ", least.length, size);
    remark(options, text + near(least.place) + and_more(result.size_limits.size()) +
                        ", where the surface comes too near itself for it");
  }
  std::size_t n_forced = 0;
  for (const framehex::PoorCell& poor : result.poor_cells) {
    json["quality"]["poor_cells"].push_back({{"cell", poor.cell},
                                             {"scaled_jacobian", poor.quality},
                                             {"place", place(poor.place)},
                                             {"input_angle", poor.input_angle}});
    n_forced += poor.input_angle ? 1 : 0;
  }
  if (result.poor_cells.empty()) return;
  const auto& poorest = *std::ranges::min_element(result.poor_cells, {}, &framehex::PoorCell::quality);
  char text[160];
  std::snprintf(text, sizeof text,
                "%zu cells have a scaled Jacobian below 0.05, %zu of them forced by angles of the surface: %.2g ",
                result.poor_cells.size(), n_forced, poorest.quality);
  remark(options, text + near(poorest.place) + and_more(result.poor_cells.size()));
}

/// @return the number of vertices merged.
std::size_t merge_narrow(const Options& options, framehex::SoupSurface& soup, double least) {
  framehex::MergedFeatures merged = framehex::merge_narrow_features(soup.surface, least);
  if (merged.n_merged == 0) return 0;
  char text[120];
  std::snprintf(text, sizeof text, "features narrower than %.3g were merged: %zu vertices", least, merged.n_merged);
  remark(options, text);
  for (auto* of_triangles : {&soup.soup_triangles, &soup.polygons, &soup.patches}) {
    if (of_triangles->empty()) continue;
    std::vector<framehex::index_t> kept;
    for (const framehex::index_t t : merged.parent) kept.push_back((*of_triangles)[t]);
    *of_triangles = std::move(kept);
  }
  soup.surface = std::move(merged.surface);
  return merged.n_merged;
}

/// Where cells came out poor, merging more may be what helps.
void suggest_merging(const Options& options, const framehex::SoupSurface& soup, double size) {
  const double least = size / 100;
  const std::size_t n = framehex::merge_narrow_features(soup.surface, least).n_merged;
  if (n == 0) return;
  char text[160];
  std::snprintf(text, sizeof text, "--least-feature %.3g would merge narrower ledges, steps and grooves: %zu vertices",
                least, n);
  remark(options, text);
}

/// @throws framehex::invalid_option  when more memory is likely to be taken than is allowed.
void check_memory(const Options& options, const framehex::SoupSurface& soup, const framehex::FeatureOptions& features,
                  const framehex::GradedSize& size) {
  if (!options.memory) return;
  const framehex::Surface surface(soup.surface, features);
  const framehex::MemoryEstimate needed = framehex::estimate_memory(surface, framehex::find_regions(surface), size);
  if (needed.n_bytes <= *options.memory) return;
  char text[200];
  std::snprintf(text, sizeof text, "about %.3g MB are needed for about %.3g points, more than --memory %.3g MB allows",
                needed.n_bytes / 1e6, needed.n_points, *options.memory / 1e6);
  throw framehex::invalid_option(text);
}

/// Nodes on the edges, on the patches and curves of the surface as it was given.
framehex::MidsideNodes quadratic_nodes(const framehex::MixedMesh& mesh, const framehex::SoupSurface& soup,
                                       const framehex::FeatureOptions& features, nlohmann::ordered_json& json) {
  framehex::Surface surface(soup.surface, features);
  if (!soup.patches.empty()) {  // these are the labels of the mesh's faces
    surface.features.triangle_patch = soup.patches;
    surface.features.n_patches = static_cast<framehex::index_t>(soup.patch_names.size());
  }
  const framehex::FeatureCarriers carriers(surface);
  framehex::MidsideNodes nodes = framehex::midside_nodes(
      mesh, [&](int dimension, framehex::index_t label, const framehex::Vector3& middle) -> framehex::Vector3 {
        return dimension == 1 ? carriers.onto_curve(label, middle) : carriers.onto_patch(label, middle).point;
      });
  json["quadratic"] = {
      {"edges", nodes.edges.size()}, {"curved", nodes.n_curved}, {"straightened", nodes.n_straightened}};
  return nodes;
}

}  // namespace

bool mesh(const Options& options, const framehex::Observer& observer) {
  framehex::SoupSurface soup = read_input(options);
  check_input(soup, options);
  const framehex::IndexedTriangleMesh& surface = soup.surface;
  framehex::MeshingOptions meshing;
  meshing.features = feature_options(options);
  meshing.features.patches = soup.patches;
  nlohmann::ordered_json json_of_sizes;
  const framehex::GradedSize sizes = make_size(options, soup, meshing.features, json_of_sizes);
  const double least_feature = options.least_feature.value_or(sizes.options().most / 1000);
  const std::size_t n_merged = merge_narrow(options, soup, least_feature);
  meshing.features.patches = soup.patches;
  check_memory(options, soup, meshing.features, sizes);
  meshing.field.method = field_method(options);
  meshing.order = options.order == "fifo"      ? framehex::PointOrder::fifo
                  : options.order == "lattice" ? framehex::PointOrder::lattice
                                               : framehex::PointOrder::smoothness;
  meshing.recombination = recombine_options(options, {});
  if (!options.improve) meshing.least_quality = 0;  // poor cells are no reason for smaller sizes then
  meshing.observer = observer;
  framehex::MeshingResult result = framehex::mesh_surface(surface, sizes, framehex::TetgenProcess{}, meshing,
                                                          framehex::ThreadExecutor(options.threads));
  if (result.status == framehex::Status::cancelled) return false;

  framehex::MixedMesh& mesh = result.recombination.mesh;
  for (framehex::index_t l = 0; l < soup.patch_names.size(); ++l)
    mesh.groups.push_back({2, l, soup.patch_names[l], {l}});
  const framehex::StageSeconds& seconds = result.recombination.seconds;
  const Measures measures = measure(mesh);
  nlohmann::ordered_json json;
  add_to(json, measures);
  add_groups(json, mesh);
  add_to(json, result.recombination, options);
  const framehex::MeshingStatistics& s = result.statistics;
  json["field"] = {{"smoothness_mean", s.smoothness_mean},
                   {"fraction_smooth", s.fraction_smooth},
                   {"dirichlet_energy", s.dirichlet_energy},
                   {"singular_edges", s.n_singular_edges}};
  const bool lattice_is_left = meshing.order == framehex::PointOrder::lattice && s.order != meshing.order;
  if (options.order == "lattice")
    json["lattice"] = {{"volume", s.lattice_volume},
                       {"seamless", s.mapping == framehex::LatticeMapping::seamless},
                       {"replaced_by_fronts", lattice_is_left}};
  json["regions"] = s.n_regions;
  json["points"] = {{"surface", s.n_surface_points},
                    {"volume", s.n_volume_points},
                    {"unremoved", s.n_unremoved_vertices},
                    {"background_tetrahedra", s.n_background_tets},
                    {"tetrahedra", s.n_tets}};
  json.update(json_of_sizes);
  tell_exceptions(options, result, sizes.options().most, json);
  if (!result.poor_cells.empty() && !options.least_feature) suggest_merging(options, soup, sizes.options().most);
  finish(json, options);
  json["options"]["size"] = sizes.options().most;
  json["options"]["least_feature"] = least_feature;
  json["merged_vertices"] = n_merged;
  const framehex::MeshData data{.cells = cell_arrays(measures),
                                .points = {framehex::frame_array(result.frames), {"smoothness", result.smoothness}},
                                .lines = result.singular_lines};
  std::optional<framehex::MidsideNodes> midside;
  if (options.quadratic) midside = quadratic_nodes(mesh, soup, meshing.features, json);
  write_results(options, mesh, data, json, midside ? &*midside : nullptr);
  end_progress();
  if (lattice_is_left) remark(options, "fronts fit this body better than a lattice: they have placed the points");
  if (!options.quiet) {
    print_row(std::filesystem::path(options.input).stem().string() + " " + options.field + " " + options.order,
              measures, seconds);
    print_faults(measures);
  }
  return true;
}

}  // namespace program
