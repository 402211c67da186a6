// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/mesh/mixed_mesh.hpp"

#include <string>

namespace framehex::detail {

/// The greatest label of which formats that count from 1 in 31 bits can hold the next number.
inline constexpr index_t greatest_label = (index_t{1} << 31) - 2;

/// Refuses, before a byte is written, labels that would come out as other numbers.
///
/// @throws io_error  with the file's name and the label.
inline void check_labels_fit(const std::string& name, const MixedMesh& mesh) {
  const auto check = [&](index_t label) {
    if (label > greatest_label)
      throw io_error(name + ": label " + std::to_string(label) + " is beyond " + std::to_string(greatest_label) +
                     ", the greatest that the format holds");
  };
  for (const index_t label : mesh.regions) check(label);
  for (const LabelledFace& face : mesh.faces) check(face.label);
  for (const LabelledEdge& edge : mesh.edges) check(edge.label);
}

}  // namespace framehex::detail
