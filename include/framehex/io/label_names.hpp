// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/mixed_mesh.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

namespace framehex::detail {

/// The labels that elements of a dimension have, ascending.
inline std::vector<index_t> used_labels(const MixedMesh& mesh, int dimension) {
  std::set<index_t> labels;
  if (dimension == 1)
    for (const LabelledEdge& edge : mesh.edges) labels.insert(edge.label);
  if (dimension == 2)
    for (const LabelledFace& face : mesh.faces) labels.insert(face.label);
  if (dimension == 3 && mesh.regions.empty() && mesh.n_cells() > 0) labels.insert(0);
  if (dimension == 3) labels.insert(mesh.regions.begin(), mesh.regions.end());
  return {labels.begin(), labels.end()};
}

/// A name for a format that allows letters, digits and `_` only, and begins with a letter.
inline std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (plain.empty() && !is_letter) plain += 'n';
    plain += is_letter || (c >= '0' && c <= '9') ? c : '_';
  }
  return plain.empty() ? "n" : plain;
}

/// Names of each label of a dimension: those of its groups, or "region_0", "patch_0", "curve_0" where it is in none.
/// Groups whose plain names are alike are told apart by their numbers.
inline std::map<index_t, std::vector<std::string>> plain_names_of_labels(const MixedMesh& mesh, int dimension) {
  std::map<index_t, std::vector<std::string>> names;
  std::map<std::string, index_t> taken;
  for (const index_t label : used_labels(mesh, dimension)) names[label];
  for (const LabelGroup& group : mesh.groups) {
    if (group.dimension != dimension) continue;
    std::string name = plain_name(group.name);
    if (!taken.try_emplace(name, group.number).second) name += "_" + std::to_string(group.number);
    for (const index_t label : group.labels)
      if (const auto at = names.find(label); at != names.end()) at->second.push_back(name);
  }
  constexpr std::array<const char*, 4> prefix{"", "curve_", "patch_", "region_"};
  for (auto& [label, list] : names)
    if (list.empty()) list.push_back(prefix[static_cast<std::size_t>(dimension)] + std::to_string(label));
  return names;
}

/// The other way round: labels of each name, in the order of names.
inline std::map<std::string, std::vector<index_t>> labels_of_plain_names(const MixedMesh& mesh, int dimension) {
  std::map<std::string, std::vector<index_t>> labels;
  for (const auto& [label, names] : plain_names_of_labels(mesh, dimension))
    for (const std::string& name : names) labels[name].push_back(label);
  return labels;
}

}  // namespace framehex::detail
