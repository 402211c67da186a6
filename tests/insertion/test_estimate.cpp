// SPDX-License-Identifier: BSL-1.0
#include "framehex/insertion/estimate.hpp"
#include "framehex/tetrahedralization/background.hpp"
#include "support/insertion_fixtures.hpp"

#include <catch2/catch.hpp>

using namespace framehex;
using namespace framehex::test;

TEST_CASE("estimates are the integrals of the wished density") {
  const IndexedTriangleMesh surface = box_surface({2, 3, 4}, 4, 4, 4);
  const auto half = [](const Vector3&) { return 0.5; };
  CHECK(estimate_surface_points(surface, half).n_points == Approx(52 / 0.25));
  const BoxDomain domain{Quaternion::Identity(), Vector3(2, 3, 4)};
  CHECK(estimate_volume_points(Vector3::Zero(), {2, 3, 4}, domain, half).n_points == Approx(24 / 0.125));
  // h = 1 + z: on [0, 4] the integral of (1 + z)^-3 is 0.48.
  const auto graded = [](const Vector3& p) { return 1 + p.z(); };
  const PointEstimate estimate = estimate_volume_points(Vector3::Zero(), {2, 3, 4}, domain, graded);
  CHECK(estimate.n_points == Approx(6 * 0.48).epsilon(0.02));
  CHECK(estimate.largest_size == Approx(4.875));
  CHECK_THROWS_AS(estimate_surface_points(surface, [](const Vector3&) { return -1.0; }), invalid_field);
}

TEST_CASE("a background edge that asks for too much is refused with the number, and the limit can be raised") {
  const IndexedTriangleMesh surface = box_surface({1, 1, 1});
  CHECK_NOTHROW(check_background_edge(surface, 0.01, 2.1e6));
  CHECK_THROWS_WITH(check_background_edge(surface, 0.01, 2e6), Catch::Contains("2.0"));
  CHECK_THROWS_AS(check_background_edge(surface, 1e-9, 2e7), invalid_option);
  CHECK_THROWS_AS(check_background_edge(surface, 0, 2e7), invalid_option);
  // A sheet has next to no volume, but an area.
  CHECK_THROWS_AS(check_background_edge(box_surface({100, 100, 1e-3}), 0.01, 2e7), invalid_option);
}
