// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/tbb.hpp"
#include "framehex/field/compute_frame_field.hpp"
#include "support/host_reference.hpp"
#include "support/kuhn_lattice.hpp"

using namespace framehex;

TEST_CASE("TBB runs each block once, with a worker of its own, also within blocks") {
  for (const int n_threads : {1, 2, 4}) {
    const TbbExecutor executor(n_threads);
    REQUIRE(executor.workers() == static_cast<std::size_t>(n_threads));
    std::vector<std::atomic<int>> runs(500), inside(executor.workers());
    std::atomic<bool> shared{false};
    std::atomic<int> n_inner{0};
    executor(runs.size(), [&](std::size_t block, std::size_t worker) {
      if (worker >= inside.size() || inside[worker]++ != 0) shared = true;
      executor(8, [&](std::size_t, std::size_t) { ++n_inner; });
      ++runs[block];
      --inside[worker];
    });
    CHECK_FALSE(shared);
    CHECK(n_inner == 8 * 500);
    for (const auto& n : runs) CHECK(n == 1);
  }
}

TEST_CASE("what a block throws arrives through TBB") {
  const TbbExecutor executor(3);
  const auto run = [&] {
    executor(100, [](std::size_t block, std::size_t) {
      if (block == 50) throw invalid_option("block 50");
    });
  };
  CHECK_THROWS_AS(run(), invalid_option);
}

TEST_CASE("results are the same on TBB's threads") {
  const IndexedTetMesh mesh = test::kuhn_lattice(5);
  for (const int n_threads : {1, 2, 3}) {
    const TbbExecutor executor(n_threads);
    const auto serial = compute_frame_field(mesh), parallel = compute_frame_field(mesh, {}, executor);
    CHECK(parallel.smoothness() == serial.smoothness());
    CHECK(find_potential_hexahedra(mesh, {}, executor).vertices == find_potential_hexahedra(mesh).vertices);
    const Recombination a = recombine(mesh), b = recombine(mesh, {}, executor);
    CHECK(a.mesh.points == b.mesh.points);
    CHECK(a.mesh.cells.values == b.mesh.cells.values);
  }
}
