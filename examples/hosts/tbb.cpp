// SPDX-License-Identifier: BSL-1.0
// The stages on the threads of oneTBB; the result is the same as without.
#include <framehex/adapters/tbb.hpp>
#include <framehex/pipeline/recombine.hpp>

#include <cstdio>

int main() {
  const framehex::IndexedTetMesh mesh{
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
      {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}}};
  const framehex::TbbExecutor executor(2);
  const auto result = framehex::recombine(mesh, {}, executor);
  std::printf("%zu threads, %zu cells\n", executor.workers(), result.mesh.n_cells());
}
