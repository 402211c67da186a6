// SPDX-License-Identifier: BSL-1.0
#include "support/growth.hpp"

#include <catch2/catch.hpp>

#include <ctime>

using namespace framehex;

namespace {

double cpu_seconds() {
  std::timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Least processor time of three runs.
template <class Work>
double least_time(int n) {
  const Work work(n);
  double least = 1e9;
  for (int run = 0; run < 3; ++run) {
    const double begin = cpu_seconds();
    CHECK(work.run() > 0);
    least = std::min(least, cpu_seconds() - begin);
  }
  return least;
}

}  // namespace

TEMPLATE_TEST_CASE("time grows with the size of the input and not with its square", "[regression]",
                   test::SlidingOnLongCurves, test::FramesOfNeedle, test::SelectionOfCycles, test::FieldOfManyParts,
                   test::SitesOnLongCurves, test::RepairOfThinStrip, test::PrismsInRow) {
  const double once = least_time<TestType>(TestType::typical), fourfold = least_time<TestType>(4 * TestType::typical);
  INFO(once << " s and " << fourfold << " s for four times as much");
  // Quadratic time would make it sixteen times as long.
  CHECK(fourfold < 8 * once + 0.01);
}

TEST_CASE("time of a search at one vertex does not grow with the mesh", "[regression]") {
  const double once = least_time<test::SearchAtVertices>(test::SearchAtVertices::typical),
               fourfold = least_time<test::SearchAtVertices>(4 * test::SearchAtVertices::typical);
  INFO(once << " s and " << fourfold << " s for four times as much");
  CHECK(fourfold < 2 * once + 0.01);
}

TEST_CASE("the cross field of a closed surface of very many triangles does not wait for its factorisation") {
  const auto time_for = [](int n) {
    const Surface surface(test::torus_surface(2, 0.7, 2 * n, n), {.angle = 3.1, .corner_angle = 3.1});
    const double begin = cpu_seconds();
    CHECK(compute_cross_field(surface).frames.size() == surface.triangles().size());
    return cpu_seconds() - begin;
  };
  const double once = time_for(120), fourfold = time_for(240);  // 57,600 and 230,400 triangles
  INFO(once << " s and " << fourfold << " s for four times as much");
  CHECK(fourfold < 4 * once);
}
