// SPDX-License-Identifier: BSL-1.0
// How long the stages are silent: an observer can only show progress, and cancel, when it is called.

#include "framehex/field/compute_frame_field.hpp"
#include "framehex/pipeline/recombine.hpp"
#include "support/idle_caller.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/listener.hpp"

#include <random>

using namespace framehex;

namespace {

/// n^3 cubes, the vertices inside moved at random by up to a tenth of a side along each axis.
IndexedTetMesh jittered_cubes(index_t n) {
  IndexedTetMesh mesh = test::kuhn_lattice(n);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> jitter(-0.1, 0.1);
  for (Vector3& p : mesh.points)
    if (p.minCoeff() > 0 && p.maxCoeff() < n) p += Vector3(jitter(random), jitter(random), jitter(random));
  return mesh;
}

}  // namespace

TEST_CASE("recombination is heard of all the time, whoever works", "[progress][regression]") {
  const IndexedTetMesh mesh = jittered_cubes(28);
  test::Listener listener;
  const Observer observer = listener.observer();
  SECTION("this thread") {
    recombine(mesh, {.observer = observer});
  }
  SECTION("another") {
    recombine(mesh, {.observer = observer}, test::IdleCaller{});
  }
  listener.check_silences();
}

TEST_CASE("frame fields are heard of all the time, whoever works", "[progress][regression]") {
  const IndexedTetMesh mesh = jittered_cubes(28);
  const FieldMethod method = GENERATE(FieldMethod::nearest, FieldMethod::smoothed, FieldMethod::best);
  test::Listener listener;
  const Observer observer = listener.observer();
  const MeshFieldOptions options{.field = {.method = method, .observer = observer}};
  SECTION("this thread") {
    compute_frame_field(mesh, options);
  }
  SECTION("another") {
    compute_frame_field(mesh, options, test::IdleCaller{});
  }
  listener.check_silences();
}
