// SPDX-License-Identifier: BSL-1.0
// Small dense algebra against Eigen's general solvers.
#include "framehex/geometry/rotation.hpp"
#include "framehex/geometry/symmetric_matrix.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include <random>

using namespace framehex;

namespace {

Eigen::Matrix3d random_symmetric(std::mt19937_64& engine, double scale) {
  std::uniform_real_distribution<double> entry(-scale, scale);
  Eigen::Matrix3d a;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) a(i, j) = a(j, i) = entry(engine);
  return a;
}

}  // namespace

TEST_CASE("the least eigenvalue of a symmetric matrix is Eigen's, and decides whether Cholesky's factors exist") {
  std::mt19937_64 engine(1);
  for (const double scale : {1e-8, 1.0, 1e8})
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Matrix3d a = random_symmetric(engine, scale);
      const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(a).eigenvalues()[0];
      CHECK(std::abs(least_eigenvalue(a) - least) < 1e-7 * scale);
      const Vector3 b = random_symmetric(engine, scale).col(0);
      const std::optional<Vector3> x = solve_positive(a, b);
      if (std::abs(least) > 1e-6 * scale) CHECK(x.has_value() == (least > 0));
      const Eigen::Matrix3d shifted = a + (0.3 * scale - least) * Eigen::Matrix3d::Identity();
      const std::optional<Vector3> y = solve_positive(shifted, b);
      REQUIRE(y.has_value());
      CHECK((shifted * *y - b).norm() < 1e-12 * scale * (1 + y->norm()));
    }
}

TEST_CASE("the least eigenvalue of a multiple of the identity is that multiple") {
  for (const double value : {-2.0, 0.0, 3.0})
    CHECK(least_eigenvalue(value * Eigen::Matrix3d::Identity()) == Approx(value).margin(1e-15));
}

TEST_CASE("the solution for a symmetric matrix of any kind is Eigen's, to the last bit") {
  std::mt19937_64 engine(3);
  for (int i = 0; i < 3000; ++i) {
    Eigen::Matrix3d a = random_symmetric(engine, std::pow(10.0, i % 17 - 8));
    const Vector3 b = random_symmetric(engine, 1).col(0), n = random_symmetric(engine, 1).col(1);
    if (i % 3 == 1) a = n * n.transpose();                                   // of rank one, but for rounding
    if (i % 3 == 2) a.row(i / 3 % 3).setZero(), a.col(i / 3 % 3).setZero();  // of rank two
    if (i % 11 == 0) a = Vector3(i % 2, i % 3, i % 5).asDiagonal();
    const Vector3 x = solve_symmetric(a, b), expected = a.ldlt().solve(b);
    CHECK(x == expected);
  }
}

TEST_CASE("the rotation between two directions takes one onto the other by the angle between them, opposite ones too") {
  std::mt19937_64 engine(2);
  std::normal_distribution<double> entry;
  for (int i = 0; i < 1000; ++i) {
    const Vector3 from = Vector3(entry(engine), entry(engine), entry(engine)).normalized();
    const double nearness = std::pow(10.0, -(i % 20));
    const Vector3 other = Vector3(entry(engine), entry(engine), entry(engine)).normalized();
    for (const Vector3& to : {other, Vector3((from + nearness * other).normalized()),
                              Vector3((-from + nearness * other).normalized()), Vector3(-from)}) {
      const Quaternion q = rotation_between(from, to);
      CHECK(std::abs(q.norm() - 1) < 1e-14);
      CHECK((q * from - to).norm() < 2e-6);
      const double angle = 2 * std::atan2(q.vec().norm(), std::abs(q.w()));
      CHECK(angle == Approx(std::atan2(from.cross(to).norm(), from.dot(to))).margin(2e-6));
    }
  }
}
