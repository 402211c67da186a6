// SPDX-License-Identifier: BSL-1.0
#include <catch2/catch.hpp>

#include "framehex/surface/cross_field.hpp"
#include "framehex/surface/refinement.hpp"
#include "support/ply.hpp"
#include "support/stl.hpp"
#include "support/surface_checks.hpp"
#include "support/surfaces.hpp"

using namespace framehex;

namespace {

struct Case {
  Surface surface;
  SurfaceCrossField field;
};

Case solve(const IndexedTriangleMesh& coarse, double length, const CrossFieldOptions& options = {}) {
  Case c{refine(coarse, [&](const Vector3&) { return length; }).surface, {}};
  c.field = compute_cross_field(c.surface, options);
  return c;
}

int index_sum(const SurfaceCrossField& field) {
  int sum = 0;
  for (const auto& s : field.singularities) sum += s.index;
  return sum;
}

void check_frames(const Case& c) {
  REQUIRE(c.field.frames.size() == c.surface.triangles().size());
  for (std::size_t t = 0; t < c.field.frames.size(); ++t) {
    const auto& v = c.surface.triangles()[t];
    CHECK(c.field.frames[t].norm() == Approx(1).margin(1e-12));
    const Vector3 n = (c.surface.points[v[1]] - c.surface.points[v[0]])
                          .cross(c.surface.points[v[2]] - c.surface.points[v[0]])
                          .normalized();
    CHECK((c.field.frames[t] * Vector3::UnitZ() - n).norm() < 1e-9);
  }
  for (const double s : c.field.smoothness) CHECK((s >= 0 && s <= 1));
}

/// Greatest angle between an axis of the cross and the given directions, over all triangles.
template <class Direction>
double worst_misalignment(const Case& c, Direction&& direction) {
  double worst = 0;
  for (std::size_t t = 0; t < c.field.frames.size(); ++t) {
    const auto& v = c.surface.triangles()[t];
    const Vector3 centre = (c.surface.points[v[0]] + c.surface.points[v[1]] + c.surface.points[v[2]]) / 3;
    const Vector3 d = direction(centre, Vector3(c.field.frames[t] * Vector3::UnitZ()));
    const double cosine = std::max(std::abs((c.field.frames[t] * Vector3::UnitX()).dot(d)),
                                   std::abs((c.field.frames[t] * Vector3::UnitY()).dot(d)));
    worst = std::max(worst, std::acos(std::min(1.0, cosine)));
  }
  return worst;
}

}  // namespace

TEST_CASE("crosses on a box are its axes, and turn a quarter about each corner") {
  const Case c = solve(test::box_surface({1, 2, 1.5}), 0.2);
  check_frames(c);
  const double worst = worst_misalignment(c, [](const Vector3&, const Vector3& n) {
    return std::abs(n.x()) > 0.5 ? Vector3(Vector3::UnitY()) : Vector3(Vector3::UnitX());
  });
  CHECK(worst < 1e-7);  // what the arc cosine leaves
  CHECK(c.field.singularities.size() == 8);
  for (const auto& s : c.field.singularities) {
    CHECK(s.index == 1);
    CHECK(s.vertex < 8);
  }
  for (const double s : c.field.smoothness) CHECK(s == Approx(1));
}

TEST_CASE("crosses on the side of a cylinder follow its axis; each lid has four singular points") {
  const Case c = solve(test::cylinder_surface(0.5, 2, 48), 0.1);
  check_frames(c);
  for (std::size_t t = 0; t < c.field.frames.size(); ++t) {
    const Vector3 n = c.field.frames[t] * Vector3::UnitZ();
    if (std::abs(n.z()) > 0.5) continue;
    const double along = std::max(std::abs((c.field.frames[t] * Vector3::UnitX()).z()),
                                  std::abs((c.field.frames[t] * Vector3::UnitY()).z()));
    CHECK(along > 1 - 1e-9);
  }
  CHECK(index_sum(c.field) == 8);
  int top = 0, bottom = 0;
  for (const auto& s : c.field.singularities) {
    CHECK(s.index == 1);
    const Vector3& p = c.surface.points[s.vertex];
    CHECK(std::hypot(p.x(), p.y()) < 0.45);
    (p.z() > 1 ? top : bottom) += 1;
  }
  CHECK(top == 4);
  CHECK(bottom == 4);
}

TEST_CASE("on an annulus the crosses are radial: the exact solution of Laplace's equation") {
  // cos 4t and sin 4t of the polar angle are not harmonic themselves, but by symmetry their direction is kept.
  IndexedTriangleMesh ring;
  const int n = 64, m = 8;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i < n; ++i) {
      const double a = 2 * std::numbers::pi * i / n, r = 1 + 0.1 * j;
      ring.points.emplace_back(r * std::cos(a), r * std::sin(a), 0);
    }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const auto at = [&](int di, int dj) { return static_cast<index_t>((j + dj) * n + (i + di) % n); };
      ring.triangles.push_back({at(0, 0), at(0, 1), at(1, 1)});
      ring.triangles.push_back({at(0, 0), at(1, 1), at(1, 0)});
    }
  for (auto& t : ring.triangles) std::swap(t[1], t[2]);
  const Case c = solve(ring, 10);
  CHECK(c.field.singularities.empty());
  CHECK(worst_misalignment(c, [](const Vector3& p, const Vector3&) { return p.normalized(); }) < 0.02);
}

