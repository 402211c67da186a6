// SPDX-License-Identifier: BSL-1.0
// The size field that the command line asks for.
#pragma once

#include "framehex/io/triangle_soup.hpp"
#include "framehex/sizing/graded_size.hpp"
#include "framehex/surface/feature_detection.hpp"

#include "options.hpp"

#include <nlohmann/json_fwd.hpp>

namespace program {

/// What is wanted anywhere on or in a surface, as one field.
///
/// @param features  how patches are found. @param json  gets `sizes`.
/// @throws framehex::invalid_option  for sizes that make no sense with this surface; io_error, invalid_field for the file.
framehex::GradedSize make_size(const Options& options, const framehex::SoupSurface& soup,
                               const framehex::FeatureOptions& features, nlohmann::ordered_json& json);

}  // namespace program
