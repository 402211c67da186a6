// SPDX-License-Identifier: BSL-1.0
#include "framehex/assembly/optimization.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "framehex/recombination/potential_prism_finder.hpp"
#include "framehex/selection/tomita.hpp"
#include "framehex/surface/refinement.hpp"
#include "support/cube_candidates.hpp"

#include <catch2/catch.hpp>

using namespace framehex;
using Catch::Matchers::Contains;

namespace {

template <class T>
struct NumberType {
  using type = T;
};
template <class T>
struct NumberType<std::optional<T>> {
  using type = T;
};

enum class Where { below, least, most, above, not_a_number };

/// A value of a number's type below its range, on its bounds, above it, or NaN; nothing where the type has none.
template <class T>
std::optional<T> value_at(Where where, double least, double most) {
  if constexpr (std::is_floating_point_v<T>) {
    switch (where) {
      case Where::below: return std::nextafter(least, -unbounded);
      case Where::least: return least;
      case Where::most: return most;
      case Where::above: return most < unbounded ? std::optional(std::nextafter(most, unbounded)) : std::nullopt;
      case Where::not_a_number: return std::nan("");
    }
  } else {
    const bool top = most < std::ldexp(1.0, std::numeric_limits<T>::digits) - 1;
    switch (where) {
      case Where::below:
        return std::is_signed_v<T> || least > 0 ? std::optional(static_cast<T>(least - 1)) : std::nullopt;
      case Where::least: return static_cast<T>(least);
      case Where::most: return top ? static_cast<T>(most) : std::numeric_limits<T>::max();
      case Where::above: return top ? std::optional(static_cast<T>(most + 1)) : std::nullopt;
      case Where::not_a_number: return {};
    }
  }
  return {};
}

/// Calls `tell(name, options)` for each number of an options struct, with that number at a place of its range.
/// @return how many numbers there are.
template <class Options, class Tell>
std::size_t for_each_number_at(Where where, Tell&& tell) {
  std::size_t n = 1;
  for (std::size_t k = 0; k < n; ++k) {
    Options options{};
    std::size_t at = 0;
    const char* changed = nullptr;
    Options::each_number(options, [&](const char* name, auto& number, double least, double most) {
      if (at++ != k) return;
      const auto value =
          value_at<typename NumberType<std::remove_reference_t<decltype(number)>>::type>(where, least, most);
      if (!value) return;
      number = *value;
      changed = name;
    });
    n = at;
    if (changed) tell(changed, options);
  }
  return n;
}

template <class Options>
std::size_t check_ranges() {
  CHECK_NOTHROW(check_options(Options{}));
  for (const Where where : {Where::least, Where::most})
    for_each_number_at<Options>(where, [&](const char* name, const Options& options) {
      CAPTURE(name);
      CHECK_NOTHROW(check_options(options));
    });
  std::size_t n = 0;
  for (const Where where : {Where::below, Where::above, Where::not_a_number})
    n = for_each_number_at<Options>(where, [&](const char* name, const Options& options) {
      CHECK_THROWS_WITH(check_options(options), Contains(name));
    });
  return n;
}

/// A stage refuses each number outside its range before it looks at anything else.
template <class Options, class Stage>
void check_stage(Stage&& stage) {
  for (const Where where : {Where::below, Where::above, Where::not_a_number})
    for_each_number_at<Options>(where, [&](const char* name, const Options& options) {
      CAPTURE(name);
      CHECK_THROWS_AS(stage(options), invalid_option);
    });
}

}  // namespace

