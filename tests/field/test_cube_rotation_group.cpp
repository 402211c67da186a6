// SPDX-License-Identifier: BSL-1.0
#include "framehex/field/cube_rotation_group.hpp"

#include <catch2/catch.hpp>

#include <random>
#include <set>

using framehex::CubeRotationGroup;
using framehex::Quaternion;
using framehex::Vector3;
using Group = CubeRotationGroup<>;

static_assert(Group::size() == 24);
static_assert(Group::compose(0, 5) == 5 && Group::inverse(0) == 0);
static_assert(Group::order(1) == 2 && Group::order(4) == 4 && Group::order(10) == 2 && Group::order(16) == 3);

namespace {

/// The 24 signed permutation matrices of determinant 1: the group by its definition.
std::vector<Eigen::Matrix3d> signed_permutations() {
  std::vector<Eigen::Matrix3d> result;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (unsigned bits = 0; bits < 8; ++bits) {
      Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
      for (int i = 0; i < 3; ++i) m(order[static_cast<std::size_t>(i)], i) = (bits >> i) & 1U ? -1 : 1;
      if (m.determinant() > 0) result.push_back(m);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return result;
}

Quaternion random_rotation(std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  return Quaternion(normal(engine), normal(engine), normal(engine), normal(engine)).normalized();
}

/// Least angle from p to r over all representatives of r.
double brute_force_angle(const Quaternion& p, const Quaternion& r) {
  double least = 10;
  for (int g = 0; g < 24; ++g) {
    const Quaternion q = p.conjugate() * r * Group::element(g);
    least = std::min(least, 2 * std::atan2(q.vec().norm(), std::abs(q.w())));
  }
  return least;
}

}  // namespace

TEST_CASE("the elements are the rotations of the cube") {
  const auto expected = signed_permutations();
  REQUIRE(expected.size() == 24);
  std::set<std::size_t> found;
  for (int g = 0; g < 24; ++g) {
    const Eigen::Matrix3d m = Group::element(g).toRotationMatrix();
    for (std::size_t i = 0; i < 24; ++i)
      if ((m - expected[i]).norm() < 1e-14) found.insert(i);
  }
  CHECK(found.size() == 24);
}

TEST_CASE("composition and inverse are those of the quaternions, and make a group") {
  for (int a = 0; a < 24; ++a) {
    CHECK(Group::compose(a, Group::inverse(a)) == 0);
    CHECK(Group::compose(Group::inverse(a), a) == 0);
    for (int b = 0; b < 24; ++b) {
      const Eigen::Matrix3d product = (Group::element(a) * Group::element(b)).toRotationMatrix();
      REQUIRE((product - Group::element(Group::compose(a, b)).toRotationMatrix()).norm() < 1e-14);
      for (int c = 0; c < 24; ++c)
        REQUIRE(Group::compose(a, Group::compose(b, c)) == Group::compose(Group::compose(a, b), c));
    }
  }
}

TEST_CASE("each element is its own nearest element, and its order is that of its angle") {
  for (int g = 0; g < 24; ++g) {
    const Quaternion q = Group::element(g);
    CHECK(Group::nearest(q) == g);
    CHECK(Group::nearest(Quaternion(-q.coeffs())) == g);
    const double turn = 2 * std::atan2(q.vec().norm(), std::abs(q.w()));
    if (g != 0) CHECK(Group::order(g) == static_cast<int>(std::lround(2 * std::numbers::pi / turn)));
  }
}

TEST_CASE("the closest matching equals brute force over the 24") {
  std::mt19937_64 engine(1);
  double worst = 0, greatest = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const Quaternion p = random_rotation(engine), r = random_rotation(engine);
    const double angle = Group::angle(p, r);
    worst = std::max(worst, std::abs(angle - brute_force_angle(p, r)));
    greatest = std::max(greatest, angle);
  }
  CHECK(worst < 1e-12);
  // The cubic misorientation bound, 2 acos((2 + sqrt 2) / 4).
  CHECK(greatest < 2 * std::acos((2 + std::sqrt(2.0)) / 4) + 1e-12);
  CHECK(greatest > 1.05);
}

