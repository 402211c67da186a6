// SPDX-License-Identifier: BSL-1.0
#include "framehex/insertion/rtree_filter.hpp"
#include "support/insertion_fixtures.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

using namespace framehex;
using namespace framehex::test;

namespace {

template <class Inserter>
concept Finishable = requires(Inserter&& inserter) {
  std::forward<Inserter>(inserter).finish();
};

const auto constant = [](double h) { return [h](const Vector3&) { return h; }; };
const Quaternion tilted = Quaternion(0.3, 0.5, -0.2, 0.7).normalized();

/// Seeds at the lattice points of the surface of a box of n cells of size h.
std::vector<BoundarySeed> lattice_seeds(const std::array<int, 3>& n, double h, const Quaternion& q) {
  std::vector<BoundarySeed> seeds;
  for (int i = 0; i <= n[0]; ++i)
    for (int j = 0; j <= n[1]; ++j)
      for (int k = 0; k <= n[2]; ++k) {
        const std::array<int, 3> at{i, j, k};
        Vector3 normal = Vector3::Zero();
        int sides = 0;
        for (int a = 0; a < 3; ++a) {
          const int x = at[static_cast<std::size_t>(a)];
          if (x != 0 && x != n[static_cast<std::size_t>(a)]) continue;
          normal[a] = x == 0 ? -1 : 1;
          ++sides;
        }
        if (sides > 0) seeds.push_back({q * Vector3(h * Vector3(i, j, k)), sides == 1 ? q * normal : Vector3::Zero()});
      }
  return seeds;
}

/// Radial frames about the origin: one axis along the radius, the others along meridians and parallels about z.
struct RadialFrames {
  ConstantFrames::Sample sample(const Vector3& p, index_t&) const {
    Eigen::Matrix3d m;
    m.col(0) = p.norm() > 1e-12 ? Vector3(p.normalized()) : Vector3::UnitX();
    const Vector3 east = Vector3::UnitZ().cross(m.col(0));
    m.col(1) = east.norm() > 1e-9 ? Vector3(east.normalized()) : Vector3(m.col(0).unitOrthogonal());
    m.col(2) = m.col(0).cross(m.col(1));
    return {Quaternion(m), p.head<2>().norm() / (p.norm() + 1e-12)};
  }
};

struct Shell {
  double inner, outer;
  double clearance(const Vector3& p, double) const { return std::min(p.norm() - inner, outer - p.norm()); }
};

std::vector<BoundarySeed> shell_seeds(const Shell& shell, double h) {
  std::vector<BoundarySeed> seeds;
  for (const double radius : {shell.inner, shell.outer}) {
    const auto n_rows = static_cast<int>(std::round(3.14159265 * radius / h));
    for (int row = 1; row < n_rows; ++row) {
      const double latitude = 3.14159265 * row / n_rows;
      const auto n = static_cast<int>(std::round(2 * 3.14159265 * radius * std::sin(latitude) / h));
      for (int i = 0; i < n; ++i) {
        const double longitude = 2 * 3.14159265 * i / n;
        const Vector3 direction(std::sin(latitude) * std::cos(longitude), std::sin(latitude) * std::sin(longitude),
                                std::cos(latitude));
        seeds.push_back({radius * direction, radius == shell.inner ? Vector3(-direction) : direction});
      }
    }
  }
  return seeds;
}

/// The rule itself, by brute force: a new point is `k` sizes from every earlier one in the infinity norm of its frame.
void check_distances(const VolumeInsertion& result, double k) {
  for (std::size_t i = result.n_seeds; i < result.points.size(); ++i) {
    const Eigen::Matrix3d axes = result.frames[i].toRotationMatrix();
    for (std::size_t j = 0; j < i; ++j) {
      const double distance = (axes.transpose() * (result.points[j] - result.points[i])).cwiseAbs().maxCoeff();
      if (distance < k * result.sizes[i] * (1 - 1e-12))
        FAIL("points " << i << " and " << j << " at " << distance / result.sizes[i]);
    }
  }
}

void check_links_are_mutual(const VolumeInsertion& result) {
  for (index_t i = 0; i < result.points.size(); ++i)
    for (const index_t j : result.links[i])
      if (j != no_index) {
        CHECK(j != i);
        CHECK(std::count(result.links[j].begin(), result.links[j].end(), i) == 1);
        CHECK(std::count(result.links[i].begin(), result.links[i].end(), j) == 1);
      }
}

}  // namespace

