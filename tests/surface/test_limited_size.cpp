// SPDX-License-Identifier: BSL-1.0
#include "framehex/surface/limited_size.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace framehex;

namespace {

/// A size that varies.
double wavy(const Vector3& p) {
  return 0.3 + 0.1 * std::sin(3 * p.x()) * std::cos(2 * p.y());
}

struct Random {
  std::mt19937_64 engine;
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
  }
  Vector3 point() { return {(*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)}; }
};

}  // namespace

TEST_CASE("without limits the size is that of the size field, bit by bit") {
  const LimitedSize limited(wavy);
  Random random{std::mt19937_64(3)};
  for (int i = 0; i < 100; ++i) {
    const Vector3 p = random.point();
    CHECK(limited(p) == wavy(p));
  }
}

TEST_CASE("limits lower the size as a look at all of them says, but for those that change a tenth at most") {
  const double growth = 0.3;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random{std::mt19937_64(seed)};
    LimitedSize limited(wavy, growth);
    std::vector<SizeLimit> all;
    for (int batch = 0; batch < 3; ++batch) {
      std::vector<SizeLimit> more;
      for (int i = 0; i < 60; ++i) more.push_back({random.point(), std::exp2(-random(2, 8))});
      limited.add(more);
      all.insert(all.end(), more.begin(), more.end());
    }
    const auto by_all = [&](const Vector3& p) {
      double size = wavy(p);
      for (const SizeLimit& limit : all) size = std::min(size, limit.length + growth * (p - limit.place).norm());
      return size;
    };
    const auto check = [&](const Vector3& p) {
      CHECK(limited(p) >= by_all(p) * (1 - 1e-12));
      // What is left out is covered by another that may have been left out in turn when more were added.
      CHECK(limited(p) <= by_all(p) * 1.1 * 1.1 * 1.1);
    };
    for (int i = 0; i < 200; ++i) check(random.point());
    for (const SizeLimit& limit : all) check(limit.place);
    CHECK(limited.limits().size() < all.size());
    CHECK(std::ranges::is_sorted(limited.limits(), {}, &SizeLimit::length));
  }
}

TEST_CASE("many limits in one place are one") {
  const ConstantSize one{1.0};
  LimitedSize limited(one);
  const std::vector<SizeLimit> same(1000, SizeLimit{Vector3(0.3, 0, 0), 0.25});
  limited.add(same);
  CHECK(limited.limits().size() == 1);
  CHECK(limited(Vector3(0.3, 0, 0)) == 0.25);
  CHECK(limited(Vector3(0.3, 1, 0)) == Approx(0.55));
  CHECK(limited(Vector3(0.3, 5, 0)) == 1.0);
}
