// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/io/mesh_builder.hpp"

#include <charconv>
#include <limits>
#include <map>
#include <set>
#include <unordered_map>

namespace framehex {

/// The numbers by which the files of a partitioned mesh agree.
struct MshPieceArrays {
  /// An element that a file holds for those that touch it; it belongs to another partition.
  struct Ghost {
    std::int64_t element, partition;
  };

  std::vector<std::int64_t> point_numbers;  ///< by point
  std::vector<std::int64_t> cell_numbers;   ///< by cell of the volume
  std::vector<Ghost> ghosts;
  RawLabels labels;
  std::size_t n_partitions = 0;         ///< of the whole mesh, where the file tells (4.1)
  std::int64_t greatest_partition = 0;  ///< that an element is told to belong to (2.2)
};

namespace detail {

/// @tparam Builder  takes what is found, as MeshBuilder does; one that says `takes_numbers` is given nodes by the numbers
///                  of the file, which are not looked up then.
template <class Builder = MeshBuilder>
class MshReader {
public:
  /// @param bytes  of the file; must outlive this, as must the builder.
  MshReader(const std::string& name, std::string_view bytes, Builder& builder) : in_(name, bytes), builder_(builder) {}

  /// @param arrays  receives what it has when not null. @param data  the same, of values by node and element.
  auto read(Volume volume, MshPieceArrays* arrays = nullptr, MeshData* data = nullptr) {
    arrays_ = arrays;
    wants_values_ = data != nullptr;
    if (in_.word() != "$MeshFormat") in_.fail("not a Gmsh mesh file");
    read_format();
    for (std::string_view section = next_section(); !section.empty(); section = next_section()) {
      if (section == "$Nodes" || section == "$ParametricNodes")
        version_ == 2 ? read_nodes_2(section) : read_nodes_4();
      else if (section == "$PhysicalNames")
        read_names();
      else if (section == "$Elements")
        version_ == 2 ? read_elements_2() : read_elements_4();
      else if (section == "$Entities" && version_ == 4)
        read_entities_4(section);
      else if (section == "$PartitionedEntities" && version_ == 4)
        read_entities_4(section);
      else if (section == "$GhostElements" && version_ == 4 && arrays_)
        read_ghosts();
      else if (wants_values_ && (section == "$NodeData" || section == "$ElementData"))
        read_values(section);
      else
        skip_section(section);
    }
    name_labels();
    if (data) place_values(*data);
    return builder_.finish(volume);
  }

private:
  /// Of one section: numbers of nodes or elements, and what belongs to them.
  struct Values {
    std::string name;
    bool by_node;
    std::vector<std::pair<std::int64_t, double>> rows;
  };

  struct ElementType {
    int dimension;
    CellKind kind;
    std::size_t n_corners;
  };

  ElementType element_type(std::int64_t type) const {
    switch (type) {
      case 1: return {1, {}, 2};
      case 2: return {2, {}, 3};
      case 3: return {2, {}, 4};
      case 4: return {3, CellKind::tetrahedron, 4};
      case 5: return {3, CellKind::hexahedron, 8};
      case 6: return {3, CellKind::prism, 6};
      case 7: return {3, CellKind::pyramid, 5};
      case 15: return {0, {}, 1};
      default: in_.fail("element type " + std::to_string(type) + " is not read (only linear elements are)");
    }
  }

  void read_format() {
    const auto version = in_.number<double>("the version");
    version_ = version >= 2 && version < 3 ? 2 : version == 4.1 ? 4 : 0;
    if (version_ == 0) in_.fail("version of the format is neither 2 nor 4.1");
    binary_ = in_.number<int>("the file type") == 1;
    const int data_size = in_.number<int>("the data size");
    if (data_size != 8) in_.fail("data size is not 8");
    if (binary_) {
      in_.line();
      const auto one = in_.raw<std::int32_t>();
      if (one != 1 && one != 0x01000000) in_.fail("the byte order is not told");
      order_ = (one == 1) == (std::endian::native == std::endian::little) ? std::endian::little : std::endian::big;
    }
    end_section("$EndMeshFormat");
  }

  std::string_view next_section() {
    const std::string_view section = in_.word();
    if (!section.empty() && section[0] != '$')
      in_.fail("a section should begin where \"" + Cursor::printable(section) + "\" stands");
    in_.line();
    return section;
  }

  void end_section(std::string_view keyword) {
    if (in_.word() != keyword) in_.fail(std::string(keyword) + " should stand here");
  }

