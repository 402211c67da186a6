// SPDX-License-Identifier: BSL-1.0
// Makes the table of the six models in docs/selection.md: what `best` gains over the paper's greedy selection.
//   g++ -std=c++20 -O2 -Iinclude -Itests -isystem /usr/include/eigen3 docs/scripts/selection_models.cpp -o models
//   ./models dome.stl 0.156 [more surfaces and sizes ...]
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/mesh/boundary.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "framehex/selection/conflict_search.hpp"
#include "framehex/selection/select.hpp"
#include "support/stl.hpp"

#include <ctime>
#include <iostream>
#include <utility>

using namespace framehex;

namespace {

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Done {};

/// Lets the pipeline run up to its second tetrahedral mesh, and keeps that.
struct KeepSecondMesh {
  TetgenProcess inner;
  IndexedTetMesh* mesh;
  int* n_calls;

  auto operator()(const TetrahedralizationRequest& request) const {
    auto result = inner(request);
    if (++*n_calls == 2) {
      mesh->points.assign(request.points.begin(), request.points.end());
      mesh->points.insert(mesh->points.end(), result.extra_points.begin(), result.extra_points.end());
      mesh->tets.assign(result.tets.begin(), result.tets.end());
      throw Done{};
    }
    return result;
  }
};

double volume(const PotentialHexahedra& hexahedra, const Selection& selection) {
  double sum = 0;
  for (const index_t v : selection.members) sum += hexahedra.volume[v];
  return sum;
}

void run(const std::string& path, double size) {
  IndexedTetMesh mesh;
  int n_calls = 0;
  try {
    mesh_surface(
        test::read_stl(path), [size](const Vector3&) { return size; }, KeepSecondMesh{{}, &mesh, &n_calls});
  } catch (const Done&) {
  }
  double start = cpu_seconds();
  const auto lap = [&] { return cpu_seconds() - std::exchange(start, cpu_seconds()); };
  const PotentialHexahedra hexahedra = find_potential_hexahedra(mesh);
  const double search = lap();
  const ImplicitIncompatibilityGraph graph(hexahedra, volume_times_quality(hexahedra));
  const Selection greedy = select(graph, {.method = SelectMethod::greedy});
  lap();
  const Selection first = select(graph, {.gap = 1, .exact_below = 0});
  const double first_seconds = lap();
  const Selection best = select(graph, {.exact_below = 0});
  const double seconds = lap();
  const double bound = select(graph, {.gap = 0.0005, .max_rounds = 200, .exact_below = 0}).bound;
  const GraphStatistics s = statistics(build_incompatibility_graph(hexahedra));
  std::cout << path << " | " << mesh.tets.size() << " | " << s.n_candidates << " | " << s.mean_degree << " | "
            << greedy.members.size() << " | " << best.members.size() << " | "
            << 100 * (volume(hexahedra, best) / volume(hexahedra, greedy) - 1) << " % | "
            << 100 * (best.weight / greedy.weight - 1) << " % | " << 100 * best.gap() << " % | " << search << " | "
            << seconds << " | " << 100 * (first.weight - greedy.weight) / (bound - greedy.weight) << " % | "
            << first_seconds / search << " | " << 100 * (1 - greedy.weight / bound) << " %" << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  std::cout << "model | tets | candidates | degree | greedy | best | volume | weight | gap | search s | select s | "
               "first selection wins back | its time over the search's | greedy is shown to lose"
            << std::endl;
  for (int i = 1; i + 1 < argc; i += 2) run(argv[i], std::stod(argv[i + 1]));
}
