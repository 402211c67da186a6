// SPDX-License-Identifier: BSL-1.0
#include <rapidcheck.h>

#include <catch2/catch.hpp>

#include "framehex/mesh/validation.hpp"
#include "framehex/surface/feature_detection.hpp"
#include "framehex/surface/refinement.hpp"
#include "framehex/surface/retriangulation.hpp"
#include "framehex/surface/self_intersection.hpp"
#include "support/surface_checks.hpp"
#include "support/surface_samples.hpp"
#include "support/surfaces.hpp"

using namespace framehex;

namespace {

/// A box, sphere, torus, cylinder or L of random proportions, turned at random, its inner points shaken a little.
IndexedTriangleMesh any_surface() {
  const int kind = *rc::gen::inRange(0, 5);
  const double a = 0.1 * *rc::gen::inRange(2, 30), b = 0.1 * *rc::gen::inRange(2, 30);
  const int n = *rc::gen::inRange(1, 4);
  IndexedTriangleMesh surface = kind == 0   ? test::box_surface({1, a, b}, n, n + 1, 2 * n)
                                : kind == 1 ? test::sphere_surface(1, n)
                                : kind == 2 ? test::torus_surface(1, 0.3, 8 + 6 * n, 6 + 4 * n)
                                : kind == 3 ? test::cylinder_surface(a, b, 10 + 9 * n)
                                            : test::l_shape_surface();
  const Quaternion turn(Eigen::AngleAxisd(0.1 * *rc::gen::inRange(0, 60), Vector3(1, a, -b).normalized()));
  const double shake = kind == 1 || kind == 2 ? 0.01 * *rc::gen::inRange(0, 3) : 0.0;
  std::mt19937_64 engine(static_cast<std::uint64_t>(n));
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-52 - 1; };
  for (Vector3& p : surface.points) {
    const double x = uniform(), y = uniform(), z = uniform();
    p = turn * (p + shake * Vector3(x, y, z)).eval();
  }
  return surface;
}

template <class Property>
void holds(Property&& property) {
  const auto result = rc::detail::checkTestable(property, rc::detail::TestMetadata{}, [] {
    rc::detail::TestParams params;
    params.seed = 7;
    params.maxSuccess = 60;
    return params;
  }());
  INFO(result);
  CHECK(result.template is<rc::detail::SuccessResult>());
}

}  // namespace

TEST_CASE("any surface, refined or not, is retriangulated through any scattered samples") {
  holds([] {
    Surface surface = any_surface();
    const double h = 0.1 * *rc::gen::inRange(1, 8);
    if (*rc::gen::inRange(0, 2) == 1) {
      RefinedSurface fine = refine(surface, [h](const Vector3&) { return h; });
      RC_ASSERT(std::abs(test::enclosed_volume(fine.surface) - test::enclosed_volume(surface)) < 1e-9);
      surface = std::move(fine.surface);
    }
    const auto samples = test::scatter_samples(surface, h, *rc::gen::inRange<std::uint64_t>(0, 1000));
    const Retriangulation r = retriangulate(surface, samples);
    validate_closed(r.surface);
    RC_ASSERT(test::euler_characteristic(r.surface) == test::euler_characteristic(surface));
    RC_ASSERT(r.surface.points.size() == samples.size() + r.n_unremoved + r.n_added);
    for (std::size_t i = 0; i < samples.size(); ++i) RC_ASSERT(r.surface.points[i] == samples[i].point);
    RC_ASSERT(find_self_intersections(r.surface) == r.crossings);
    RC_ASSERT(r.crossings.empty());
    RC_ASSERT(test::enclosed_volume(r.surface) > 0);

    const Retriangulation same = retriangulate(surface, samples);
    RC_ASSERT(same.surface.triangles() == r.surface.triangles());
  });
}
