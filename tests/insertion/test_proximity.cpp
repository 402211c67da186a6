// SPDX-License-Identifier: BSL-1.0
#include "framehex/geometry/proximity.hpp"
#include "framehex/insertion/rtree_filter.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <random>
#include <vector>

using namespace framehex;

namespace {

template <class Filter>
std::vector<index_t> found(const Filter& filter, const Vector3& low, const Vector3& high) {
  std::vector<index_t> ids;
  filter.for_each_in_box(low, high, [&](index_t i, const Vector3&) { ids.push_back(i); });
  std::sort(ids.begin(), ids.end());
  return ids;
}

struct Uniform {
  std::mt19937_64 engine{11};
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
  }
  Vector3 point(double r) { return {(*this)(-r, r), (*this)(-r, r), (*this)(-r, r)}; }
};

template <class Filter>
void check_against_brute_force(Filter filter, Uniform& uniform, bool graded) {
  std::vector<Vector3> points;
  for (int i = 0; i < 3000; ++i) {
    Vector3 p = uniform.point(10);
    if (graded && i % 2 == 0) p = uniform.point(0.05);
    const double size = graded ? std::max(0.003, 0.1 * p.norm()) : 1.0;
    filter.insert(p, size);
    points.push_back(p);
    if (i % 10 != 0) continue;
    const Vector3 centre = points[static_cast<std::size_t>(i) / 2] + uniform.point(0.3);
    const Vector3 half = graded && i % 20 == 0 ? Vector3(0.02, 0.01, 0.04) : Vector3(1.2, 0.9, 2.0);
    std::vector<index_t> expected;
    for (index_t k = 0; k < points.size(); ++k)
      if (((points[k] - centre).cwiseAbs().array() <= half.array()).all()) expected.push_back(k);
    REQUIRE(found(filter, centre - half, centre + half) == expected);
  }
}

}  // namespace

TEMPLATE_TEST_CASE("a proximity filter finds what brute force finds", "", HashGrid, RTreeFilter) {
  Uniform uniform;
  SECTION("uniform sizes") {
    check_against_brute_force(TestType(1.0), uniform, false);
  }
  SECTION("sizes over three decades") {
    check_against_brute_force(TestType(2.0), uniform, true);
  }
  SECTION("cells much smaller than the boxes asked for") {
    check_against_brute_force(TestType(1e-3), uniform, false);
  }
  SECTION("cells much larger than the domain") {
    check_against_brute_force(TestType(1e4), uniform, true);
  }
}

TEMPLATE_TEST_CASE("moved points are found where they are, once", "", HashGrid, RTreeFilter) {
  Uniform uniform;
  TestType filter(1.0);
  std::vector<Vector3> points;
  for (int i = 0; i < 1000; ++i) {
    points.push_back(uniform.point(3));
    filter.insert(points.back(), i % 3 == 0 ? 0.1 : 1.0);
  }
  for (int round = 0; round < 5; ++round) {
    for (index_t i = 0; i < points.size(); ++i) {
      points[i] += uniform.point(i % 2 == 0 ? 0.05 : 2);  // within a cell, and far
      filter.move(i, points[i], i % 5 == 0 ? 0.3 : 0.9);
    }
    for (int query = 0; query < 20; ++query) {
      const Vector3 centre = uniform.point(3), half(1, 0.3, 2);
      std::vector<index_t> expected;
      for (index_t k = 0; k < points.size(); ++k)
        if (((points[k] - centre).cwiseAbs().array() <= half.array()).all()) expected.push_back(k);
      REQUIRE(found(filter, centre - half, centre + half) == expected);
    }
  }
}

TEMPLATE_TEST_CASE("every point that reaches a place by its own size is found, moved ones too", "[regression]",
                   HashGrid, RTreeFilter) {
  Uniform uniform;
  TestType filter(1.0);
  std::vector<Vector3> points;
  std::vector<double> sizes;
  const auto size = [&uniform] { return std::pow(10, 1.3 * uniform.point(1).x() - 1); };  // 0.005 to 2
  for (index_t i = 0; i < 1500; ++i) {
    points.push_back(uniform.point(3));
    sizes.push_back(size());
    filter.insert(points[i], sizes[i]);
  }
  std::size_t n_found = 0, n_farther_than_near = 0;
  for (int round = 0; round < 3; ++round) {
    for (int query = 0; query < 200; ++query) {
      const Vector3 place = uniform.point(3);
      std::vector<index_t> visited;
      filter.for_each_reaching(place, 0.7, [&](index_t i, const Vector3&) { visited.push_back(i); });
      std::sort(visited.begin(), visited.end());
      CHECK(std::adjacent_find(visited.begin(), visited.end()) == visited.end());
      for (index_t i = 0; i < points.size(); ++i) {
        if ((points[i] - place).cwiseAbs().maxCoeff() > 0.7 * sizes[i]) continue;
        ++n_found;
        n_farther_than_near += (points[i] - place).norm() > 0.2;
        if (!std::binary_search(visited.begin(), visited.end(), i)) FAIL_CHECK("point " << i << " was passed by");
      }
    }
    for (index_t i = 0; i < points.size(); i += 2) {
      points[i] += uniform.point(0.5);
      sizes[i] = size();
      filter.move(i, points[i], sizes[i]);
    }
  }
  CHECK(n_farther_than_near > 100);
  CHECK(n_found > n_farther_than_near);
}

TEMPLATE_TEST_CASE("a closed box contains its faces", "", HashGrid, RTreeFilter) {
  TestType filter(1.0);
  filter.insert({1, 1, 1}, 1.0);
  filter.insert({2, 1, 1}, 0.2);
  filter.insert({2, 1, 1}, 0.2);
  CHECK(found(filter, Vector3(1, 1, 1), Vector3(2, 1, 1)) == std::vector<index_t>{0, 1, 2});
  CHECK(found(filter, Vector3(1.5, 0, 0), Vector3(1.9, 2, 2)).empty());
}

TEST_CASE("the infinity norm in a frame, and the box round its ball") {
  const Quaternion frame = Quaternion(0.4, 0.1, -0.7, 0.3).normalized();
  const Eigen::Matrix3d axes = frame.toRotationMatrix();
  CHECK(frame_infinity_norm(axes, frame * Vector3(0.2, -0.7, 0.5)) == Approx(0.7));
  const Vector3 half = box_half_edges(axes, 2.0);
  Vector3 reached = Vector3::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 local(corner & 1 ? 2 : -2, corner & 2 ? 2 : -2, corner & 4 ? 2 : -2);
    reached = reached.cwiseMax((frame * local).cwiseAbs());
  }
  CHECK((half - reached).norm() < 1e-12);
}
