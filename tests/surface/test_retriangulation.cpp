// SPDX-License-Identifier: BSL-1.0
#include <catch2/catch.hpp>

#include "framehex/mesh/validation.hpp"
#include "framehex/surface/feature_detection.hpp"
#include "framehex/surface/refinement.hpp"
#include "framehex/surface/retriangulation.hpp"
#include "framehex/surface/self_intersection.hpp"
#include "framehex/surface/surface_locator.hpp"
#include "support/stl.hpp"
#include "support/surface_checks.hpp"
#include "support/surface_samples.hpp"
#include "support/surfaces.hpp"

using namespace framehex;

namespace {

Vector3 normal(const Surface& surface, std::size_t t) {
  const auto& v = surface.triangles()[t];
  return (surface.points[v[1]] - surface.points[v[0]]).cross(surface.points[v[2]] - surface.points[v[0]]).normalized();
}

double diagonal(const Surface& surface) {
  Vector3 low = surface.points[0], high = low;
  for (const Vector3& p : surface.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).norm();
}

/// All that a retriangulation promises, decided from the result alone.
void check_promises(const Surface& input, const std::vector<SurfaceSample>& samples, const Retriangulation& r,
                    double deviation) {
  const FeatureGraph &before_features = input.features, &features = r.surface.features;
  validate_closed(r.surface);
  CHECK(r.crossings.empty());
  CHECK(find_self_intersections(r.surface).empty());
  CHECK(test::euler_characteristic(r.surface) == test::euler_characteristic(input));
  REQUIRE(r.surface.points.size() == samples.size() + r.n_unremoved + r.n_added);
  for (std::size_t i = 0; i < samples.size(); ++i) CHECK(r.surface.points[i] == samples[i].point);
  const TriangleAdjacency& a = r.surface.adjacency;
  for (std::size_t v = 0; v < r.surface.points.size(); ++v) CHECK_FALSE(a.triangles_of_vertex[v].empty());

  const SurfaceLocator before(input), after(r.surface);
  for (const Vector3& p : input.points) CHECK(after.nearest(p).distance <= deviation * diagonal(input));
  for (std::size_t t = 0; t < r.surface.triangles().size(); ++t) {
    const auto& v = r.surface.triangles()[t];
    const Vector3 centre = (r.surface.points[v[0]] + r.surface.points[v[1]] + r.surface.points[v[2]]) / 3;
    const SurfacePoint nearest = before.nearest(centre);
    CHECK(nearest.distance <= deviation * diagonal(input));
    CHECK(normal(input, nearest.triangle).dot(normal(r.surface, t)) > 0);
  }

  // Each curve runs over its samples in the order of arc length, along feature edges, and there are no others.
  REQUIRE(features.curves.size() == before_features.curves.size());
  CHECK(features.n_patches == before_features.n_patches);
  std::size_t on_curves = 0, marked = 0;
  for (std::size_t c = 0; c < features.curves.size(); ++c) {
    const auto curve = features.curves[c];
    on_curves += curve.size() - 1;
    double arc = -1;
    for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
      if (curve[i] < samples.size() && samples[curve[i]].kind == SampleKind::curve) {
        CHECK(samples[curve[i]].entity == c);
        CHECK(samples[curve[i]].arc > arc);
        arc = samples[curve[i]].arc;
      }
      bool found = false;
      for (const index_t t : a.triangles_of_vertex[curve[i]])
        for (index_t h = 3 * t; h < 3 * t + 3; ++h)
          if (std::minmax(a.from(h), a.to(h)) == std::minmax(curve[i], curve[i + 1])) found = features.is_feature[h];
      CHECK(found);
    }
  }
  for (index_t h = 0; h < a.opposite.size(); ++h) {
    CHECK(features.is_feature[h] == features.is_feature[a.opposite[h]]);
    marked += h < a.opposite[h] && features.is_feature[h];
    if (!features.is_feature[h]) CHECK(features.triangle_patch[h / 3] == features.triangle_patch[a.opposite[h] / 3]);
  }
  CHECK(marked == on_curves);
}

