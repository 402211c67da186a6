// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/concepts.hpp"
#include "framehex/distributed/detail/packing.hpp"
#include "framehex/io/mesh_builder.hpp"

#include <charconv>

namespace framehex::distributed {

/// A part of a mesh as it was read.
struct ReadPart {
  IndexedPart part;
  std::vector<index_t> regions;    ///< per cell; empty on all ranks when the mesh has one region
  std::vector<LabelGroup> groups;  ///< names of regions, the same on all ranks
};

namespace detail {

/// A part with the labels as its files tell them.
struct LabelledPart {
  IndexedPart part;
  RawLabels labels;
};

/// The names of regions that any file tells, each once, in the order of the ranks. Collective.
///
/// @param by_name  groups have no numbers but their place in a file (VTK): those of one name are one.
inline std::vector<LabelName> all_names(const MpiTransport& transport, const std::vector<LabelName>& mine,
                                        bool by_name) {
  std::vector<std::string> texts;
  for (const LabelName& name : mine)
    if (name.dimension == 3) {
      std::string text = std::to_string(name.group) + ' ' + std::to_string(name.label) + ' ' + name.name;
      if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(std::move(text));
    }
  std::vector<LabelName> names;
  std::vector<std::string> groups;
  for (const std::string& text : gathered_texts(transport, texts)) {
    LabelName name{3, 0, 0, {}};
    const char* const end = text.data() + text.size();
    const char* const label = std::from_chars(text.data(), end, name.group).ptr + 1;
    name.name.assign(std::from_chars(label, end, name.label).ptr + 1, end);
    if (by_name) {
      const auto called = std::ranges::find(groups, name.name);
      name.group = called - groups.begin();
      if (called == groups.end()) groups.push_back(name.name);
    }
    const auto is_same = [&](const LabelName& n) { return n.group == name.group && n.label == name.label; };
    if (std::none_of(names.begin(), names.end(), is_same)) names.push_back(std::move(name));
  }
  return names;
}

/// Numbers labels for the whole mesh: what one means must not depend on the piece that it stands in. Collective.
///
/// @param first_label  see MeshBuilder; 0: groups are known by their names.
inline ReadPart with_regions(const MpiTransport& transport, LabelledPart read, std::int64_t first_label) {
  std::vector<std::int64_t> distinct = read.labels.cells;
  std::ranges::sort(distinct);
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  const framehex::detail::LabelNumbers none({}, first_label), number(gathered(transport, distinct), first_label);
  ReadPart result{std::move(read.part), {}, {}};
  result.groups = framehex::detail::groups_of(all_names(transport, read.labels.names, first_label == 0),
                                              {none, none, none, number}, first_label);
  const auto is_named = [&](std::int64_t label) { return number(label) != 0; };
  if (!any_rank(transport, std::ranges::any_of(distinct, is_named))) return result;
  for (const std::int64_t label : read.labels.cells) result.regions.push_back(number(label));
  return result;
}

}  // namespace detail

}  // namespace framehex::distributed
