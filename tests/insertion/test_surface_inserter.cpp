// SPDX-License-Identifier: BSL-1.0
#include "framehex/insertion/rtree_filter.hpp"
#include "support/insertion_fixtures.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

using namespace framehex;
using namespace framehex::test;

namespace {

struct Case {
  Surface surface;
  std::vector<Quaternion> frames;

  Case(const IndexedTriangleMesh& mesh, const Quaternion& frame)
      : surface(mesh), frames(triangle_frames(mesh, frame)) {}

  template <class Order, class Size, class Proximity = HashGrid>
  SurfaceInsertion insert(const Size& size, const SurfaceOptions& options = {}) const {
    return insert_surface_points<Order, Proximity>(surface, frames, {}, insert_curve_points(surface, size), size,
                                                   options);
  }
};

const auto constant = [](double h) { return [h](const Vector3&) { return h; }; };
const Quaternion tilted = Quaternion(0.3, 0.5, -0.2, 0.7).normalized();

double distance_to_triangle_plane(const Case& c, const SurfaceSample& sample) {
  const auto& t = c.surface.triangles()[sample.entity];
  return (sample.point -
          nearest_on_triangle(sample.point, c.surface.points[t[0]], c.surface.points[t[1]], c.surface.points[t[2]])
              .point)
      .norm();
}

}  // namespace

TEMPLATE_TEST_CASE("on a box whose sides are multiples of the size the samples are the lattice", "", FifoOrder,
                   SmoothnessOrder) {
  const std::array<int, 3> n{6, 5, 3};
  const double h = 0.25;
  for (const Quaternion& q : {Quaternion::Identity(), tilted})
    for (const int cut : {1, 4, 7}) {
      const Case c(turned(box_surface(h * Vector3(n[0], n[1], n[2]), cut, cut + 1, cut + 2), q), q);
      const auto result = c.template insert<TestType>(constant(h));
      const std::size_t wanted = 7 * 6 * 4 - 5 * 4 * 2, quads = 2 * (6 * 5 + 5 * 3 + 3 * 6);
      REQUIRE(result.samples.size() == wanted);
      CHECK(lattice_cells(result.links).size() == quads);
      std::set<std::array<long, 3>> places;
      for (const SurfaceSample& sample : result.samples) {
        const Vector3 u = q.conjugate() * sample.point / h;
        CHECK((u - u.array().round().matrix()).norm() < 1e-9);
        places.insert({std::lround(u.x()), std::lround(u.y()), std::lround(u.z())});
      }
      CHECK(places.size() == wanted);
      CHECK(result.status == Status::complete);
    }
}

TEMPLATE_TEST_CASE("samples of curved surfaces keep their distance and lie on the surface", "", FifoOrder,
                   SmoothnessOrder) {
  // A sphere has no features: the patch is seeded. A cylinder has closed curves only.
  for (const Case& c : {Case(sphere_surface(1, 4), tilted), Case(cylinder_surface(1, 2, 64), Quaternion::Identity())}) {
    const double h = 0.12;
    const auto result = c.template insert<TestType>(constant(h));
    const double k = TestType::default_rejection;
    double area = 0;
    for (const auto& t : c.surface.triangles())
      area += 0.5 * (c.surface.points[t[1]] - c.surface.points[t[0]])
                        .cross(c.surface.points[t[2]] - c.surface.points[t[0]])
                        .norm();
    CHECK(static_cast<double>(result.samples.size()) == Approx(area / (h * h)).epsilon(0.15));
    for (std::size_t i = result.n_curve_samples; i < result.samples.size(); ++i) {
      CHECK(distance_to_triangle_plane(c, result.samples[i]) < 1e-12);
      const Eigen::Matrix3d axes = result.frames[i].toRotationMatrix();
      for (std::size_t j = result.n_curve_samples; j < i; ++j) {
        const bool same_patch = c.surface.features.triangle_patch[result.samples[i].entity] ==
                                c.surface.features.triangle_patch[result.samples[j].entity];
        const bool same_side = axes.col(2).dot(result.frames[j] * Vector3::UnitZ()) > 0;
        const double distance =
            (axes.transpose() * (result.samples[j].point - result.samples[i].point)).cwiseAbs().maxCoeff();
        if (same_patch && same_side && distance < k * h)
          FAIL("samples " << i << " and " << j << " at " << distance / h);
      }
      for (std::size_t j = 0; j < result.n_curve_samples; ++j)
        CHECK((result.samples[j].point - result.samples[i].point).norm() > 0.49 * h);
    }
    // No hole is left: every vertex of the fine surface has a sample within a size and a half.
    for (const Vector3& p : c.surface.points) {
      double nearest = 1e9;
      for (const SurfaceSample& sample : result.samples) nearest = std::min(nearest, (sample.point - p).norm());
      CHECK(nearest < 1.2 * h);
    }
  }
}