TEST_CASE("the indices sum to the Euler characteristic on closed surfaces") {
  struct Model {
    IndexedTriangleMesh surface;
    double length;
  };
  for (const Model& model :
       {Model{test::sphere_surface(1, 3), 1}, Model{test::torus_surface(1, 0.4, 40, 20), 1},
        Model{test::read_stl(FRAMEHEX_TEST_DATA "/bunny.stl"), 1}, Model{test::l_shape_surface(), 0.2},
        Model{test::cylinder_surface(0.5, 0.01, 7), 0.3}, Model{test::box_surface({1, 1, 1e-3}), 0.1},
        // A bracket with five bores and a blade with three cavities through: of genus 5 and 3.
        Model{test::read_ply(FRAMEHEX_TEST_DATA "/piece.ply"), 0.2},
        Model{test::read_ply(FRAMEHEX_TEST_DATA "/blade.ply"), 0.05}}) {
    const Case c = solve(model.surface, model.length);
    check_frames(c);
    CHECK(index_sum(c.field) == 4 * test::euler_characteristic(c.surface));
  }
}

TEST_CASE("a sphere has eight singular points of a quarter") {
  const Case sphere = solve(test::sphere_surface(1, 4), 1);
  CHECK(sphere.field.singularities.size() == 8);
  for (const auto& s : sphere.field.singularities) CHECK(s.index == 1);
}

TEST_CASE("curvature guidance lays the crosses of a torus along its circles") {
  const Case c = solve(test::torus_surface(1, 0.4, 48, 24), 1, {.curvature = 10});
  CHECK(c.field.singularities.empty());
  CHECK(worst_misalignment(c, [](const Vector3& p, const Vector3& n) {
          return Vector3(Vector3(-p.y(), p.x(), 0).normalized().cross(n).normalized());
        }) < 0.25);
}

TEST_CASE("the field turns with the surface") {
  const Quaternion turn(Eigen::AngleAxisd(0.7, Vector3(1, 2, -1).normalized()));
  for (const auto& surface : {test::cylinder_surface(0.5, 2, 24), test::read_stl(FRAMEHEX_TEST_DATA "/bunny.stl")}) {
    const Case before = solve(surface, 0.5);
    Case after = before;
    for (Vector3& p : after.surface.points) p = turn * p + Vector3(3, -1, 2);
    after.field = compute_cross_field(after.surface);
    for (std::size_t v = 0; v < before.field.smoothness.size(); ++v)
      CHECK(after.field.smoothness[v] == Approx(before.field.smoothness[v]).margin(1e-6));
    for (std::size_t t = 0; t < before.field.frames.size(); ++t) {
      const Eigen::Matrix3d a = (turn * before.field.frames[t]).toRotationMatrix();
      const Eigen::Matrix3d b = after.field.frames[t].toRotationMatrix();
      CHECK((a.transpose() * b).cwiseAbs().maxCoeff() > 1 - 1e-9);
      CHECK((a.col(0).cwiseProduct(b.col(0)).sum() * a.col(0).dot(b.col(1))) == Approx(0).margin(1e-6));
    }
  }
}

TEST_CASE("the field is finite on triangles without area") {
  IndexedTriangleMesh surface = test::box_surface({1, 1, 1});
  // A vertex on a diagonal, joined by a flat triangle.
  const TriangleAdjacency a = make_adjacency(surface);
  const FeatureGraph features = detect_features(surface);
  index_t h = 0;
  while (features.is_feature[h]) ++h;
  const auto v = static_cast<index_t>(surface.points.size());
  surface.points.push_back((surface.points[a.from(h)] + surface.points[a.to(h)]) / 2);
  surface.triangles[h / 3] = {a.from(h), v, a.apex(h)};
  surface.triangles.push_back({v, a.to(h), a.apex(h)});
  surface.triangles.push_back({a.from(h), a.to(h), v});
  const SurfaceCrossField field = compute_cross_field(surface);
  for (const Quaternion& q : field.frames) CHECK(q.norm() == Approx(1));
  CHECK(index_sum(field) == 8);
  CHECK_THROWS_AS(compute_cross_field(surface, {.curvature = -1}), invalid_option);
}

TEST_CASE("closed surfaces of very many triangles have the field of those of fewer") {
  const auto bumpy = [](int n) {
    IndexedTriangleMesh mesh = test::torus_surface(2, 0.7, 8 * n / 3, n);
    for (Vector3& p : mesh.points)
      p *= 1 + 0.12 * std::sin(3 * std::atan2(p.y(), p.x()) + 1) * std::sin(2 * p.z() + 0.3);
    Case c{Surface(mesh, {.angle = 3.1, .corner_angle = 3.1}), {}};
    c.field = compute_cross_field(c.surface);
    return c;
  };
  // Away from singular points the turn from triangle to triangle is as their size.
  const auto roughness = [](const Case& c) {
    double sum = 0;
    for (const double s : c.field.smoothness) sum += 1 - s;
    return sum / std::sqrt(static_cast<double>(c.field.smoothness.size()));
  };
  const Case coarse = bumpy(90), fine = bumpy(153);
  REQUIRE(3 * fine.surface.triangles().size() / 2 > 160'000);
  check_frames(fine);
  CHECK(index_sum(fine.field) == 0);
  CHECK(fine.field.singularities.size() == coarse.field.singularities.size());
  CHECK(roughness(fine) == Approx(roughness(coarse)).epsilon(0.1));

  IndexedTriangleMesh sphere = test::box_surface({2, 2, 2}, 100, 100, 100);
  for (Vector3& p : sphere.points) p = (p - Vector3::Ones()).normalized();
  const SurfaceCrossField field = compute_cross_field(Surface(sphere, {.angle = 3.1, .corner_angle = 3.1}));
  CHECK(field.singularities.size() == 8);
  for (const auto& s : field.singularities) CHECK(s.index == 1);
}