TEMPLATE_TEST_CASE("in a box with a constant field the points are the lattice", "", FifoOrder, SmoothnessOrder) {
  const std::array<int, 3> n{9, 7, 11};
  const double h = 0.37;
  for (const Quaternion& q : {Quaternion::Identity(), tilted, Quaternion(0.9, 0, 0.1, 0.4).normalized()})
    for (const auto averaging : {ParentAveraging::none, ParentAveraging::parents}) {
      const auto size = constant(h);
      const BoxDomain domain{q, h * Vector3(n[0], n[1], n[2])};
      const auto result = insert_volume_points<TestType>(lattice_seeds(n, h, q), ConstantFrames{q}, size, domain,
                                                         {.averaging = averaging});
      REQUIRE(result.points.size() == 10 * 8 * 12);
      std::set<std::array<long, 3>> places;
      for (const Vector3& p : result.points) {
        const Vector3 u = q.conjugate() * p / h;
        CHECK((u - u.array().round().matrix()).cwiseAbs().maxCoeff() < 1e-9);
        places.insert({std::lround(u.x()), std::lround(u.y()), std::lround(u.z())});
      }
      CHECK(places.size() == result.points.size());
      CHECK(lattice_cells(result.links).size() == 9 * 7 * 11);
      check_links_are_mutual(result);
    }
}

TEMPLATE_TEST_CASE("curves, surface and volume together give the lattice of a box", "", FifoOrder, SmoothnessOrder) {
  const double h = 0.1;
  for (const Quaternion& q : {Quaternion::Identity(), tilted}) {
    const auto mesh = turned(box_surface({0.8, 0.5, 0.7}, 3, 2, 4), q);
    const Surface surface(mesh);
    const auto size = constant(h);
    const auto on_surface = insert_surface_points<TestType>(surface, triangle_frames(mesh, q), {},
                                                            insert_curve_points(surface, size), size);
    const SurfaceLocator locator(surface);
    const auto result =
        insert_volume_points<TestType>(on_surface.seeds(), ConstantFrames{q}, size, SurfaceDomain{locator});
    CHECK(result.points.size() == 9 * 6 * 8);
    CHECK(lattice_cells(result.links).size() == 8 * 5 * 7);
    for (const Vector3& p : result.points) {
      const Vector3 u = q.conjugate() * p / h;
      CHECK((u - u.array().round().matrix()).cwiseAbs().maxCoeff() < 1e-9);
    }
  }
}

TEMPLATE_TEST_CASE("in a shell with radial frames the points keep the rules", "", FifoOrder, SmoothnessOrder) {
  const Shell shell{0.6, 1.5};
  const double h = 0.15;
  const auto size = constant(h);
  const auto seeds = shell_seeds(shell, h);
  for (const double k : {0.5, TestType::default_rejection, 0.8}) {
    const auto result = insert_volume_points<TestType>(seeds, RadialFrames{}, size, shell, {.rejection = k});
    REQUIRE(result.points.size() > 3000);
    CHECK(result.n_seeds == seeds.size());
    check_distances(result, k);
    check_links_are_mutual(result);
    for (std::size_t i = result.n_seeds; i < result.points.size(); ++i)
      CHECK(shell.clearance(result.points[i], 1) >= 0.5 * h);
    const VolumeStatistics& s = result.statistics;
    CHECK(s.proposals == s.linked + s.too_near_point + s.too_near_boundary + result.points.size() - result.n_seeds);
    std::vector<double> ratios;
    for (std::size_t i = result.n_seeds; i < result.points.size(); ++i)
      for (const index_t j : result.links[i])
        if (j != no_index) ratios.push_back((result.points[j] - result.points[i]).norm() / h);
    std::nth_element(ratios.begin(), ratios.begin() + static_cast<long>(ratios.size() / 2), ratios.end());
    CHECK(ratios[ratios.size() / 2] == Approx(1).epsilon(0.05));
  }
}

TEST_CASE("both proximity filters give the same points") {
  const Shell shell{0.6, 1.2};
  const auto size = [](const Vector3& p) { return 0.1 + 0.1 * std::abs(p.x()); };
  const auto seeds = shell_seeds(shell, 0.15);
  const auto a = insert_volume_points<SmoothnessOrder, HashGrid>(seeds, RadialFrames{}, size, shell);
  const auto b = insert_volume_points<SmoothnessOrder, RTreeFilter>(seeds, RadialFrames{}, size, shell);
  CHECK(a.points == b.points);
  CHECK(a.links == b.links);
}

