// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/compiled.hpp"

#include "framehex/field/vertex_size_field.hpp"
#include "framehex/io/surface_faults.hpp"
#include "framehex/io/surface_reader.hpp"

#include "commands.hpp"
#include "library_options.hpp"
#include "report.hpp"

namespace program {

namespace {

/// More cubes of the size than this in the surface are taken for a mistake: memory ends before.
constexpr double most_cells = 2e7;

double enclosed_volume(const framehex::IndexedTriangleMesh& surface) {
  double sum = 0;
  const framehex::Vector3 origin = surface.points[0];
  for (const auto& t : surface.triangles)
    sum += (surface.points[t[0]] - origin).dot((surface.points[t[1]] - origin).cross(surface.points[t[2]] - origin));
  return sum / 6;
}

/// The wished edge length, checked against the box of the surface.
double edge_length(const Options& options, const framehex::IndexedTriangleMesh& surface) {
  const double volume = enclosed_volume(surface);
  if (!(volume > 0)) throw framehex::invalid_surface("the surface encloses no volume; does it cross itself?");
  const double size =
      options.size ? *options.size : std::cbrt(volume / static_cast<double>(options.cells.value_or(10'000)));
  Eigen::AlignedBox3d box;
  for (const framehex::Vector3& p : surface.points) box.extend(p);
  char text[200];
  if (!(size > 0) || !std::isfinite(size)) {
    std::snprintf(text, sizeof text, "size %g is not a positive number", size);
    throw framehex::invalid_option(text);
  }
  if (size > box.diagonal().norm()) {
    std::snprintf(text, sizeof text, "size %g is more than the diagonal of the surface's box, %g", size,
                  box.diagonal().norm());
    throw framehex::invalid_option(text);
  }
  if (volume / (size * size * size) > most_cells) {
    std::snprintf(text, sizeof text, "size %g asks for %.2g cells, more than %.0g", size, volume / (size * size * size),
                  most_cells);
    throw framehex::invalid_option(text);
  }
  return size;
}

framehex::SoupSurface read_repaired(const Options& options) {
  framehex::SoupRepair repair;
  framehex::SoupSurface soup = framehex::read_surface_repaired(options.input, *options.repair, repair);
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
  framehex::SurfaceSoup soup = framehex::read_surface_soup(options.input);
  framehex::repair_soup(soup);
  try {
    framehex::check_closed(framehex::surface_of_soup(soup));
    return true;
  } catch (const framehex::error&) {
    return false;
  }
}

void check_input(const framehex::SoupSurface& soup, const Options& options) {
  try {
    framehex::check_closed(soup);
  } catch (const framehex::error&) {
    if (!options.repair && repair_mends(options)) remark(options, "--repair would mend this:");
    throw;
  }
  framehex::check_crossings(soup);
}

framehex::SoupSurface read_input(const Options& options) {
  framehex::SoupSurface soup = options.repair ? read_repaired(options) : framehex::read_surface(options.input);
  if (soup.n_turned_triangles > 0)
    remark(options, std::to_string(soup.n_turned_triangles) + " of " + std::to_string(soup.surface.triangles.size()) +
                        " triangles were turned to look outward");
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
  sizes = {{"wished", size}, {"least", size}, {"limited_places", result.size_limits.size()}};
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
  if (!result.poor_cells.empty())
    remark(options, std::to_string(result.poor_cells.size()) + " cells have a scaled Jacobian below 0.05, " +
                        std::to_string(n_forced) + " of them at angles of the surface that leave no room: " +
                        near(result.poor_cells.front().place) + and_more(result.poor_cells.size()));
}

}  // namespace

bool mesh(const Options& options, const framehex::Observer& observer) {
  const framehex::SoupSurface soup = read_input(options);
  const framehex::IndexedTriangleMesh& surface = soup.surface;
  check_input(soup, options);
  const double size = edge_length(options, surface);
  framehex::MeshingOptions meshing;
  meshing.features = feature_options(options);
  meshing.features.patches = soup.patches;
  meshing.field.method = field_method(options);
  meshing.order = options.order == "fifo"      ? framehex::PointOrder::fifo
                  : options.order == "lattice" ? framehex::PointOrder::lattice
                                               : framehex::PointOrder::smoothness;
  meshing.recombination = recombine_options(options, {});
  meshing.observer = observer;
  framehex::MeshingResult result =
      framehex::mesh_surface(surface, framehex::ConstantSize{size}, framehex::TetgenProcess{}, meshing,
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
    json["lattice"] = {{"volume", s.lattice_volume}, {"replaced_by_fronts", lattice_is_left}};
  json["points"] = {{"surface", s.n_surface_points},
                    {"volume", s.n_volume_points},
                    {"unremoved", s.n_unremoved_vertices},
                    {"background_tetrahedra", s.n_background_tets},
                    {"tetrahedra", s.n_tets}};
  tell_exceptions(options, result, size, json);
  finish(json, options);
  json["options"]["size"] = size;
  const framehex::MeshData data{.cells = cell_arrays(measures),
                                .points = {framehex::frame_array(result.frames), {"smoothness", result.smoothness}},
                                .lines = result.singular_lines};
  write_results(options, mesh, data, json);
  end_progress();
  if (lattice_is_left)
    remark(options,
           std::string(s.n_regions > 1 ? "there are interfaces between regions" : "no lattice fits this body") +
               ": fronts have placed the points");
  if (!options.quiet) {
    print_row(std::filesystem::path(options.input).stem().string() + " " + options.field + " " + options.order,
              measures, seconds);
    print_faults(measures);
  }
  return true;
}

}  // namespace program
