// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/label_limit.hpp"
#include "framehex/io/output_file.hpp"
#include "framehex/io/quadratic_elements.hpp"
#include "framehex/mesh/mixed_mesh.hpp"

#include <algorithm>
#include <map>

namespace framehex {

namespace detail {

/// Gmsh's numbers of the element types, by corners and dimension.
constexpr int msh_element_type(int dimension, std::size_t n_corners) {
  if (dimension == 1) return 1;
  if (dimension == 2) return n_corners == 3 ? 2 : 3;
  switch (n_corners) {
    case 4: return 4;
    case 8: return 5;
    case 6: return 6;
    default: return 7;
  }
}

/// The same for elements with a node on each edge.
constexpr int msh_quadratic_type(int plain) {
  constexpr std::array<int, 8> types{0, 8, 9, 16, 11, 17, 18, 19};
  return types[static_cast<std::size_t>(plain)];
}

/// Elements of one entity (dimension and label) and one type: a block of the file.
struct MshBlocks {
  struct Key {
    int dimension;
    index_t label;
    int type;
    auto operator<=>(const Key&) const = default;
  };
  std::map<Key, Csr<index_t>> blocks;
  std::map<std::pair<int, index_t>, std::array<Vector3, 2>> entities;  // with their bounding boxes
  std::size_t n_elements = 0;

  std::vector<std::pair<int, index_t>> entity_list() const {
    std::vector<std::pair<int, index_t>> list;
    for (const auto& [entity, box] : entities) list.push_back(entity);
    return list;
  }

  explicit MshBlocks(const MixedMesh& mesh, const MidsideNodes* midside = nullptr) : midside_(midside) {
    for (const LabelledEdge& edge : mesh.edges) add(mesh, 1, edge.label, edge.vertices, face_edge_order(2));
    for (const LabelledFace& face : mesh.faces)
      add(mesh, 2, face.label, std::span(face.vertices).first(face.size()), face_edge_order(face.size()));
    for (std::size_t c = 0; c < mesh.n_cells(); ++c)
      add(mesh, 3, mesh.regions.empty() ? 0 : mesh.regions[c], mesh.cells[c], msh_edge_order(mesh.kinds[c]));
  }

private:
  void add(const MixedMesh& mesh, int dimension, index_t label, std::span<const index_t> corners, EdgeOrder order) {
    const int plain = msh_element_type(dimension, corners.size());
    Csr<index_t>& block = blocks[{dimension, label, midside_ ? msh_quadratic_type(plain) : plain}];
    block.values.insert(block.values.end(), corners.begin(), corners.end());
    if (midside_) append_midside(block.values, *midside_, mesh.points.size(), corners, order);
    block.end_row();
    ++n_elements;
    const Vector3& first = mesh.points[corners[0]];
    auto& box = entities.try_emplace({dimension, label}, std::array<Vector3, 2>{first, first}).first->second;
    for (const index_t v : corners) {
      box[0] = box[0].cwiseMin(mesh.points[v]);
      box[1] = box[1].cwiseMax(mesh.points[v]);
    }
  }

  const MidsideNodes* midside_;
};

/// Entities and physical groups are numbered from 1. @pre the label is at most `greatest_label`.
inline int msh_tag(index_t label) {
  return static_cast<int>(label) + 1;
}

/// Physical groups of the entities that a file holds: those that the mesh names, and one of its own for each other label.
class MshGroups {
public:
  MshGroups(const MixedMesh& mesh, const std::vector<std::pair<int, index_t>>& entities) {
    for (const LabelGroup& group : mesh.groups)
      for (const index_t label : group.labels)
        if (std::binary_search(entities.begin(), entities.end(), std::pair(group.dimension, label)))
          add({group.dimension, label}, group.number, group.name);
    constexpr std::array<const char*, 4> prefix{"", "curve_", "patch_", "region_"};
    for (const auto& entity : entities)
      if (!tags_.contains(entity))
        add(entity, entity.second, prefix[static_cast<std::size_t>(entity.first)] + std::to_string(entity.second));
  }

  const std::vector<int>& tags(const std::pair<int, index_t>& entity) const { return tags_.at(entity); }

  /// The section of names, in text. Quotes would end a name.
  std::string names() const {
    std::string text = "$PhysicalNames\n" + std::to_string(names_.size()) + "\n";
    for (const auto& [group, name] : names_) {
      std::string plain = name;
      std::replace_if(
          plain.begin(), plain.end(), [](char c) { return c == '"' || c == '\n' || c == '\r'; }, '\'');
      text += std::to_string(group.first) + " " + std::to_string(group.second) + " \"" + plain + "\"\n";
    }
    return text + "$EndPhysicalNames\n";
  }

private:
  void add(const std::pair<int, index_t>& entity, index_t number, const std::string& name) {
    tags_[entity].push_back(msh_tag(number));
    names_.try_emplace({entity.first, msh_tag(number)}, name);
  }

