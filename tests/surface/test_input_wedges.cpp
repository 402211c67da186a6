// SPDX-License-Identifier: BSL-1.0
#include "framehex/surface/input_wedges.hpp"
#include "support/surfaces.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

namespace {

/// A prism over a triangle one long, whose angle at the origin is given; along z from 0 to 1.
Surface splinter(double angle) {
  return Surface(test::extruded_polygon({{0, 0}, {1, 0}, {std::cos(angle), std::sin(angle)}}, 1));
}

InputWedges wedges_of(const Surface& surface) {
  return InputWedges(surface, find_regions(surface));
}

}  // namespace

TEST_CASE("in a wedge there is no room where it is narrower than some hundredths of the size") {
  const double angle = 0.02;
  const Surface surface = splinter(angle);
  const InputWedges wedges = wedges_of(surface);
  for (const double size : {0.3, 0.05})
    for (int i = 0; i <= 20; ++i) {
      const double x = 0.05 * i;
      CHECK(wedges.hold({x, 0, 0.5}, size) == (x * angle < 0.07 * size));
    }
}

TEST_CASE("wider angles, and narrow ones outside the body, are no wedges") {
  CHECK_FALSE(wedges_of(splinter(0.2)).hold({0, 0, 0.5}, 1));
  CHECK_FALSE(wedges_of(Surface(test::box_surface({1, 2, 0.001}))).hold({0, 0, 0}, 1));
  // A notch: the same wedge, cut out of a plate.
  const Surface notch(
      test::extruded_polygon({{0, 0}, {1, 0.01}, {1, 0.5}, {-1, 0.5}, {-1, -0.5}, {1, -0.5}, {1, -0.01}}, 1));
  const InputWedges wedges = wedges_of(notch);
  CHECK_FALSE(wedges.hold({0, 0, 0.5}, 1));
}

TEST_CASE("a face that ends in a tip leaves no room at the tip") {
  // A box whose top has a fold from one corner to a point beside the opposite one: a splinter of a face, and no wedge
  // between faces.
  const Vector3 tip(0, 0, 1), end(1, 0.97, 1);
  const IndexedTriangleMesh mesh{
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, tip, {1, 0, 0.5}, {1, 1, 1}, {0, 1, 1}, end},
      {{0, 2, 1},
       {0, 3, 2},
       {0, 1, 5},
       {0, 5, 4},
       {1, 2, 8},
       {1, 8, 5},
       {2, 6, 8},
       {2, 3, 7},
       {2, 7, 6},
       {3, 0, 4},
       {3, 4, 7},
       {4, 5, 8},
       {4, 8, 6},
       {4, 6, 7}}};
  FeatureOptions options;
  options.given_edges = {{4, 8}, {4, 6}};
  const InputWedges wedges = wedges_of(Surface(mesh, options));
  CHECK(wedges.hold(tip, 1));
  CHECK(wedges.hold(tip, 0.01));
  CHECK_FALSE(wedges.hold(end, 0.1));
}