TEST_CASE("sizes that jump by 100 leave no point too near and none outside") {
  const BoxDomain domain{Quaternion::Identity(), Vector3(1, 1, 1)};
  const auto size = [](const Vector3& p) { return p.norm() < 0.08 ? 0.004 : 0.4; };
  std::vector<BoundarySeed> seeds;
  for (const double x : {0.0, 1.0})
    for (const double y : {0.0, 1.0})
      for (const double z : {0.0, 1.0}) seeds.push_back({{x, y, z}, Vector3::Zero()});
  seeds.push_back({{0.02, 0.02, 0}, -Vector3::UnitZ()});
  const auto result = insert_volume_points<SmoothnessOrder>(seeds, ConstantFrames{}, size, domain);
  CHECK(result.status == Status::complete);
  CHECK(result.points.size() > 2000);
  check_distances(result, SmoothnessOrder::default_rejection);
  for (std::size_t i = result.n_seeds; i < result.points.size(); ++i) CHECK(domain.clearance(result.points[i], 1) > 0);
}

TEST_CASE("a front does not jump across a gap") {
  // Two slabs, 0.6 sizes apart; only the lower one has seeds.
  struct Slabs {
    double clearance(const Vector3& p, double) const {
      const double sides = std::min({p.x(), p.y(), 8 - p.x(), 8 - p.y()});
      return std::min(sides, std::max(std::min(p.z(), 4 - p.z()), std::min(p.z() - 4.6, 9 - p.z())));
    }
  };
  std::vector<BoundarySeed> seeds;
  for (int x = 1; x < 8; ++x)
    for (int y = 1; y < 8; ++y) seeds.push_back({Vector3(x, y, 0), -Vector3::UnitZ()});
  seeds.push_back({Vector3(8, 8, 9), Vector3::Zero()});
  const auto size = constant(1.7);
  const auto result = insert_volume_points<FifoOrder>(seeds, ConstantFrames{}, size, Slabs{});
  CHECK(result.points.size() > seeds.size());
  for (const Vector3& p : result.points) CHECK((p.z() < 4 || p.z() == 9));
}