  std::map<std::pair<int, index_t>, std::vector<int>> tags_;  // of an entity
  std::map<std::pair<int, int>, std::string> names_;          // by dimension and tag
};

inline void write_msh_entities(OutputFile& file, const MshBlocks& blocks, const MshGroups& groups) {
  std::array<std::uint64_t, 4> n{};
  for (const auto& [entity, box] : blocks.entities) ++n[static_cast<std::size_t>(entity.first)];
  file.write("$Entities\n");
  file.write_values(n.data(), n.size());
  for (const auto& [entity, box] : blocks.entities) {  // by dimension, then by tag
    file.write_value(msh_tag(entity.second));
    file.write_values(box[0].data(), 3);
    file.write_values(box[1].data(), 3);
    const std::vector<int>& tags = groups.tags(entity);
    file.write_value(std::uint64_t{tags.size()});
    file.write_values(tags.data(), tags.size());
    file.write_value(std::uint64_t{0});  // what bounds it is not written
  }
  file.write("\n$EndEntities\n");
}

inline void write_msh_nodes(OutputFile& file, const std::vector<Vector3>& points, const MshBlocks& blocks) {
  const std::uint64_t n = points.size();
  const auto owner = blocks.entities.empty() ? std::pair<int, index_t>{3, 0} : blocks.entities.rbegin()->first;
  file.write("$Nodes\n");
  const std::array<std::uint64_t, 4> header{1, n, 1, n};
  file.write_values(header.data(), header.size());
  // All nodes stand on one volume, so that their order is kept; programs find those of a surface by its elements.
  const std::array<int, 3> block{owner.first, msh_tag(owner.second), 0};
  file.write_values(block.data(), block.size());
  file.write_value(n);
  for (std::uint64_t tag = 1; tag <= n; ++tag) file.write_value(tag);
  for (const Vector3& p : points) file.write_values(p.data(), 3);
  file.write("\n$EndNodes\n");
}

inline void write_msh_elements(OutputFile& file, const MshBlocks& blocks) {
  file.write("$Elements\n");
  const std::array<std::uint64_t, 4> header{blocks.blocks.size(), blocks.n_elements, 1, blocks.n_elements};
  file.write_values(header.data(), header.size());
  std::uint64_t tag = 0;
  for (const auto& [key, rows] : blocks.blocks) {
    const std::array<int, 3> block{key.dimension, msh_tag(key.label), key.type};
    file.write_values(block.data(), block.size());
    file.write_value(static_cast<std::uint64_t>(rows.size()));
    for (std::size_t row = 0; row < rows.size(); ++row) {
      file.write_value(++tag);
      for (const index_t v : rows[row]) file.write_value(std::uint64_t{v} + 1);
    }
  }
  file.write("\n$EndElements\n");
}

}  // namespace detail

/// Writes a mesh in Gmsh's MSH format, version 4.1, binary.
///
/// @param path  the file; appears whole or not at all (`OutputFile`).
/// @param mesh  each label of regions, faces and edges makes an entity of that number plus one (Gmsh counts from 1), in
///              the physical groups that `mesh.groups` names, or one of its own named `region_0`, `patch_0`, `curve_0`...
/// @param midside  nodes on its edges, when not null: elements are quadratic.
/// @throws io_error naming the file; for a label beyond 2^31 - 2 too.
/// @par Complexity   O(n log labels); connectivity is held once more in memory.
/// @par Determinism  Same mesh, same bytes (on machines of one byte order, which the file states).
/// @par Source       Gmsh reference manual, MSH file format version 4.1; its corner order is ours.
inline void write_msh(const std::filesystem::path& path, const MixedMesh& mesh, const MidsideNodes* midside = nullptr) {
  detail::check_labels_fit(path.string(), mesh);
  const detail::MshBlocks blocks(mesh, midside);
  const detail::MshGroups groups(mesh, blocks.entity_list());
  OutputFile file(path);
  file.write("$MeshFormat\n4.1 1 8\n");
  file.write_value(1);  // shows the byte order
  file.write("\n$EndMeshFormat\n" + groups.names());
  detail::write_msh_entities(file, blocks, groups);
  detail::write_msh_nodes(file, detail::points_with(mesh, midside), blocks);
  detail::write_msh_elements(file, blocks);
  file.commit();
}

}  // namespace framehex