struct Model {
  const char* name;
  IndexedTriangleMesh surface;
  double spacing;
  double deviation;  ///< in parts of the diagonal
};

}  // namespace

TEST_CASE("a retriangulation has exactly the samples as vertices and keeps shape and features") {
  for (const Model& m :
       {Model{"box", test::box_surface({1, 1, 1}), 0.2, 1e-9},
        Model{"plate", test::box_surface({1, 1, 0.01}), 0.1, 1e-9}, Model{"L", test::l_shape_surface(), 0.15, 1e-9},
        Model{"cylinder", test::cylinder_surface(0.5, 2, 48), 0.1, 0.005},
        Model{"sphere", test::sphere_surface(1, 4), 0.2, 0.006},
        Model{"torus", test::torus_surface(1, 0.4, 60, 40), 0.15, 0.006},
        Model{"bunny", test::read_stl(FRAMEHEX_TEST_DATA "/bunny.stl"), 0.26, 0.01}}) {
    INFO(m.name);
    const auto samples = test::scatter_samples(m.surface, m.spacing);
    const Retriangulation r = retriangulate(m.surface, samples);
    CHECK(r.n_unremoved == 0);
    check_promises(m.surface, samples, r, m.deviation);
  }
}

TEST_CASE("flat faces come out Delaunay") {
  for (const Surface surface :
       {test::box_surface({1, 1, 1}), test::box_surface({1, 1, 0.01}), test::l_shape_surface()}) {
    const Retriangulation r = retriangulate(surface, test::scatter_samples(surface, 0.05));
    const TriangleAdjacency& a = r.surface.adjacency;
    for (index_t h = 0; h < a.opposite.size(); ++h) {
      if (r.surface.features.is_feature[h]) continue;
      // The opposite apex is not inside the sphere whose great circle is the triangle's circumcircle.
      const Vector3 &p = r.surface.points[a.from(h)], &q = r.surface.points[a.to(h)], &s = r.surface.points[a.apex(h)];
      const Vector3 u = q - p, v = s - p, n = u.cross(v);
      const Vector3 centre = (u.squaredNorm() * v.cross(n) + v.squaredNorm() * n.cross(u)) / (2 * n.squaredNorm());
      const double radius = centre.norm();
      CHECK((r.surface.points[a.apex(a.opposite[h])] - p - centre).norm() > radius * (1 - 1e-5));
    }
  }
}

TEST_CASE("a lattice on a box comes out as squares cut in two") {
  const Surface surface = test::box_surface({1, 1, 1});
  const int n = 6;
  std::vector<SurfaceSample> samples;
  const SurfaceLocator locator(surface);
  const auto lattice = test::box_surface({1, 1, 1}, n, n, n);
  for (const Vector3& p : lattice.points) {
    const int on = static_cast<int>((p.array() == 0 || p.array() == 1).count());
    if (on == 1) samples.push_back({p, SampleKind::surface, locator.nearest(p).triangle, 0});
  }
  for (index_t i = 0; i < 8; ++i)
    samples.push_back({surface.points[surface.features.corners[i]], SampleKind::corner, i, 0});
  for (index_t c = 0; c < 12; ++c) {
    const Vector3 &a = surface.points[surface.features.curves[c].front()],
                  &b = surface.points[surface.features.curves[c].back()];
    for (int k = 1; k < n; ++k) samples.push_back({a + (b - a) * k / n, SampleKind::curve, c, double(k) / n});
  }
  const Retriangulation r = retriangulate(surface, samples);
  check_promises(surface, samples, r, 1e-9);
  CHECK(r.n_unremoved == 0);
  REQUIRE(r.surface.triangles().size() == 12 * n * n);
  for (std::size_t t = 0; t < r.surface.triangles().size(); ++t)
    CHECK(test::area(r.surface, t) == Approx(0.5 / (n * n)).epsilon(1e-6));
}

