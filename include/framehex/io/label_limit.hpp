// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/mesh/mixed_mesh.hpp"

#include <string>

namespace framehex::detail {

/// The greatest label of which formats that count from 1 in 31 bits can hold the next number.
inline constexpr index_t greatest_label = (index_t{1} << 31) - 2;

/// The greatest label of hosts that hold labels as `int`.
inline constexpr index_t greatest_int_label = (index_t{1} << 31) - 1;

/// Refuses a label that would come out as another number.
///
/// @param name  of the file or the host that is written to. @param greatest  label that it holds.
/// @throws io_error  with the name and the label.
inline void check_label_fits(const std::string& name, index_t label, index_t greatest = greatest_label) {
  if (label > greatest)
    throw io_error(name + ": label " + std::to_string(label) + " is beyond " + std::to_string(greatest) +
                   ", the greatest that the format holds");
}

/// Refuses, before a byte is written, labels that would come out as other numbers.
///
/// @throws io_error  with the file's name and the label.
inline void check_labels_fit(const std::string& name, const MixedMesh& mesh) {
  for (const index_t label : mesh.regions) check_label_fits(name, label);
  for (const LabelledFace& face : mesh.faces) check_label_fits(name, face.label);
  for (const LabelledEdge& edge : mesh.edges) check_label_fits(name, edge.label);
}

}  // namespace framehex::detail
