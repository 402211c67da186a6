// SPDX-License-Identifier: BSL-1.0
#include "support/insertion_fixtures.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>

using namespace framehex;
using namespace framehex::test;

namespace {

const auto constant = [](double h) { return [h](const Vector3&) { return h; }; };

/// A curve along given points, closed when asked for, that is the only feature; no triangles.
struct LoneCurve {
  Surface surface;
  LoneCurve(std::vector<Vector3> points, bool closed) {
    surface.points = std::move(points);
    FeatureGraph& features = surface.features;
    for (index_t v = 0; v < surface.points.size(); ++v) features.curves.values.push_back(v);
    if (closed)
      features.curves.values.push_back(0);
    else
      features.corners = {0, static_cast<index_t>(surface.points.size() - 1)};
    features.curves.end_row();
  }
};

std::vector<Vector3> circle(double radius, int n) {
  std::vector<Vector3> points;
  for (int i = 0; i < n; ++i)
    points.emplace_back(radius * std::cos(2 * std::numbers::pi * i / n),
                        radius * std::sin(2 * std::numbers::pi * i / n), 0);
  return points;
}

}  // namespace

TEST_CASE("box edges are sampled with the nearest whole number of equal intervals") {
  const Quaternion q = Quaternion(0.2, 0.9, 0.1, -0.4).normalized();
  const Surface surface = turned(box_surface({5, 4, 3}, 3, 7, 2), q);
  const FeatureGraph& features = surface.features;
  const auto result = insert_curve_points(surface, constant(0.9));
  CHECK(features.corners.size() == 8);
  REQUIRE(result.n_intervals.size() == 12);
  std::array<int, 10> histogram{};
  for (const index_t n : result.n_intervals) ++histogram[n];
  CHECK(histogram[6] == 4);  // 5 / 0.9 = 5.6
  CHECK(histogram[4] == 4);  // 4 / 0.9 = 4.4
  CHECK(histogram[3] == 4);
  CHECK(result.samples.size() == 8 + 4 * (5 + 3 + 2));
  for (std::size_t c = 0; c < 12; ++c) {
    const auto row = features.curves[c];
    const Vector3 a = surface.points[row.front()], b = surface.points[row.back()];
    for (index_t k = 1; k < result.n_intervals[c]; ++k) {
      const SurfaceSample& sample = result.samples[result.first_of_curve[c] + k - 1];
      const double s = static_cast<double>(k) / result.n_intervals[c];
      CHECK((sample.point - (a + s * (b - a))).norm() < 1e-12);
      CHECK(sample.arc == Approx(s * (b - a).norm()));
      CHECK(sample.kind == SampleKind::curve);
      CHECK(sample.entity == c);
    }
  }
}

TEST_CASE("intervals are equally long in units of a graded size") {
  // h = 0.05 + 0.1 x on [0, 2]: the length in sizes is 10 ln((0.05 + 0.1 x) / 0.05), so x_k is known in closed form.
  const LoneCurve curve({{0, 0, 0}, {0.7, 0, 0}, {2, 0, 0}}, false);
  const auto size = [](const Vector3& p) { return 0.05 + 0.1 * p.x(); };
  const auto result = insert_curve_points(curve.surface, size);
  const double length = 10 * std::log(5.0);
  const auto n = static_cast<index_t>(std::round(length));
  REQUIRE(result.n_intervals.at(0) == n);
  for (index_t k = 1; k < n; ++k) {
    const double x = 0.5 * (std::exp(length * k / n / 10) - 1);
    CHECK(result.samples.at(1 + k).point.x() == Approx(x).margin(2e-3 * (0.05 + 0.1 * x)));
  }
}