  void skip_section(std::string_view section) {
    const std::string end = "$End" + std::string(section.substr(1));
    while (in_.remaining() > 0)
      if (in_.line().starts_with(end)) return;
    in_.fail("the file ends within " + Cursor::printable(section));
  }

  /// One number of the file, text or binary.
  template <class Stored>
  Stored get(const char* what) {
    return get<Stored>(in_, what);
  }
  template <class Stored>
  Stored get(Cursor& in, const char* what) const {
    return binary_ ? in.raw<Stored>(order_) : in.number<Stored>(what);
  }
  std::int64_t get_int(const char* what) { return get<std::int32_t>(what); }
  std::uint64_t get_size(const char* what) { return get<std::uint64_t>(what); }

  /// A count that the rest of the file can hold.
  std::size_t get_count(const char* what) {
    const std::uint64_t n = get_size(what);
    if (n > in_.remaining()) in_.fail(std::string(what) + " is " + std::to_string(n) + ", more than the file can hold");
    return static_cast<std::size_t>(n);
  }

  /// Lines of a dimension, a number and a name in quotes, in text always.
  void read_names() {
    const std::size_t n = in_.count("the number of names", 6);
    for (std::size_t i = 0; i < n; ++i) {
      const int dimension = in_.number<int>("a dimension");
      const auto group = in_.number<std::int64_t>("a physical group");
      const std::string_view line = in_.line();
      const std::size_t begin = line.find('"'), end = line.rfind('"');
      if (begin == line.npos || end == begin) in_.fail("a name in quotes should stand here");
      const std::string_view name = line.substr(begin + 1, end - begin - 1);
      if (name.starts_with("_part{"))
        groups_of_part_[{dimension, group}] = groups_in(name);
      else
        names_[{dimension, group}] = name;
    }
    end_section("$EndPhysicalNames");
  }

  /// The groups of the whole mesh that one of a partition stands for, by its name: "_part{1}_physical{7}_dim{3}".
  static std::vector<std::int64_t> groups_in(std::string_view name) {
    constexpr std::string_view key = "_physical{";
    std::vector<std::int64_t> groups;
    const std::size_t found = name.find(key);
    const char *at = name.data() + (found == name.npos ? name.size() : found + key.size()), *const end = name.data() +
                                                                                                         name.size();
    for (std::int64_t group = 0; at < end; ++at) {
      const auto read = std::from_chars(at, end, group);
      if (read.ec != std::errc()) break;
      if (group != 0) groups.push_back(group);
      at = read.ptr;
      if (at == end || *at != ',') break;
    }
    return groups;
  }

  /// Groups with those of partitions replaced: which partition something is in is not what it is.
  std::vector<std::int64_t> of_whole(int dimension, const std::vector<std::int64_t>& groups) const {
    std::set<std::int64_t> whole;
    for (const std::int64_t group : groups)
      if (const auto of_part = groups_of_part_.find({dimension, group}); of_part != groups_of_part_.end())
        whole.insert(of_part->second.begin(), of_part->second.end());
      else
        whole.insert(group);
    return {whole.begin(), whole.end()};
  }

  void add_names(int dimension, std::int64_t label, const std::vector<std::int64_t>& groups) {
    if (dimension == 0) return;
    for (const std::int64_t group : groups) {
      const auto name = names_.find({dimension, group});
      const bool named = name != names_.end() && !name->second.empty();
      constexpr std::array<const char*, 4> prefix{"", "curve_", "patch_", "region_"};
      // A group without a name is told by its elements' labels, unless they have several.
      if (named)
        builder_.add_name(dimension, label, group, name->second);
      else if (groups.size() > 1)
        builder_.add_name(dimension, label, group,
                          prefix[static_cast<std::size_t>(dimension)] + std::to_string(group - 1));
    }
  }

  void add_node(std::int64_t tag) {
    const auto x = get<double>("a coordinate"), y = get<double>("a coordinate"), z = get<double>("a coordinate");
    set_node(tag, x, y, z);
  }
  void set_node(std::int64_t tag, double x, double y, double z) {
    if constexpr (Builder::takes_numbers) {
      builder_.add_point(tag, x, y, z);
    } else {
      if (!index_of_tag_.try_emplace(tag, static_cast<std::int64_t>(builder_.n_points())).second)
        in_.fail("node " + std::to_string(tag) + " stands twice");
      builder_.add_point(x, y, z);
      if (arrays_) arrays_->point_numbers.push_back(tag);
    }
  }

