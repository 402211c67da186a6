// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/io/label_limit.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/mesh/mixed_output.hpp"

#include <gmsh.h>

#include <map>
#include <unordered_map>

/// Gmsh, through its public C++ API: the mesh of the current model with its physical groups, both ways.
///
/// Gmsh is under the GPL: a program that includes this header is bound by it. The MSH files of io/ are not.
/// Labels are the tags of Gmsh's entities less one, and groups are its physical groups, as with MSH files.
namespace framehex {

/// Tetrahedra of a Gmsh model. Gmsh hands out copies, so that this one owns its arrays.
struct GmshTets {
  IndexedTetMesh mesh;
  std::vector<index_t> regions;                      ///< entity of each tetrahedron
  std::vector<LabelledFace> faces;                   ///< triangles on surfaces
  std::vector<LabelledEdge> edges;                   ///< lines on curves
  std::vector<LabelGroup> groups;                    ///< physical groups of volumes, surfaces and curves
  std::vector<std::size_t> node_tags, element_tags;  ///< vertex, tetrahedron -> tag in Gmsh
};

namespace detail {

/// Gmsh's element types: nodes, of which corners come first.
struct GmshType {
  std::size_t n_nodes, n_corners;
};
/// Lines, triangles and tetrahedra of first and second order.
inline const std::map<int, GmshType>& gmsh_simplices() {
  static const std::map<int, GmshType> types{{1, {2, 2}}, {8, {3, 2}}, {2, {3, 3}},
                                             {9, {6, 3}}, {4, {4, 4}}, {11, {10, 4}}};
  return types;
}

constexpr int gmsh_type(CellKind kind) {
  constexpr std::array<int, 4> types{4, 7, 6, 5};
  return types[static_cast<std::size_t>(kind)];
}

/// Reads element after element of all entities of one dimension: `body(label, element tag, corner tags)`.
template <class Body>
void for_gmsh_elements(int dimension, Body&& body) {
  gmsh::vectorpair entities;
  gmsh::model::getEntities(entities, dimension);
  for (const auto& [dim, entity] : entities) {
    std::vector<int> types;
    std::vector<std::vector<std::size_t>> elements, nodes;
    gmsh::model::mesh::getElements(types, elements, nodes, dim, entity);
    for (std::size_t block = 0; block < types.size(); ++block) {
      const auto type = gmsh_simplices().find(types[block]);
      if (type == gmsh_simplices().end())
        throw invalid_connectivity("element " + std::to_string(elements[block].front()) + " of Gmsh is no simplex",
                                   Entity::cell, {elements[block].front()});
      for (std::size_t i = 0; i < elements[block].size(); ++i)
        body(static_cast<index_t>(entity - 1), elements[block][i],
             std::span(nodes[block]).subspan(i * type->second.n_nodes, type->second.n_corners));
    }
  }
}

inline std::vector<LabelGroup> gmsh_groups() {
  std::vector<LabelGroup> groups;
  gmsh::vectorpair physical;
  gmsh::model::getPhysicalGroups(physical);
  for (const auto& [dimension, tag] : physical) {
    if (dimension == 0) continue;
    std::string name;
    gmsh::model::getPhysicalName(dimension, tag, name);
    std::vector<int> entities;
    gmsh::model::getEntitiesForPhysicalGroup(dimension, tag, entities);
    LabelGroup group{
        dimension, static_cast<index_t>(tag - 1), name.empty() ? "group_" + std::to_string(tag) : name, {}};
    for (const int entity : entities) group.labels.push_back(static_cast<index_t>(entity - 1));
    std::sort(group.labels.begin(), group.labels.end());
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace detail

/// Reads the mesh of Gmsh's current model. Vertices are those of tetrahedra, in the order of their tags.
///
/// @pre gmsh::initialize() was called.
/// @throws invalid_connectivity  with the tag of the first element of a volume, surface or curve that is no simplex.
/// @par Complexity   O(n log n).
inline GmshTets read_gmsh_model() {
  GmshTets result;
  std::vector<std::array<std::size_t, 4>> corner_tags;
  detail::for_gmsh_elements(3, [&](index_t label, std::size_t tag, std::span<const std::size_t> v) {
    corner_tags.push_back({v[0], v[1], v[2], v[3]});
    result.regions.push_back(label);
    result.element_tags.push_back(tag);
  });
  for (const auto& t : corner_tags) result.node_tags.insert(result.node_tags.end(), t.begin(), t.end());
  std::sort(result.node_tags.begin(), result.node_tags.end());
  result.node_tags.erase(std::unique(result.node_tags.begin(), result.node_tags.end()), result.node_tags.end());
  const auto number = [&](std::size_t tag) {
    const auto at = std::lower_bound(result.node_tags.begin(), result.node_tags.end(), tag);
    return at == result.node_tags.end() || *at != tag ? no_index : static_cast<index_t>(at - result.node_tags.begin());
  };

  std::vector<std::size_t> tags;
  std::vector<double> coordinates, parametric;
  gmsh::model::mesh::getNodes(tags, coordinates, parametric, -1, -1, false, false);
  result.mesh.points.resize(result.node_tags.size());
  for (std::size_t i = 0; i < tags.size(); ++i)
    if (const index_t v = number(tags[i]); v != no_index)
      result.mesh.points[v] = Vector3(coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]);
  for (const auto& t : corner_tags)
    result.mesh.tets.push_back({number(t[0]), number(t[1]), number(t[2]), number(t[3])});

  // Surfaces and curves may have elements that are no part of the volume's mesh.
  detail::for_gmsh_elements(2, [&](index_t label, std::size_t, std::span<const std::size_t> v) {
    const LabelledFace face{{number(v[0]), number(v[1]), number(v[2]), no_index}, label};
    if (std::count(face.vertices.begin(), face.vertices.end(), no_index) == 1) result.faces.push_back(face);
  });
  detail::for_gmsh_elements(1, [&](index_t label, std::size_t, std::span<const std::size_t> v) {
    const LabelledEdge edge{{number(v[0]), number(v[1])}, label};
    if (edge.vertices[0] != no_index && edge.vertices[1] != no_index) result.edges.push_back(edge);
  });
  result.groups = detail::gmsh_groups();
  return result;
}

/// Writes a mixed mesh into a new model of Gmsh, which becomes the current one when `finish` is called.
///
/// Each label makes a discrete entity, each group a physical group. Nodes stand on the last volume, in their order.
/// What is added throws io_error for labels and groups beyond 2^31 - 2, since tags are counted from 1 as `int`.
class GmshOutput {
public:
  using vertex_type = std::size_t;  ///< Gmsh's tag of the node

  explicit GmshOutput(std::string model_name) : name_(std::move(model_name)) {}

  std::size_t add_vertex(const std::array<double, 3>& p) {
    coordinates_.insert(coordinates_.end(), p.begin(), p.end());
    return coordinates_.size() / 3;
  }
  void add_cell(CellKind kind, std::span<const std::size_t> corners, index_t region) {
    add(3, region, detail::gmsh_type(kind), corners);
  }
  void add_face(std::span<const std::size_t> corners, index_t label) {
    add(2, label, corners.size() == 3 ? 2 : 3, corners);
  }
  void add_edge(std::span<const std::size_t, 2> ends, index_t label) { add(1, label, 1, ends); }
  void add_group(const LabelGroup& group) {
    detail::check_label_fits("Gmsh", group.number);
    groups_.push_back(group);
  }

  /// @throws what Gmsh throws.
  void finish() const {
    gmsh::model::add(name_);
    if (blocks_.empty()) return;
    for (const auto& [key, nodes] : blocks_) {
      gmsh::vectorpair known;
      gmsh::model::getEntities(known, key[0]);
      if (std::find(known.begin(), known.end(), std::pair(key[0], key[1])) == known.end())
        gmsh::model::addDiscreteEntity(key[0], key[1]);
    }
    const auto& owner = blocks_.rbegin()->first;
    std::vector<std::size_t> tags(coordinates_.size() / 3);
    for (std::size_t i = 0; i < tags.size(); ++i) tags[i] = i + 1;
    gmsh::model::mesh::addNodes(owner[0], owner[1], tags, coordinates_);
    std::size_t next = 1;
    for (const auto& [key, nodes] : blocks_) {
      std::string name;
      int dimension = 0, order = 0, n_nodes = 0, n_primary = 0;
      std::vector<double> local;
      gmsh::model::mesh::getElementProperties(key[2], name, dimension, order, n_nodes, local, n_primary);
      std::vector<std::size_t> elements(nodes.size() / static_cast<std::size_t>(n_nodes));
      for (std::size_t& tag : elements) tag = next++;
      gmsh::model::mesh::addElementsByType(key[1], key[2], elements, nodes);
    }
    for (const LabelGroup& group : groups_) write_group(group);
  }

private:
  void add(int dimension, index_t label, int type, std::span<const std::size_t> corners) {
    detail::check_label_fits("Gmsh", label);
    auto& nodes = blocks_[{dimension, static_cast<int>(label) + 1, type}];
    nodes.insert(nodes.end(), corners.begin(), corners.end());
  }

  void write_group(const LabelGroup& group) const {
    std::vector<int> entities;
    for (const index_t label : group.labels) {
      if (label > detail::greatest_label) continue;  // nothing has it
      const int tag = static_cast<int>(label) + 1;
      const auto at = blocks_.lower_bound({group.dimension, tag, 0});
      if (at != blocks_.end() && at->first[0] == group.dimension && at->first[1] == tag) entities.push_back(tag);
    }
    if (entities.empty()) return;
    const int tag = static_cast<int>(group.number) + 1;
    gmsh::model::addPhysicalGroup(group.dimension, entities, tag);
    gmsh::model::setPhysicalName(group.dimension, tag, group.name);
  }

  std::string name_;
  std::vector<double> coordinates_;
  std::map<std::array<int, 3>, std::vector<std::size_t>> blocks_;  // by dimension, entity, element type
  std::vector<LabelGroup> groups_;
};
static_assert(MixedOutput<GmshOutput>);

}  // namespace framehex
