// SPDX-License-Identifier: BSL-1.0
//
// Fields of one tetrahedral mesh in every state, for frame_field_pictures.py.
//
//     frame_field_states BASE OUT
//
// Reads BASE.node and BASE.ele (TetGen's files, numbered from 0). Writes OUT.<state>.smoothness (one number a vertex)
// and OUT.<state>.lines (x y z index, an empty line after each singular line), and prints one line of figures a state.
#include "framehex/field/compute_frame_field.hpp"

#include <ctime>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>

namespace {

using namespace framehex;

std::vector<std::vector<double>> rows(const std::string& path, std::size_t n_columns) {
  std::ifstream file(path);
  std::string line;
  std::size_t n = 0;
  std::getline(file, line);
  std::istringstream(line) >> n;
  std::vector<std::vector<double>> result(n, std::vector<double>(n_columns));
  for (auto& row : result) {
    std::getline(file, line);
    std::istringstream numbers(line);
    double number = 0;
    numbers >> number;
    for (double& x : row) numbers >> x;
  }
  if (!file) throw std::runtime_error("cannot read " + path);
  return result;
}

IndexedTetMesh read(const std::string& base) {
  IndexedTetMesh mesh;
  for (const auto& p : rows(base + ".node", 3)) mesh.points.emplace_back(p[0], p[1], p[2]);
  for (const auto& t : rows(base + ".ele", 4)) {
    std::array<index_t, 4> tet;
    for (std::size_t i = 0; i < 4; ++i) tet[i] = static_cast<index_t>(t[i]);
    if (orientation(mesh.points[tet[0]], mesh.points[tet[1]], mesh.points[tet[2]], mesh.points[tet[3]]) < 0)
      std::swap(tet[2], tet[3]);
    mesh.tets.push_back(tet);
  }
  return mesh;
}

void run(const IndexedTetMesh& mesh, const std::string& out, const std::string& state, const FieldOptions& options) {
  FieldReport report;
  const std::clock_t start = std::clock();
  const auto field = compute_frame_field(mesh, MeshFieldOptions{.field = options}, SerialExecutor{}, &report);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  std::ofstream smoothness(out + "." + state + ".smoothness");
  double mean = 0, smooth = 0;
  for (const double s : field.smoothness()) {
    smoothness << s << '\n';
    mean += s / static_cast<double>(field.n_vertices());
    smooth += (s >= 0.85 ? 1 : 0) / static_cast<double>(field.n_vertices());
  }
  const SingularGraph graph = field.singular_graph();
  std::ofstream lines(out + "." + state + ".lines");
  for (std::size_t line = 0; line < graph.polylines.size(); ++line) {
    for (const Vector3& p : graph.polylines[line]) lines << p.transpose() << ' ' << graph.curve_index[line] << '\n';
    lines << '\n';
  }
  const auto& sweeps = report.smoothing.sweeps;
  std::cout << std::fixed << std::setprecision(4) << state << " vertices " << mesh.points.size() << " tets "
            << mesh.tets.size() << " mean " << mean << " smooth " << smooth << " energy " << field.dirichlet_energy()
            << " facets " << graph.facets.size() << " lines " << graph.curves.size() << " points "
            << graph.boundary_facets.size() << " sweeps " << sweeps.size() << " iterations "
            << report.smoothing.mean_local_iterations() << " skipped " << (sweeps.empty() ? 0 : sweeps.back().skipped)
            << " misaligned " << field.boundary_misalignment().mean << " seconds " << seconds << std::endl;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) throw std::runtime_error("usage: frame_field_states BASE OUT");
  const IndexedTetMesh mesh = read(argv[1]);
  run(mesh, argv[2], "nearest", {.method = FieldMethod::nearest});
  run(mesh, argv[2], "constant",
      {.method = FieldMethod::smoothed, .smoothing = {.diffusivity = Diffusivity::constant}});
  run(mesh, argv[2], "variable", {.method = FieldMethod::smoothed});
  run(mesh, argv[2], "best", {});
} catch (const std::exception& e) {
  std::cerr << e.what() << '\n';
  return 1;
}