  void add_element(const ElementType& type, std::span<std::int64_t> tags, std::int64_t label, std::int64_t number) {
    if (type.dimension == 0) return;
    for (std::int64_t& tag : tags) {
      if constexpr (Builder::takes_numbers) continue;
      const auto found = index_of_tag_.find(tag);
      if (found == index_of_tag_.end())
        throw invalid_connectivity(in_.name() + ": element " + std::to_string(number) + " refers to node " +
                                       std::to_string(tag) + ", which does not exist",
                                   Entity::cell, {static_cast<std::size_t>(number)});
      tag = found->second;
    }
    builder_.add(type.dimension, type.kind, tags, label, static_cast<std::size_t>(number));
    if (arrays_ && type.dimension == 3) arrays_->cell_numbers.push_back(number);
    if (wants_values_ && type.dimension == 3)
      cell_of_element_.try_emplace(number, static_cast<std::int64_t>(cell_of_element_.size()));
  }

  void read_nodes_2(std::string_view section) {
    const bool parametric = section == "$ParametricNodes";
    const std::size_t n = in_.count("the number of nodes", 7);
    in_.line();
    for (std::size_t i = 0; i < n; ++i) {
      add_node(get_int("a node's number"));
      if (!parametric) continue;
      const std::int64_t dimension = get_int("a dimension");
      get_int("an entity");
      // A node on a curve has one, a node on a surface two.
      for (std::int64_t p = 0; p < (dimension == 3 ? 0 : dimension) && p < 2; ++p) get<double>("a parameter");
    }
    end_section(parametric ? "$EndParametricNodes" : "$EndNodes");
  }

  void read_elements_2() {
    const std::size_t n = in_.count("the number of elements", 3);
    in_.line();
    std::array<std::int64_t, 8> corners{};
    for (std::size_t read = 0; read < n;) {
      // In text each element states its type; in binary a block of them does.
      std::int64_t number = binary_ ? 0 : get_int("an element's number");
      const ElementType type = element_type(get_int("an element type"));
      const std::int64_t n_block = binary_ ? get_int("the size of a block") : 1;
      const std::int64_t n_tags = get_int("the number of tags");
      if (n_block < 1 || n_tags < 0) in_.fail("a count is negative");
      for (std::int64_t i = 0; i < n_block; ++i, ++read) {
        if (binary_) number = get_int("an element's number");
        std::int64_t label = 0;
        for (std::int64_t t = 0; t < n_tags; ++t) {
          const std::int64_t tag = get_int("a tag");
          if (t == 0) label = tag;
          // The third tells how many partitions follow; those that the element is a ghost in are negative.
          if (t > 2 && arrays_) arrays_->greatest_partition = std::max(arrays_->greatest_partition, std::abs(tag));
        }
        if (!groups_of_part_.empty()) {
          const std::vector<std::int64_t> groups = of_whole(type.dimension, {label});
          label = groups.empty() ? 0 : groups[0];
        }
        for (std::size_t c = 0; c < type.n_corners; ++c) corners[c] = get_int("a node");
        add_element(type, std::span(corners).first(type.n_corners), label, number);
      }
    }
    end_section("$EndElements");
  }

  /// Entities, or, of a mesh in partitions, their parts, which have their groups.
  void read_entities_4(std::string_view section) {
    const bool in_parts = section == "$PartitionedEntities";
    if (in_parts) {
      const std::uint64_t n_partitions = get_size("the number of partitions");
      if (arrays_) arrays_->n_partitions = n_partitions;
      const std::size_t n_ghosts = get_count("the number of ghost entities");
      for (std::size_t i = 0; i < 2 * n_ghosts; ++i) get_int("a ghost entity");
    }
    std::array<std::size_t, 4> n{};
    for (std::size_t& count : n) count = get_count("a number of entities");
    for (int dimension = 0; dimension < 4; ++dimension)
      for (std::size_t i = 0; i < n[static_cast<std::size_t>(dimension)]; ++i) {
        const std::int64_t tag = get_int("an entity's number");
        if (in_parts) skip_parents();
        for (int x = 0; x < (dimension == 0 ? 3 : 6); ++x) get<double>("a coordinate");
        std::vector<std::int64_t>& groups = groups_[{dimension, tag}];
        groups.resize(get_count("the number of physical groups"));
        for (std::int64_t& group : groups) group = std::abs(get_int("a physical group"));  // the sign is an orientation
        if (!groups_of_part_.empty()) groups = of_whole(dimension, groups);
        if (dimension == 0) continue;
        const std::size_t n_bounding = get_count("the number of bounding entities");
        for (std::size_t b = 0; b < n_bounding; ++b) get_int("a bounding entity");
      }
    end_section(in_parts ? "$EndPartitionedEntities" : "$EndEntities");
    label_entities();
  }