TEST_CASE("bad sizes and options of the volume stage are refused; observer and budget stop it") {
  const std::array<int, 3> n{20, 20, 20};
  const auto seeds = lattice_seeds(n, 0.05, Quaternion::Identity());
  const BoxDomain domain{Quaternion::Identity(), Vector3(1, 1, 1)};
  const auto run = [&](double h, const VolumeOptions& options = {}) {
    const auto size = constant(h);
    return insert_volume_points<FifoOrder>(seeds, ConstantFrames{}, size, domain, options);
  };
  for (const double h : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    CHECK_THROWS_AS(run(h), invalid_field);
  CHECK_THROWS_WITH(run(0.004),
                    Catch::Contains("about 1.5625e+07 points in the volume") && Catch::Contains("max_points"));
  CHECK_THROWS_AS(run(0.05, {.max_points = 100}), invalid_option);
  CHECK_THROWS_AS(run(0.05, {.rejection = 0.0}), invalid_option);
  CHECK_THROWS_AS(run(0.05, {.boundary_distance = -1}), invalid_option);
  CHECK(run(3.0).points.size() == seeds.size());

  // The estimate looks at a grid only: what it overlooks is stopped on the way.
  const auto needle = [](const Vector3& p) { return std::abs(p.x() - 0.0625) < 0.02 ? 0.004 : 0.05; };
  const auto stopped = insert_volume_points<FifoOrder>(seeds, ConstantFrames{}, needle, domain, {.max_points = 9000});
  CHECK(stopped.status == Status::budget_exhausted);
  CHECK(stopped.points.size() - stopped.n_seeds <= 9006);

  int calls = 0;
  const auto cancelled = run(0.05, {.observer = [&](const Progress& progress) {
                               CHECK(progress.fraction >= 0);
                               CHECK(progress.fraction <= 1);
                               return ++calls < 2;
                             }});
  CHECK(cancelled.status == Status::cancelled);
  CHECK(calls == 2);

  double before = 0;
  run(0.05, {.observer = [&](const Progress& progress) {
        CHECK(progress.fraction >= before);
        before = progress.fraction;
        return progress.fraction < 0.6;  // in the third of four rounds
      }});
  CHECK(before >= 0.6);

  const auto size = constant(1.0);
  CHECK(insert_volume_points<FifoOrder>({}, ConstantFrames{}, size, domain).points.empty());
}

TEST_CASE("seeds that are not finite and frames that are not unit quaternions are refused by their place") {
  const BoxDomain domain{Quaternion::Identity(), Vector3(1, 1, 1)};
  const auto size = constant(0.25);
  auto seeds = lattice_seeds({4, 4, 4}, 0.25, Quaternion::Identity());
  struct LongFrames {
    ConstantFrames::Sample sample(const Vector3&, index_t&) const { return {Quaternion(2, 0.5, 0, 0), 1.0}; }
  };
  CHECK_THROWS_WITH(insert_volume_points<FifoOrder>(seeds, LongFrames{}, size, domain),
                    Catch::Contains("not a unit quaternion"));
  seeds[7].point.y() = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH(insert_volume_points<FifoOrder>(seeds, ConstantFrames{}, size, domain),
                    "boundary seed 7 has a coordinate that is not finite");
}

TEST_CASE("step by step is the same as in one go") {
  const Shell shell{0.6, 1.2};
  const auto size = constant(0.2);
  const auto seeds = shell_seeds(shell, 0.2);
  const RadialFrames frames;
  SmoothnessOrderedInserter<RadialFrames, decltype(size), Shell> inserter(frames, size, shell, seeds);
  // It takes the result out: not from an inserter that is looked at afterwards.
  static_assert(Finishable<decltype(inserter)> && !Finishable<decltype(inserter)&>);
  std::size_t steps = 0;
  while (inserter.step()) ++steps;
  const auto whole = insert_volume_points<SmoothnessOrder>(seeds, frames, size, shell, {.rounds = 0});
  CHECK(steps == whole.points.size());
  CHECK(inserter.result().points == whole.points);
}

TEMPLATE_TEST_CASE("a point moves only where no neighbour forbids it, a larger one far away neither", "", HashGrid,
                   RTreeFilter) {
  // Frames that turn and sizes that grow by a factor of forty across the box.
  struct Turning {
    ConstantFrames::Sample sample(const Vector3& p, index_t&) const {
      return {Quaternion(Eigen::AngleAxisd(p.x() + p.z(), Vector3(1, 2, 3).normalized())), 1.0};
    }
  };
  const auto size = [](const Vector3& p) { return 0.05 * std::pow(40, p.x() / 10); };
  const BoxDomain domain{Quaternion::Identity(), Vector3(10, 10, 10)};
  const Turning frames;
  const VolumeOptions options{.link_distance = 0.3};
  constexpr double rejection = 0.7;
  detail::VolumeLattice<Turning, decltype(size), BoxDomain, TestType> lattice(frames, size, domain, rejection, options);
  lattice.set_largest_size(2);
  std::mt19937_64 engine(3);
  const auto uniform = [&engine] { return 10 * static_cast<double>(engine() >> 11) * 0x1p-53; };
  const auto any_point = [&uniform] {
    const double x = uniform(), y = uniform(), z = uniform();
    return Vector3(x, y, z);
  };
  for (int i = 0; i < 150; ++i) {
    const Vector3 p = any_point();
    lattice.store(p, lattice.probe(p, no_index), 0, 1);
  }
  // Some have come from elsewhere and have another size now.
  for (index_t p = 0; p < 150; p += 3) {
    const Vector3 to = any_point();
    lattice.move(p, to, lattice.probe(to, no_index), 1);
  }
  int n_free = 0, n_forbidden_from_afar = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3 to = any_point();
    const auto there = lattice.probe(to, no_index);
    const double least = rejection * there.size;
    bool free = true, near = false;
    for (index_t q = 1; q < 150; ++q) {
      const Vector3 offset = lattice.site(q).point - to;
      const double theirs = frame_infinity_norm(lattice.site(q).frame.toRotationMatrix(), offset);
      if (frame_infinity_norm(there.axes, offset) >= least && theirs >= rejection * lattice.site(q).size) continue;
      free = false;
      near = near || offset.norm() < std::sqrt(3.0) * least;
    }
    n_free += free;
    n_forbidden_from_afar += !free && !near;
    if (lattice.may_move(0, to, there) != free) FAIL_CHECK("place " << i);
  }
  CHECK(n_free > 100);
  CHECK(n_forbidden_from_afar > 10);
}