TEST_CASE("walls thinner than the spacing are repaired, not crossed") {
  auto shell = test::sphere_surface(1, 4);
  const auto inner = test::sphere_surface(0.96, 4);
  const auto n = static_cast<index_t>(shell.points.size());
  shell.points.insert(shell.points.end(), inner.points.begin(), inner.points.end());
  for (const auto& t : inner.triangles) shell.triangles.push_back({t[0] + n, t[2] + n, t[1] + n});
  const auto samples = test::scatter_samples(shell, 0.5);
  const Retriangulation without = retriangulate(shell, samples, {.repair_rounds = -1});
  CHECK_FALSE(find_self_intersections(without.surface).empty());
  const Retriangulation r = retriangulate(shell, samples);
  CHECK(r.crossings.empty());
  CHECK(r.n_added > 0);
  CHECK(find_self_intersections(r.surface).empty());
  validate_closed(r.surface);
  CHECK(test::euler_characteristic(r.surface) == 4);
  const SurfaceLocator locator(shell);
  for (std::size_t i = 0; i < r.surface.points.size(); ++i)
    CHECK(locator.nearest(r.surface.points[i]).distance < 1e-12);
}

TEST_CASE("a horn that no sample stands on is not cut off") {
  auto mesh = test::sphere_surface(1, 5);
  for (Vector3& p : mesh.points) {
    const double angle = std::atan2(p.head<2>().norm(), p.z());
    p *= 1 + 0.6 * std::max(0.0, 1 - angle / 0.3);
  }
  const Surface surface(mesh, {.angle = 3});
  REQUIRE(surface.features.curves.size() == 0);
  auto samples = test::scatter_samples(surface, 0.25);
  std::erase_if(samples, [](const SurfaceSample& s) { return s.point.norm() > 1.001; });
  const auto farthest = [&](const Retriangulation& r) {
    const SurfaceLocator locator(r.surface);
    double most = 0;
    for (const Vector3& p : surface.points) most = std::max(most, locator.nearest(p).distance);
    return most / diagonal(surface);
  };
  constexpr double never = std::numeric_limits<double>::infinity();
  const Retriangulation cut = retriangulate(surface, samples, {.max_deviation = never});
  CHECK(cut.n_added == 0);
  CHECK(farthest(cut) > 0.1);
  const Retriangulation r = retriangulate(surface, samples);
  CHECK(r.n_added > 0);
  CHECK(farthest(r) < 0.03);
  validate_closed(r.surface);
  CHECK(find_self_intersections(r.surface).empty());
  const SurfaceLocator locator(surface);
  for (const Vector3& p : r.surface.points) CHECK(locator.nearest(p).distance < 1e-12);
}

TEST_CASE("input vertices that are corners without a sample stay and are counted") {
  const Surface surface = test::box_surface({1, 1, 1});
  auto samples = test::scatter_samples(surface, 0.3);
  std::erase_if(samples, [](const SurfaceSample& s) { return s.kind == SampleKind::corner && s.entity < 3; });
  const Retriangulation r = retriangulate(surface, samples);
  CHECK(r.n_unremoved == 3);
  check_promises(surface, samples, r, 1e-9);
  const Retriangulation none = retriangulate(surface, {});
  CHECK(none.n_unremoved == 8);
  CHECK(none.surface.triangles().size() == 12);
}

TEST_CASE("samples on vertices and edges of the input are taken as they are") {
  const Surface surface = test::sphere_surface(1, 2);
  std::vector<SurfaceSample> samples;
  std::vector<char> used(surface.points.size(), 0);
  for (index_t t = 0; t < surface.triangles().size(); ++t) {
    const auto& v = surface.triangles()[t];
    if (!used[v[0]]) samples.push_back({surface.points[v[0]], SampleKind::surface, t, 0});
    used[v[0]] = 1;
    if (v[0] < v[1]) samples.push_back({(surface.points[v[0]] + surface.points[v[1]]) / 2, SampleKind::surface, t, 0});
  }
  const Retriangulation r = retriangulate(surface, samples);
  CHECK(r.n_unremoved == 0);
  check_promises(surface, samples, r, 0.02);
}