  /// Of which entity something is a part, and in which partitions.
  void skip_parents() {
    for (int i = 0; i < 2; ++i) get_int("a parent entity");
    const std::size_t n_partitions = get_count("the number of partitions");
    for (std::size_t i = 0; i < n_partitions; ++i) get_int("a partition");
  }

  void read_ghosts() {
    const std::size_t n = get_count("the number of ghost elements");
    for (std::size_t i = 0; i < n; ++i) {
      const auto element = static_cast<std::int64_t>(get_size("an element's number"));
      arrays_->ghosts.push_back({element, get_int("a partition")});
      const std::size_t n_partitions = get_count("the number of partitions");
      for (std::size_t p = 0; p < n_partitions; ++p) get_int("a partition");
    }
    end_section("$EndGhostElements");
  }

  /// Entities of the same groups have one label: the group's number where it is one, else the first group's or, where
  /// other entities have that, a new one.
  void label_entities() {
    std::map<int, std::set<std::int64_t>> taken;
    for (const auto& [entity, groups] : groups_) {
      taken[entity.first].insert(groups.begin(), groups.end());
      if (groups.size() == 1) label_of_groups_[{entity.first, groups}] = groups[0];
    }
    for (const auto& [entity, groups] : groups_) {
      if (groups.empty()) continue;
      const auto [at, is_new] = label_of_groups_.try_emplace({entity.first, groups}, 0);
      std::set<std::int64_t>& numbers = taken[entity.first];
      if (is_new) {
        const bool first_is_free = std::none_of(
            label_of_groups_.begin(), label_of_groups_.end(),
            [&](const auto& other) { return other.first.first == entity.first && other.second == groups[0]; });
        at->second = first_is_free ? groups[0] : std::max(*numbers.rbegin() + 1, std::int64_t{1});
        numbers.insert(at->second);
      }
      label_of_entity_[entity] = at->second;
    }
  }

  void name_labels() {
    if (version_ == 2)
      for (const auto& [group, name] : names_) add_names(group.first, group.second, {group.second});
    for (const auto& [key, label] : label_of_groups_) add_names(key.first, label, key.second);
  }

  void read_nodes_4() {
    const std::size_t n_blocks = get_count("the number of blocks");
    for (int i = 0; i < 3; ++i) get_size("a number of nodes");
    for (std::size_t block = 0; block < n_blocks; ++block) {
      const std::int64_t dimension = get_int("a dimension");
      get_int("an entity");
      const bool parametric = get_int("whether parameters follow") != 0;
      const std::size_t n = get_count("the number of nodes of a block");
      Cursor numbers = in_;  // which stand before all coordinates of the block
      for (std::size_t i = 0; i < n; ++i) get_size("a node's number");
      for (std::size_t node = 0; node < n; ++node) {
        add_node(static_cast<std::int64_t>(get<std::uint64_t>(numbers, "a node's number")));
        for (std::int64_t i = 0; parametric && i < std::min<std::int64_t>(dimension, 3); ++i)
          get<double>("a parameter");
      }
    }
    end_section("$EndNodes");
  }

  void read_elements_4() {
    const std::size_t n_blocks = get_count("the number of blocks");
    for (int i = 0; i < 3; ++i) get_size("a number of elements");
    std::array<std::int64_t, 8> corners{};
    for (std::size_t block = 0; block < n_blocks; ++block) {
      const auto dimension = static_cast<int>(get_int("a dimension"));
      const std::int64_t entity = get_int("an entity");
      const ElementType type = element_type(get_int("an element type"));
      const std::size_t n = get_count("the number of elements of a block");
      const auto labelled = label_of_entity_.find({dimension, entity});
      const std::int64_t label = labelled != label_of_entity_.end() ? labelled->second : 0;
      for (std::size_t i = 0; i < n; ++i) {
        const auto number = static_cast<std::int64_t>(get_size("an element's number"));
        for (std::size_t c = 0; c < type.n_corners; ++c) corners[c] = static_cast<std::int64_t>(get_size("a node"));
        add_element(type, std::span(corners).first(type.n_corners), label, number);
      }
    }
    end_section("$EndElements");
  }