TEST_CASE("every number of every options struct is refused outside its range, and accepted on its bounds",
          "[regression]") {
  CHECK(check_ranges<FeatureOptions>() == 3);
  CHECK(check_ranges<RefinementOptions>() == 1);
  CHECK(check_ranges<CrossFieldOptions>() == 4);
  CHECK(check_ranges<RetriangulationOptions>() == 4);
  CHECK(check_ranges<BoundaryFrameOptions>() == 1);
  CHECK(check_ranges<SmoothingOptions>() == 6);
  CHECK(check_ranges<DiffusionOptions>() == 4);
  CHECK(check_ranges<FieldOptions>() == 17);
  CHECK(check_ranges<MeshFieldOptions>() == 24);
  CHECK(check_ranges<CurveOptions>() == 3);
  CHECK(check_ranges<SurfaceOptions>() == 6);
  CHECK(check_ranges<VolumeOptions>() == 7);
  CHECK(check_ranges<FinderOptions>() == 2);
  CHECK(check_ranges<SelectOptions>() == 6);
  CHECK(check_ranges<EnumerationOptions>() == 1);
  CHECK(check_ranges<TomitaOptions>() == 1);
  CHECK(check_ranges<AssemblyOptions>() == 4);
  CHECK(check_ranges<OptimizationOptions>() == 3);
  CHECK(check_ranges<RecombineOptions>() == 12);
  CHECK(check_ranges<LatticeOptions>() == 24);
  CHECK(check_ranges<MeshingOptions>() == 83);
}

TEST_CASE("every stage refuses numbers outside their range") {
  const IndexedTetMesh mesh = test::kuhn_lattice(1);
  const TetAdjacency adjacency = make_adjacency(mesh);
  const Surface surface(extract_boundary(mesh, adjacency).surface);
  const SurfaceCrossField crosses = compute_cross_field(surface);
  const auto size = [](const Vector3&) { return 0.5; };
  const CurveInsertion curves = insert_curve_points(surface, size);

  check_stage<FeatureOptions>([&](const auto& o) { detect_features(surface, o); });
  check_stage<RefinementOptions>([&](const auto& o) { refine(surface, size, o); });
  check_stage<CrossFieldOptions>([&](const auto& o) { compute_cross_field(surface, o); });
  check_stage<RetriangulationOptions>([&](const auto& o) { retriangulate(surface, {}, o); });
  check_stage<BoundaryFrameOptions>([&](const auto& o) { make_boundary_frames(surface, crosses.frames, o); });
  check_stage<SmoothingOptions>([&](const auto& o) { smooth_frames(adjacency, {}, {}, {}, {}, o); });
  check_stage<DiffusionOptions>([&](const auto& o) { diffuse_frames(adjacency, {}, {}, {}, {}, o); });
  check_stage<FieldOptions>([&](const auto& o) { compute_frame_field(mesh, adjacency, surface, crosses.frames, o); });
  check_stage<MeshFieldOptions>([&](const auto& o) { compute_frame_field(mesh, o); });
  check_stage<CurveOptions>([&](const auto& o) { insert_curve_points(surface, size, o); });
  check_stage<SurfaceOptions>(
      [&](const auto& o) { insert_surface_points(surface, crosses.frames, crosses.smoothness, curves, size, o); });
  check_stage<FinderOptions>([&](const auto& o) { find_potential_hexahedra(mesh, o); });
  check_stage<FinderOptions>([&](const auto& o) { find_potential_prisms(mesh, o); });
  check_stage<SelectOptions>([&](const auto& o) { select(IncompatibilityGraph{}, o); });
  check_stage<EnumerationOptions>([&](const auto& o) {
    for_each_maximal_independent_set(
        IncompatibilityGraph{}, [](auto) {}, o);
  });
  check_stage<TomitaOptions>([&](const auto& o) { select_by_branch_and_bound(IncompatibilityGraph{}, o); });
  check_stage<AssemblyOptions>([&](const auto& o) { assemble(mesh, adjacency, PotentialHexahedra{}, {}, o); });
  check_stage<RecombineOptions>([&](const auto& o) { recombine(mesh, o); });
  MixedMesh none;
  check_stage<OptimizationOptions>([&](const auto& o) { optimize(none, o); });
}