TEST_CASE("bad samples are refused by name") {
  const Surface surface = test::box_surface({1, 1, 1});
  const auto with = [&](const SurfaceSample& extra) {
    auto samples = test::scatter_samples(surface, 0.5);
    const std::size_t at = samples.size();
    samples.push_back(extra);
    try {
      (void)retriangulate(surface, samples);
    } catch (const error& e) {
      CHECK(e.entity() == Entity::vertex);
      CHECK(e.indices().back() == at);
      throw;
    }
  };
  CHECK_THROWS_AS(with({{0, std::nan(""), 0}, SampleKind::surface, 0, 0}), invalid_coordinate);
  CHECK_THROWS_AS(with({{0, 0, 0}, SampleKind::surface, 12, 0}), invalid_connectivity);
  CHECK_THROWS_AS(with({{0, 0, 0}, SampleKind::corner, 8, 0}), invalid_connectivity);
  CHECK_THROWS_AS(with({{0, 0, 0}, SampleKind::curve, 12, 0.5}), invalid_connectivity);
  CHECK_THROWS_AS(with({surface.points[0], SampleKind::corner, 0, 0}), invalid_option);
  CHECK_THROWS_AS(with({surface.points[surface.triangles()[0][0]], SampleKind::surface, 0, 0}), invalid_option);
}

TEST_CASE("two samples in one place are refused, of whatever kind, with both numbers", "[regression]") {
  const Surface surface = test::box_surface({1, 1, 1});
  const auto samples = test::scatter_samples(surface, 0.3);
  const auto refused = [&](std::size_t first, const SurfaceSample& twin) {
    auto more = samples;
    more.push_back(twin);
    try {
      (void)retriangulate(surface, more);
      return false;
    } catch (const invalid_option& e) {
      return e.entity() == Entity::vertex && e.indices() == std::vector<std::size_t>{first, samples.size()};
    }
  };
  std::array<int, 3> kinds{};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    CAPTURE(i, static_cast<int>(samples[i].kind));
    ++kinds[static_cast<std::size_t>(samples[i].kind)];
    CHECK(refused(i, samples[i]));
    SurfaceSample near = samples[i];
    if (near.kind != SampleKind::curve) continue;
    near.arc += 1e-9;
    CHECK(refused(i, near));
    near.arc += 0.01;  // elsewhere by its arc, but the same point
    CHECK(refused(i, near));
  }
  for (const int n : kinds) CHECK(n > 7);
  // On the edge between two triangles, once from each side.
  for (index_t h = 0; h < 3 * surface.triangles().size(); ++h) {
    const TriangleAdjacency& adjacency = surface.adjacency;
    if (surface.features.is_feature[h]) continue;
    const Vector3 middle = 0.51 * surface.points[adjacency.from(h)] + 0.49 * surface.points[adjacency.to(h)];
    const std::vector<SurfaceSample> twins{{middle, SampleKind::surface, h / 3, 0},
                                           {middle, SampleKind::surface, adjacency.opposite[h] / 3, 0}};
    CHECK_THROWS_AS(retriangulate(surface, twins), invalid_option);
  }
}

TEST_CASE("a surface that crosses itself does not make the repair run away", "[regression]") {
  const auto torus = test::torus_surface(1, 1.3, 60, 40);
  const auto samples = test::scatter_samples(torus, 0.2);
  const Retriangulation r = retriangulate(torus, samples);
  CHECK(!r.crossings.empty());
  CHECK(r.n_added < 20 * samples.size());
}
