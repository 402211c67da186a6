// SPDX-License-Identifier: BSL-1.0
#include <catch2/catch.hpp>

#include "framehex/mesh/validation.hpp"
#include "framehex/surface/feature_detection.hpp"
#include "framehex/surface/refinement.hpp"
#include "framehex/surface/retriangulation.hpp"
#include "framehex/surface/surface_locator.hpp"
#include "support/stl.hpp"
#include "support/surface_checks.hpp"
#include "support/surface_samples.hpp"
#include "support/surfaces.hpp"

using namespace framehex;

namespace {

Vector3 normal(const IndexedTriangleMesh& surface, std::size_t t) {
  const auto& v = surface.triangles[t];
  return (surface.points[v[1]] - surface.points[v[0]]).cross(surface.points[v[2]] - surface.points[v[0]]).normalized();
}

double diagonal(const IndexedTriangleMesh& surface) {
  Vector3 low = surface.points[0], high = low;
  for (const Vector3& p : surface.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).norm();
}

/// All that a retriangulation promises, decided from the result alone.
void check_promises(const IndexedTriangleMesh& input, const FeatureGraph& features,
                    const std::vector<SurfaceSample>& samples, const Retriangulation& r, double deviation) {
  validate_closed(r.surface);
  CHECK(test::euler_characteristic(r.surface) == test::euler_characteristic(input));
  REQUIRE(r.surface.points.size() == samples.size() + r.n_unremoved);
  for (std::size_t i = 0; i < samples.size(); ++i) CHECK(r.surface.points[i] == samples[i].point);
  const TriangleAdjacency a = make_adjacency(r.surface);
  for (std::size_t v = 0; v < r.surface.points.size(); ++v) CHECK_FALSE(a.triangles_of_vertex[v].empty());

  const SurfaceLocator before(input), after(r.surface);
  for (const Vector3& p : input.points) CHECK(after.nearest(p).distance <= deviation * diagonal(input));
  for (std::size_t t = 0; t < r.surface.triangles.size(); ++t) {
    const auto& v = r.surface.triangles[t];
    const Vector3 centre = (r.surface.points[v[0]] + r.surface.points[v[1]] + r.surface.points[v[2]]) / 3;
    const SurfacePoint nearest = before.nearest(centre);
    CHECK(nearest.distance <= deviation * diagonal(input));
    CHECK(normal(input, nearest.triangle).dot(normal(r.surface, t)) > 0);
  }

  // Each curve runs over its samples in the order of arc length, along feature edges, and there are no others.
  REQUIRE(r.features.curves.size() == features.curves.size());
  CHECK(r.features.n_patches == features.n_patches);
  std::size_t on_curves = 0, marked = 0;
  for (std::size_t c = 0; c < r.features.curves.size(); ++c) {
    const auto curve = r.features.curves[c];
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
          if (std::minmax(a.from(h), a.to(h)) == std::minmax(curve[i], curve[i + 1])) found = r.features.is_feature[h];
      CHECK(found);
    }
  }
  for (index_t h = 0; h < a.opposite.size(); ++h) {
    CHECK(r.features.is_feature[h] == r.features.is_feature[a.opposite[h]]);
    marked += h < a.opposite[h] && r.features.is_feature[h];
    if (!r.features.is_feature[h])
      CHECK(r.features.triangle_patch[h / 3] == r.features.triangle_patch[a.opposite[h] / 3]);
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
    const FeatureGraph features = detect_features(m.surface, make_adjacency(m.surface));
    const auto samples = test::scatter_samples(m.surface, features, m.spacing);
    const Retriangulation r = retriangulate(m.surface, features, samples);
    CHECK(r.n_unremoved == 0);
    check_promises(m.surface, features, samples, r, m.deviation);
  }
}
