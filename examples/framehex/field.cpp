// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/compiled.hpp"

#include "framehex/io/mesh_builder.hpp"
#include "framehex/io/mesh_writer.hpp"

#include "commands.hpp"
#include "library_options.hpp"
#include "report.hpp"

namespace program {

using framehex::index_t;

namespace {

/// The tetrahedra, and the singular lines as labelled edges through points of their own.
framehex::MixedMesh with_lines(const framehex::IndexedTetMesh& tets, const framehex::Csr<framehex::Vector3>& lines) {
  framehex::MixedMesh mesh;
  mesh.points = tets.points;
  for (const auto& tet : tets.tets) mesh.add(framehex::CellKind::tetrahedron, tet);
  for (std::size_t line = 0; line < lines.size(); ++line)
    for (std::size_t i = 0; i < lines[line].size(); ++i) {
      const auto vertex = static_cast<index_t>(mesh.points.size());
      if (i > 0) mesh.edges.push_back({{vertex - 1, vertex}, static_cast<index_t>(line)});
      mesh.points.push_back(lines[line][i]);
    }
  return mesh;
}

framehex::DataArray axis_array(const std::vector<framehex::Quaternion>& frames, int axis) {
  std::vector<double> values;
  for (const auto& frame : frames) {
    const framehex::Vector3 direction = frame * framehex::Vector3::Unit(axis);
    values.insert(values.end(), direction.data(), direction.data() + 3);
  }
  return {std::string("frame_") + "xyz"[axis], std::move(values), 3};
}

}  // namespace

bool field(const Options& options, const framehex::Observer& observer) {
  const framehex::IndexedTetMesh tets = framehex::tetrahedra_of(read_input_mesh(options));
  framehex::Stopwatch watch;
  framehex::MeshFieldOptions field_options;
  field_options.features = feature_options(options);
  field_options.field.method = field_method(options);
  field_options.field.observer = observer;
  framehex::FieldReport course;
  const auto field =
      framehex::compute_frame_field(tets, field_options, framehex::ThreadExecutor(options.threads), &course);
  if (course.status == framehex::Status::cancelled) return false;
  const framehex::SingularGraph singular = field.singular_graph();
  double seconds = 0;
  watch.lap(seconds);

  const bool is_page = framehex::mesh_format(options.output) == framehex::MeshFormat::html;  // has lines of its own
  const framehex::MixedMesh mesh = with_lines(tets, is_page ? framehex::Csr<framehex::Vector3>() : singular.polylines);
  std::vector<framehex::Quaternion> frames = field.frames();
  std::vector<double> smoothness = field.smoothness();
  double mean = 0, n_smooth = 0;
  for (const double s : smoothness) {
    mean += s;
    n_smooth += s >= 0.85 ? 1 : 0;
  }
  const double n = static_cast<double>(tets.points.size());
  index_t hint = framehex::no_index;
  for (std::size_t v = tets.points.size(); v < mesh.points.size(); ++v) {
    const framehex::FrameSample sample = field.sample(mesh.points[v], hint);
    frames.push_back(sample.frame);
    smoothness.push_back(sample.smoothness);
  }

  nlohmann::ordered_json json;
  json["counts"] = {{"vertices", tets.points.size()}, {"tetrahedra", tets.tets.size()}};
  json["field"] = {{"smoothness_mean", mean / n},
                   {"fraction_smooth", n_smooth / n},
                   {"dirichlet_energy", field.dirichlet_energy()},
                   {"singular_edges", singular.facets.size()},
                   {"singular_curves", singular.curves.size()},
                   {"boundary_misalignment", field.boundary_misalignment().largest}};
  json["seconds"] = {{"field", seconds}, {"total", seconds}};
  finish(json, options);
  framehex::MeshData data{.cells = {}, .points = {framehex::frame_array(frames)}, .lines = singular.polylines};
  for (int axis = 0; axis < 3; ++axis) data.points.push_back(axis_array(frames, axis));
  data.points.push_back({"smoothness", std::move(smoothness)});
  write_results(options, mesh, data, json);
  end_progress();
  if (!options.quiet)
    std::printf(
        "%zu vertices, smoothness %.4f on average, smooth (0.85) at %.1f %%, Dirichlet energy %.4g, "
        "%zu singular edges in %zu lines, %.2f s\n",
        tets.points.size(), mean / n, 100 * n_smooth / n, field.dirichlet_energy(), singular.facets.size(),
        singular.curves.size(), seconds);
  return true;
}

}  // namespace program