TEST_CASE("ties go to fewer components, then to the earlier, and to positive signs") {
  // All rotations of small whole components, which are full of ties, with both zeros.
  const auto signs = [](const Quaternion& g) { return std::array{g.w() < 0, g.x() < 0, g.y() < 0, g.z() < 0}; };
  const auto zeros = [](const Quaternion& g) { return std::array{g.w() == 0, g.x() == 0, g.y() == 0, g.z() == 0}; };
  const std::vector<double> values{-3, -2, -1, -0.0, 0, 1, 2, 3};
  for (const double w : values)
    for (const double x : values)
      for (const double y : values)
        for (const double z : values) {
          const Quaternion q(w, x, y, z);
          if (q.norm() == 0) continue;
          double cosine = 0;
          for (int g = 0; g < 24; ++g) cosine = std::max(cosine, std::abs(q.dot(Group::element(g))));
          // Both signs of each element are tried, so that the sign of a component means something.
          std::vector<std::pair<Quaternion, int>> ties;
          for (int g = 0; g < 24; ++g)
            for (const double sign : {1.0, -1.0})
              if (sign * q.dot(Group::element(g)) > cosine - 1e-12)
                ties.emplace_back(Quaternion(sign * Group::element(g).coeffs()), g);
          const auto rank = [&](const auto& tie) {
            const auto zero = zeros(tie.first);
            return std::tuple(-std::count(zero.begin(), zero.end(), true), zero, signs(tie.first));
          };
          const auto first = std::min_element(ties.begin(), ties.end(),
                                              [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
          REQUIRE(Group::nearest(q) == first->second);
          REQUIRE(CubeRotationGroup<float>::nearest(q.cast<float>()) == first->second);
        }
}

TEST_CASE("a matching takes one frame to the other") {
  std::mt19937_64 engine(2);
  for (int i = 0; i < 10'000; ++i) {
    const Quaternion p = random_rotation(engine), r = random_rotation(engine);
    const auto m = Group::matching(p, r);
    const Quaternion reached = m.rotation * p * Group::element(m.symmetry);
    REQUIRE(std::abs(reached.dot(r)) == Approx(1).margin(1e-14));
    REQUIRE(m.rotation.w() >= 0);
    REQUIRE(m.axis.norm() == Approx(1));
    REQUIRE((Group::rotation_vector(p, r) - m.angle * m.axis).norm() < 1e-12);
    REQUIRE(std::abs(Group::exponential(m.angle * m.axis).dot(m.rotation)) == Approx(1).margin(1e-14));
    const Quaternion near = Group::aligned(p, r);
    REQUIRE(Group::angle(near, r) < 1e-7);
    REQUIRE(2 * std::acos(std::min(1.0, near.dot(p))) == Approx(m.angle).margin(1e-7));
  }
}

TEST_CASE("small rotations keep their axis and angle, down to none") {
  for (const double angle : {1e-3, 1e-7, 1e-11, 1e-15, 0.0}) {
    const Vector3 axis = Vector3(1, -2, 3).normalized();
    const Quaternion p = Quaternion(0.3, 0.4, -0.5, 0.6).normalized();
    const Quaternion r = Quaternion(Eigen::AngleAxisd(angle, axis)) * p * Group::element(17);
    const auto m = Group::matching(p, r);
    CHECK(m.angle == Approx(angle).margin(1e-15));
    CHECK(m.axis.norm() == Approx(1));
    CHECK((Group::rotation_vector(p, r) - angle * axis).norm() < 1e-15);
  }
}

TEST_CASE("the representative is the least rotation of a frame, and one for all its forms") {
  std::mt19937_64 engine(3);
  for (int i = 0; i < 10'000; ++i) {
    const Quaternion p = random_rotation(engine), q = Group::representative(p);
    for (int g = 0; g < 24; ++g) {
      REQUIRE(q.w() >= std::abs((p * Group::element(g)).w()) - 1e-14);
      REQUIRE((Group::representative(p * Group::element(g)).coeffs() - q.coeffs()).norm() < 1e-12);
    }
  }
}

TEST_CASE("single precision works alike") {
  using Single = CubeRotationGroup<float>;
  std::mt19937_64 engine(4);
  for (int i = 0; i < 10'000; ++i) {
    const Quaternion p = random_rotation(engine), r = random_rotation(engine);
    REQUIRE(Single::angle(p.cast<float>(), r.cast<float>()) == Approx(Group::angle(p, r)).margin(1e-5));
  }
}