TEST_CASE("closed curves get an even number of intervals, at least four") {
  const LoneCurve curve(circle(1, 240), true);
  for (const auto& [h, n] : {std::pair{0.5, 12}, {0.43, 14}, {0.1, 62}, {3.0, 4}, {100.0, 4}}) {
    const auto result = insert_curve_points(curve.surface, constant(h));
    CHECK(result.n_intervals.at(0) == static_cast<index_t>(n));
    CHECK(result.samples.size() == static_cast<std::size_t>(n));
    CHECK(result.samples.at(0).arc == 0);
  }
  CHECK(insert_curve_points(curve.surface, constant(0.43), {.closed_multiple = 8}).n_intervals[0] == 16);
}

TEST_CASE("curves that share both ends or turn much get enough intervals to be told apart") {
  LoneCurve lens({{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {1, -1, 0}}, false);
  lens.surface.features.corners = {0, 2};
  lens.surface.features.curves = {};
  for (const std::vector<index_t>& row : {std::vector<index_t>{0, 1, 2}, {0, 3, 2}, {0, 1, 2, 0}}) {
    lens.surface.features.curves.values.insert(lens.surface.features.curves.values.end(), row.begin(), row.end());
    lens.surface.features.curves.end_row();
  }
  const auto result = insert_curve_points(lens.surface, constant(50));
  CHECK(result.n_intervals == std::vector<index_t>{2, 2, 3});

  auto arc = circle(1, 300);
  arc.resize(226);  // three quarters
  const LoneCurve three_quarters(arc, false);
  CHECK(insert_curve_points(three_quarters.surface, constant(9)).n_intervals[0] == 3);
}

TEST_CASE("sizes that cannot be used are refused by name") {
  const LoneCurve curve({{0, 0, 0}, {1, 0, 0}}, false);
  for (const double h :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e-300})
    CHECK_THROWS_AS(insert_curve_points(curve.surface, constant(h)), invalid_field);
  CHECK_THROWS_AS(insert_curve_points(curve.surface, constant(1e-8)), invalid_option);
  CHECK_THROWS_WITH(insert_curve_points(curve.surface, constant(1e-3), {.max_points = 100}),
                    Catch::Contains("about 10") && Catch::Contains("max_points"));
  CHECK(insert_curve_points(curve.surface, constant(1e-3), {.max_points = 1002}).samples.size() == 1001);
  CHECK_THROWS_AS(insert_curve_points(curve.surface, constant(1), {.closed_multiple = 0}), invalid_option);
}

TEST_CASE("more samples than allowed are refused whatever asks for them, before they are made") {
  const LoneCurve ring(circle(1, 100), true);
  const auto run = [&](double h, const CurveOptions& options) {
    return insert_curve_points(ring.surface, constant(h), options).samples.size();
  };
  CHECK_THROWS_AS(run(1, {.closed_multiple = 4'000'000'000u}), invalid_option);
  CHECK_THROWS_AS(run(1, {.closed_multiple = 1000, .max_points = 100}), invalid_option);
  CHECK_THROWS_AS(run(1, {.max_turn = 1e-3, .max_points = 100}), invalid_option);
  CHECK_THROWS_WITH(run(1e-9, {}), Catch::Contains("about 6.28215e+09"));  // 200 sin(pi / 100) / 1e-9
}

TEST_CASE("the turn of a closed curve is a full one") {
  const LoneCurve ring(circle(1, 16), true);
  const auto result = insert_curve_points(ring.surface, constant(9), {.closed_multiple = 1, .max_turn = 0.1});
  CHECK(result.n_intervals[0] == 63);  // 2 pi / 0.1, rounded up
}

TEST_CASE("a size that jumps by 100 keeps the samples ordered and as dense as asked") {
  const LoneCurve curve({{0, 0, 0}, {1, 0, 0}}, false);
  const auto size = [](const Vector3& p) { return p.x() < 0.5 ? 0.1 : 0.001; };
  const auto result = insert_curve_points(curve.surface, size);
  CHECK(result.n_intervals.at(0) == Approx(505).margin(3));
  double before = 0;
  for (std::size_t i = 2; i < result.samples.size(); ++i) {
    CHECK(result.samples[i].point.x() > before);
    before = result.samples[i].point.x();
  }
}
