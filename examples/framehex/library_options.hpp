// SPDX-License-Identifier: BSL-1.0
// From the program's options to the library's.
#pragma once

#include "framehex/field/compute_frame_field.hpp"
#include "framehex/pipeline/recombine.hpp"

#include "options.hpp"

#include <limits>
#include <numbers>

namespace program {

inline framehex::FieldMethod field_method(const Options& options) {
  if (options.field == "nearest") return framehex::FieldMethod::nearest;
  return options.field == "smoothed" ? framehex::FieldMethod::smoothed : framehex::FieldMethod::best;
}

inline framehex::FeatureOptions feature_options(const Options& options) {
  return {.angle = options.feature_degrees * std::numbers::pi / 180};
}

inline framehex::RecombineOptions recombine_options(const Options& options, const framehex::Observer& observer) {
  framehex::RecombineOptions r;
  r.finder.quality_floor = options.floor;
  r.selection.method = options.select == "greedy"  ? framehex::SelectMethod::greedy
                       : options.select == "exact" ? framehex::SelectMethod::exact
                                                   : framehex::SelectMethod::best;
  // Who asks for a gap or a time wants a proof; the default is the selection alone.
  if (options.gap_percent || options.budget_seconds) r.selection.gap = options.gap_percent.value_or(0.5) / 100;
  if (options.budget_seconds) r.selection.max_rounds = 1'000'000;
  if (options.budget_seconds) r.selection.seconds = *options.budget_seconds;
  r.selection.seed = options.seed;
  r.assembly.interfaces = options.interfaces == "open"          ? framehex::InterfaceMode::open
                          : options.interfaces == "no-pyramids" ? framehex::InterfaceMode::no_pyramids
                                                                : framehex::InterfaceMode::conforming;
  r.assembly.improvement = options.improve ? framehex::ImprovementMode::improve : framehex::ImprovementMode::none;
  r.assembly.fit = options.finite_volume ? framehex::CellFit::finite_volume : framehex::CellFit::any;
  r.assembly.vertex_numbers = framehex::VertexNumbers::compact;  // solvers want no vertex without a cell
  r.observer = observer;
  return r;
}

}  // namespace program