  /// Strings (the first is the name), reals and integers (step, components, rows), all in text; then the rows.
  void read_values(std::string_view section) {
    Values values{{}, section == "$NodeData", {}};
    const std::size_t n_names = in_.count("the number of strings", 1);
    in_.line();
    for (std::size_t i = 0; i < n_names; ++i) {
      const std::string_view line = in_.line();
      const std::size_t begin = line.find('"'), end = line.rfind('"');
      if (i == 0) values.name = begin == line.npos || end == begin ? line : line.substr(begin + 1, end - begin - 1);
    }
    const std::size_t n_reals = in_.count("the number of reals", 1);
    for (std::size_t i = 0; i < n_reals; ++i) in_.number<double>("a real");
    std::vector<std::int64_t> integers(in_.count("the number of integers", 1));
    for (std::int64_t& x : integers) x = in_.number<std::int64_t>("an integer");
    const auto most = static_cast<std::int64_t>(in_.remaining());
    if (integers.size() < 3 || integers[1] < 1 || integers[1] > most || integers[2] < 0 || integers[2] > most)
      in_.fail("components and rows of values should stand here");
    in_.line();
    for (std::int64_t row = 0; row < integers[2]; ++row) {
      const std::int64_t number = get_int("a number of a node or element");
      double value = 0;
      for (std::int64_t k = 0; k < integers[1]; ++k) value = get<double>("a value");
      values.rows.emplace_back(number, value);
    }
    if (integers[1] == 1) values_.push_back(std::move(values));
    end_section("$End" + std::string(section.substr(1)));
  }

  /// By point and by cell of the volume; not a number where the file has no value. Of steps of one name the last stays.
  void place_values(MeshData& data) const {
    for (const Values& values : values_) {
      const std::size_t n = values.by_node ? builder_.n_points() : cell_of_element_.size();
      std::vector<double> placed(n, std::numeric_limits<double>::quiet_NaN());
      const auto& places = values.by_node ? index_of_tag_ : cell_of_element_;
      bool any = false;
      for (const auto& [number, value] : values.rows)
        if (const auto found = places.find(number); found != places.end()) {
          placed[static_cast<std::size_t>(found->second)] = value;
          any = true;
        }
      std::vector<DataArray>& arrays = values.by_node ? data.points : data.cells;
      std::erase_if(arrays, [&](const DataArray& array) { return array.name == values.name; });
      if (any) arrays.push_back({values.name, std::move(placed)});
    }
  }

  Cursor in_;
  Builder& builder_;
  MshPieceArrays* arrays_ = nullptr;
  bool wants_values_ = false;
  std::vector<Values> values_;
  std::unordered_map<std::int64_t, std::int64_t> cell_of_element_;
  int version_ = 0;
  bool binary_ = false;
  std::endian order_ = std::endian::native;
  std::unordered_map<std::int64_t, std::int64_t> index_of_tag_;
  using Key = std::pair<int, std::int64_t>;                                            // dimension and number
  std::map<Key, std::string> names_;                                                   // of physical groups
  std::map<Key, std::vector<std::int64_t>> groups_of_part_;                            // see groups_in
  std::map<Key, std::vector<std::int64_t>> groups_;                                    // of entities
  std::map<std::pair<int, std::vector<std::int64_t>>, std::int64_t> label_of_groups_;  // dimension and groups
  std::map<Key, std::int64_t> label_of_entity_;
};

}  // namespace detail

/// Reads a mesh in Gmsh's format, version 2 or 4.1, text or binary.
///
/// @param data  receives values of one component by node and by element of the volume when not null.
/// @return cells, faces and edges with the number of their first physical group less one as labels (by rank where one
///         has none); names of groups. Entities that have a first group in common but not all have labels of their own.
/// @throws io_error naming file and line; invalid_connectivity (a node that does not exist) and invalid_coordinate
///         (NaN, infinity), both naming the file as well. Elements are named by their numbers in the file.
/// @par Complexity   O(n).
inline MixedMesh read_msh(const std::filesystem::path& path, Volume volume = Volume::required,
                          MeshData* data = nullptr) {
  const std::string bytes = read_file(path);
  detail::MeshBuilder builder(path.string(), 1);
  return detail::MshReader(path.string(), bytes, builder).read(volume, nullptr, data);
}

/// Reads the file of a partition, which may hold no cell.
///
/// @throws as `read_msh`.
inline MixedMesh read_msh_piece(const std::filesystem::path& path, MshPieceArrays& arrays) {
  const std::string bytes = read_file(path);
  detail::MeshBuilder builder(path.string(), 1);
  MixedMesh mesh = detail::MshReader(path.string(), bytes, builder).read(Volume::optional, &arrays);
  arrays.labels = builder.raw_labels();
  return mesh;
}

}  // namespace framehex
