// SPDX-License-Identifier: BSL-1.0
// How long the stages on surfaces are silent, and what is left when they are cancelled.

#include "framehex/insertion/curve_inserter.hpp"
#include "framehex/surface/refinement.hpp"
#include "framehex/surface/retriangulation.hpp"
#include "support/listener.hpp"
#include "support/surface_samples.hpp"
#include "support/surfaces.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

namespace {

/// Runs `stage(observer)`, which takes longer than an observer may be left alone, listens, and cancels it at some calls.
template <class Stage, class IsEmpty>
void check_stage(const Stage& stage, const IsEmpty& is_empty) {
  test::Listener listener;
  const Observer heard = listener.observer();
  std::size_t n_calls = 0;
  double fraction = 0;
  const auto result = stage([&](const Progress& progress) {
    ++n_calls;
    CHECK(progress.fraction >= fraction);
    fraction = progress.fraction;
    return heard(progress);
  });
  listener.check_silences();
  CHECK(fraction == 1);
  CHECK(result.status == Status::complete);
  CHECK_FALSE(is_empty(result));
  for (const std::size_t last : {std::size_t{1}, n_calls / 3, n_calls / 2, n_calls}) {
    std::size_t n = 0;
    const auto cancelled = stage([&](const Progress&) { return ++n < last; });
    CHECK(n == last);
    CHECK(cancelled.status == Status::cancelled);
    CHECK(is_empty(cancelled));
  }
}

}  // namespace

TEST_CASE("refinement is heard of all the time", "[progress]") {
  const Surface surface(test::torus_surface(1, 0.4, 30, 20));
  const auto flips = GENERATE(RefinementFlips::none, RefinementFlips::in_planes);
  check_stage(
      [&](Observer observer) {
        return refine(surface, [](const Vector3&) { return 0.015; }, {.flips = flips, .observer = std::move(observer)});
      },
      [](const RefinedSurface& fine) { return fine.surface.points.empty() && fine.parent.empty(); });
}

TEST_CASE("retriangulation is heard of all the time", "[progress]") {
  // A box has features to follow, a torus triangles that lie off the samples'.
  const Surface surface(GENERATE(test::torus_surface(1, 0.4, 150, 80), test::box_surface({1, 2, 3}, 40, 80, 120)));
  const std::vector<SurfaceSample> samples = test::scatter_samples(surface, 0.04);
  check_stage([&](Observer observer) { return retriangulate(surface, samples, {.observer = std::move(observer)}); },
              [](const Retriangulation& r) { return r.surface.points.empty() && r.crossings.empty(); });
}

TEST_CASE("curve insertion is heard of all the time", "[progress]") {
  const Surface surface(test::box_surface({1, 2, 3}));
  check_stage(
      [&](Observer observer) {
        return insert_curve_points(surface, [](const Vector3&) { return 1e-4; }, {.observer = std::move(observer)});
      },
      [](const CurveInsertion& curves) { return curves.samples.empty() && curves.n_intervals.empty(); });
}
