// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/surface.hpp"
#include "framehex/surface/surface_sample.hpp"

#include <cmath>
#include <map>
#include <random>

namespace framehex::test {

/// Corners, curves cut in equal intervals of about h, and random points no nearer than 0.75 h to any other: what a
/// surface inserter makes, without its order.
inline std::vector<SurfaceSample> scatter_samples(const Surface& surface, double h, std::uint64_t seed = 1) {
  const FeatureGraph& features = surface.features;
  std::vector<SurfaceSample> samples;
  std::map<std::array<long, 3>, std::vector<Vector3>> grid;
  const auto cell = [&](const Vector3& p) {
    return std::array<long, 3>{std::lround(std::floor(p.x() / h)), std::lround(std::floor(p.y() / h)),
                               std::lround(std::floor(p.z() / h))};
  };
  const auto add = [&](const SurfaceSample& s) {
    samples.push_back(s);
    grid[cell(s.point)].push_back(s.point);
  };
  for (index_t i = 0; i < features.corners.size(); ++i)
    add({surface.points[features.corners[i]], SampleKind::corner, i, 0});
  for (index_t c = 0; c < features.curves.size(); ++c) {
    const auto curve = features.curves[c];
    std::vector<double> arc{0};
    for (std::size_t i = 0; i + 1 < curve.size(); ++i)
      arc.push_back(arc.back() + (surface.points[curve[i + 1]] - surface.points[curve[i]]).norm());
    const bool loop = curve.front() == curve.back();
    const bool from_corner =
        std::find(features.corners.begin(), features.corners.end(), curve.front()) != features.corners.end();
    const int n = std::max(loop ? 3 : 1, static_cast<int>(std::lround(arc.back() / h)));
    std::size_t i = 0;
    for (int k = loop && !from_corner ? 0 : 1; k < n; ++k) {
      const double s = arc.back() * k / n;
      while (i + 2 < arc.size() && arc[i + 1] < s) ++i;
      const double x = (s - arc[i]) / (arc[i + 1] - arc[i]);
      add({surface.points[curve[i]] + x * (surface.points[curve[i + 1]] - surface.points[curve[i]]), SampleKind::curve,
           c, s});
    }
  }
  std::mt19937_64 engine(seed);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<double> sum{0};
  for (const auto& t : surface.triangles())
    sum.push_back(
        sum.back() +
        (surface.points[t[1]] - surface.points[t[0]]).cross(surface.points[t[2]] - surface.points[t[0]]).norm() / 2);
  const auto tries = static_cast<std::size_t>(20 * sum.back() / (h * h));
  for (std::size_t k = 0; k < tries; ++k) {
    const auto at = std::upper_bound(sum.begin() + 1, sum.end() - 1, uniform() * sum.back());
    const auto t = static_cast<index_t>(at - sum.begin() - 1);
    double u = uniform(), v = uniform();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const auto& c = surface.triangles()[t];
    const Vector3 p = surface.points[c[0]] + u * (surface.points[c[1]] - surface.points[c[0]]) +
                      v * (surface.points[c[2]] - surface.points[c[0]]);
    bool far = true;
    const auto at_cell = cell(p);
    for (long x = -1; x <= 1; ++x)
      for (long y = -1; y <= 1; ++y)
        for (long z = -1; z <= 1; ++z) {
          const auto it = grid.find({at_cell[0] + x, at_cell[1] + y, at_cell[2] + z});
          if (it == grid.end()) continue;
          for (const Vector3& q : it->second) far = far && (p - q).norm() > 0.75 * h;
        }
    if (far) add({p, SampleKind::surface, t, 0});
  }
  return samples;
}

}  // namespace framehex::test