TEST_CASE("both proximity filters give the same samples, and so does every run") {
  const Case c(sphere_surface(1, 3), tilted);
  const auto a = c.insert<SmoothnessOrder>(constant(0.2));
  const auto b = c.insert<SmoothnessOrder, decltype(constant(0.2)), RTreeFilter>(constant(0.2));
  const auto again = c.insert<SmoothnessOrder>(constant(0.2));
  REQUIRE(a.samples.size() == b.samples.size());
  REQUIRE(a.samples.size() == again.samples.size());
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    CHECK(a.samples[i].point == b.samples[i].point);
    CHECK(a.samples[i].point == again.samples[i].point);
  }
}

TEST_CASE("a wall thinner than the size gets samples on both sides") {
  const Case c(box_surface({3, 3, 0.1}, 2, 2, 1), Quaternion::Identity());
  const auto result = c.insert<FifoOrder>(constant(0.5));
  std::size_t low = 0, high = 0;
  for (const SurfaceSample& sample : result.samples)
    if (sample.kind == SampleKind::surface) ++(sample.point.z() > 0.05 ? high : low);
  CHECK(low == 25);
  CHECK(high == 25);
}

TEST_CASE("sizes follow a graded field along a surface") {
  const Case c(box_surface({4, 4, 4}, 5, 5, 5), Quaternion::Identity());
  const auto size = [](const Vector3& p) { return 0.08 + 0.06 * p.x(); };
  const auto result = c.insert<SmoothnessOrder>(size);
  std::vector<double> ratios;
  for (std::size_t i = result.n_curve_samples; i < result.samples.size(); ++i) {
    const Vector3& p = result.samples[i].point;
    CHECK(result.sizes[i] == size(p));
    for (const index_t j : result.links[i])
      if (j != no_index)
        ratios.push_back((result.samples[j].point - p).norm() / size(0.5 * (p + result.samples[j].point)));
  }
  REQUIRE(ratios.size() > 1000);
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<long>(ratios.size() / 2), ratios.end());
  CHECK(ratios[ratios.size() / 2] == Approx(1).epsilon(0.05));
}

TEST_CASE("bad sizes and options of the surface stage are refused; an observer can stop it") {
  const Case c(box_surface({1, 1, 1}), Quaternion::Identity());
  const auto curves = insert_curve_points(c.surface, constant(0.2));
  const auto run = [&](double h, const SurfaceOptions& options = {}) {
    const auto size = constant(h);
    return insert_surface_points(c.surface, c.frames, {}, curves, size, options);
  };
  for (const double h : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) CHECK_THROWS_AS(run(h), invalid_field);
  CHECK_THROWS_WITH(run(1e-4), Catch::Contains("about 6e+08 points"));
  CHECK_THROWS_AS(run(0.2, {.rejection = 1.5}), invalid_option);
  CHECK_THROWS_AS(run(0.2, {.link_distance = 0.9}), invalid_option);
  CHECK(run(0.2, {.rejection = 0.3}).status == Status::complete);  // the default link distance follows
  int calls = 0;
  const auto result = run(0.01, {.observer = [&](const Progress& progress) {
                            CHECK(progress.fraction <= 1);
                            return ++calls < 3;
                          }});
  CHECK(calls == 3);
  CHECK(result.status == Status::cancelled);
  CHECK(run(5.0).samples.size() == curves.samples.size());
}

TEST_CASE("arguments of another surface are refused") {
  const Case c(box_surface({1, 1, 1}), Quaternion::Identity());
  const Case other(box_surface({1, 1, 1}, 2, 2, 2), Quaternion::Identity());
  const auto size = constant(0.2);
  const auto curves = insert_curve_points(c.surface, size);
  const auto run = [&](const FeatureGraph& features, std::span<const Quaternion> frames,
                       std::span<const double> smoothness, const CurveInsertion& samples) {
    const Surface surface(c.surface.points, c.surface.adjacency, features);
    return insert_surface_points(surface, frames, smoothness, samples, size);
  };
  CHECK_NOTHROW(run(c.surface.features, c.frames, {}, curves));
  CHECK_THROWS_WITH(run(c.surface.features, std::span(c.frames).first(5), {}, curves),
                    "there are 5 frames for 12 triangles");
  CHECK_THROWS_AS(run(c.surface.features, {}, {}, curves), invalid_option);
  const std::vector<double> smoothness(c.surface.points.size() - 1, 1.0);
  CHECK_THROWS_AS(run(c.surface.features, c.frames, smoothness, curves), invalid_option);
  CHECK_THROWS_AS(run(other.surface.features, c.frames, {}, curves), invalid_option);
  CHECK_THROWS_AS(run(c.surface.features, c.frames, {}, CurveInsertion{}), invalid_option);
  CurveInsertion strange = curves;
  strange.samples.back().entity = 12;
  CHECK_THROWS_AS(run(c.surface.features, c.frames, {}, strange), invalid_option);
}

TEST_CASE("progress of the surface stage never falls") {
  const Case c(box_surface({1, 1, 1}), Quaternion::Identity());
  double before = 0;
  c.insert<SmoothnessOrder>(constant(0.03), {.observer = [&](const Progress& progress) {
                              CHECK(progress.fraction >= before);
                              before = progress.fraction;
                              return true;
                            }});
  CHECK(before > 0.7);
}
