// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/label_names.hpp"
#include "framehex/io/text_buffer.hpp"
#include "framehex/mesh/mixed_faces.hpp"

#include <memory>
#include <optional>
#include <tuple>

namespace framehex {

namespace detail {

/// The faces of a mesh in OpenFOAM's order: inner ones by their two cells, then those of each patch by their cell.
class PolyMeshFaces {
public:
  struct Face {
    std::array<index_t, 4> vertices;  // as seen from outside the owner
    index_t owner, neighbour;         // no neighbour on the boundary
    index_t patch;                    // on the boundary: its place among the patches
    std::size_t size() const { return vertices[3] == no_index ? 3 : 4; }
  };
  struct Patch {
    std::string name;
    std::vector<std::string> groups;  // further names
    std::size_t n = 0, first = 0;
  };
  std::vector<Face> faces;
  std::vector<Patch> patches;
  std::map<std::string, std::vector<std::size_t>> zones;  // inner faces that have a label, by name

  PolyMeshFaces(const std::string& file, const MixedMesh& mesh) {
    label_faces(mesh);
    const FaceTable table = make_face_table(mesh);
    for (std::size_t g = 0; g < table.n_groups(); ++g) {
      const auto uses = table.group(g);
      if (uses.size() > 2)
        throw nonmanifold(file + ": a face of cell " + std::to_string(uses[0].cell) + " is one of three cells",
                          Entity::cell, {uses[0].cell});
      const index_t neighbour = uses.size() == 2 ? uses[1].cell : no_index;
      faces.push_back({uses[0].vertices, uses[0].cell, neighbour, uses.size() == 2 ? no_index : patch_of(uses[0])});
    }
    std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
      const bool inner_a = a.neighbour != no_index, inner_b = b.neighbour != no_index;
      if (inner_a != inner_b) return inner_a;
      return std::tie(a.patch, a.owner, a.neighbour, a.vertices) < std::tie(b.patch, b.owner, b.neighbour, b.vertices);
    });
    for (std::size_t f = 0; f < faces.size(); ++f) {
      if (faces[f].patch == no_index) {
        if (const auto label = label_of(faces[f].vertices))
          zones[patches[patch_of_label_.at(*label)].name].push_back(f);
        continue;
      }
      Patch& patch = patches[faces[f].patch];
      if (patch.n++ == 0) patch.first = f;
    }
    std::erase_if(patches, [](const Patch& patch) { return patch.n == 0; });
  }

  std::size_t n_inner() const {
    return static_cast<std::size_t>(
        std::find_if(faces.begin(), faces.end(), [](const Face& f) { return f.neighbour == no_index; }) -
        faces.begin());
  }

private:
  void label_faces(const MixedMesh& mesh) {
    std::map<std::string, index_t> patch_of_name;
    for (const auto& [label, names] : plain_names_of_labels(mesh, 2)) {
      const auto [at, is_new] = patch_of_name.try_emplace(names[0], static_cast<index_t>(patches.size()));
      if (is_new) patches.push_back({names[0], {}});
      patch_of_label_[label] = at->second;
      for (std::size_t i = 1; i < names.size(); ++i) {
        auto& groups = patches[at->second].groups;
        if (std::find(groups.begin(), groups.end(), names[i]) == groups.end()) groups.push_back(names[i]);
      }
    }
    for (const LabelledFace& face : mesh.faces) labels_.emplace_back(sorted_key(face.vertices), face.label);
    std::sort(labels_.begin(), labels_.end());
  }

  std::optional<index_t> label_of(const std::array<index_t, 4>& vertices) const {
    const auto key = sorted_key(vertices);
    const auto at = std::lower_bound(labels_.begin(), labels_.end(), std::pair(key, index_t{0}));
    if (at == labels_.end() || at->first != key) return std::nullopt;
    return at->second;
  }

  /// Faces without a label share a patch of their own.
  index_t patch_of(const CellFace& face) {
    if (const auto label = label_of(face.vertices)) return patch_of_label_.at(*label);
    if (unlabelled_ == no_index) {
      unlabelled_ = static_cast<index_t>(patches.size());
      patches.push_back({"defaultFaces", {}});
    }
    return unlabelled_;
  }

  static std::array<index_t, 4> sorted_key(std::array<index_t, 4> vertices) {
    std::sort(vertices.begin(), vertices.end());
    return vertices;
  }

  std::map<index_t, index_t> patch_of_label_;
  std::vector<std::pair<std::array<index_t, 4>, index_t>> labels_;  // of faces by their sorted vertices
  index_t unlabelled_ = no_index;
};

/// One file of the folder, under its temporary name until all of them are whole.
class PolyMeshFile {
public:
  PolyMeshFile(const std::filesystem::path& folder, std::string_view type, std::string_view object)
      : file_(folder / object), text_(file_) {
    text_ << "FoamFile\n{\n    version 2.0;\n    format ascii;\n    class " << type
          << ";\n    location \"constant/polyMesh\";\n    object " << object << ";\n}\n\n";
  }

  TextBuffer& text() { return text_; }
  void finish() {
    text_.flush();
    file_.finish();
  }
  void commit() { file_.commit(); }

private:
  OutputFile file_;
  TextBuffer text_;
};

class PolyMeshWriter {
public:
  PolyMeshWriter(const std::filesystem::path& folder, const MixedMesh& mesh)
      : folder_(folder), mesh_(mesh), faces_(folder.string(), mesh) {}

  void write() {
    std::error_code reason;
    std::filesystem::create_directories(folder_, reason);
    if (reason) throw io_error(folder_.string() + ": cannot be made (" + reason.message() + ")");
    write_points();
    write_faces();
    write_boundary();
    write_cell_zones();
    write_face_zones();
    for (const auto& file : files_) file->finish();
    for (const auto& file : files_) file->commit();
  }

private:
  TextBuffer& add(std::string_view type, std::string_view object) {
    files_.push_back(std::make_unique<PolyMeshFile>(folder_, type, object));
    return files_.back()->text();
  }

  void write_points() {
    TextBuffer& text = add("vectorField", "points");
    text << mesh_.points.size() << "\n(\n";
    for (const Vector3& p : mesh_.points) text << "(" << p.x() << " " << p.y() << " " << p.z() << ")\n";
    text << ")\n";
  }

  void write_faces() {
    TextBuffer& corners = add("faceList", "faces");
    corners << faces_.faces.size() << "\n(\n";
    for (const auto& face : faces_.faces) {
      corners << face.size() << "(";
      for (std::size_t i = 0; i < face.size(); ++i) corners << (i == 0 ? "" : " ") << face.vertices[i];
      corners << ")\n";
    }
    corners << ")\n";
    TextBuffer& owner = add("labelList", "owner");
    owner << faces_.faces.size() << "\n(\n";
    for (const auto& face : faces_.faces) owner << face.owner << "\n";
    owner << ")\n";
    TextBuffer& neighbour = add("labelList", "neighbour");
    neighbour << faces_.n_inner() << "\n(\n";
    for (std::size_t f = 0; f < faces_.n_inner(); ++f) neighbour << faces_.faces[f].neighbour << "\n";
    neighbour << ")\n";
  }

  void write_boundary() {
    TextBuffer& text = add("polyBoundaryMesh", "boundary");
    text << faces_.patches.size() << "\n(\n";
    for (const auto& patch : faces_.patches) {
      text << "    " << patch.name << "\n    {\n        type patch;\n";
      if (!patch.groups.empty()) {
        text << "        inGroups (";
        for (std::size_t i = 0; i < patch.groups.size(); ++i) text << (i == 0 ? "" : " ") << patch.groups[i];
        text << ");\n";
      }
      text << "        nFaces " << patch.n << ";\n        startFace " << patch.first << ";\n    }\n";
    }
    text << ")\n";
  }

  static void write_labels(TextBuffer& text, const std::vector<std::size_t>& labels) {
    text << "List<label>\n" << labels.size() << "\n(\n";
    for (const std::size_t label : labels) text << label << "\n";
    text << ");\n";
  }

  /// A zone for each region; a cell is in one only.
  void write_cell_zones() {
    if (mesh_.regions.empty()) return;
    std::map<std::string, std::vector<std::size_t>> cells;
    const auto names = plain_names_of_labels(mesh_, 3);
    for (std::size_t c = 0; c < mesh_.n_cells(); ++c) cells[names.at(mesh_.regions[c])[0]].push_back(c);
    TextBuffer& text = add("regIOobject", "cellZones");
    text << cells.size() << "\n(\n";
    for (const auto& [name, list] : cells) {
      text << name << "\n{\n    type cellZone;\n    cellLabels ";
      write_labels(text, list);
      text << "}\n";
    }
    text << ")\n";
  }

  /// Patches between regions, or within one.
  void write_face_zones() {
    if (faces_.zones.empty()) return;
    TextBuffer& text = add("regIOobject", "faceZones");
    text << faces_.zones.size() << "\n(\n";
    for (const auto& [name, list] : faces_.zones) {
      text << name << "\n{\n    type faceZone;\n    faceLabels ";
      write_labels(text, list);
      text << "    flipMap List<bool> " << list.size() << "{0};\n}\n";
    }
    text << ")\n";
  }

  std::filesystem::path folder_;
  const MixedMesh& mesh_;
  PolyMeshFaces faces_;
  std::vector<std::unique_ptr<PolyMeshFile>> files_;
};

}  // namespace detail

/// Writes a mesh for OpenFOAM: the files points, faces, owner, neighbour and boundary of a folder `polyMesh`, cellZones
/// where there are regions, faceZones where faces inside have labels.
///
/// Faces and cells stand as they are: no converter guesses which of the sheared cells are inside out.
///
/// @param folder  the folder, e.g. case/constant/polyMesh; made when it is not there. The files appear when all of them
///                are whole.
/// @param mesh    conforming. Labels of faces become patches of type `patch` named by their first group (characters that
///                OpenFOAM does not allow become _); faces without a label make the patch `defaultFaces`.
/// @throws nonmanifold  for a face of three cells; io_error naming the file.
/// @par Complexity   O(n log n).
/// @par Determinism  Same mesh, same bytes.
/// @par Source       OpenFOAM user guide, mesh description: upper triangular order of faces.
inline void write_polymesh(const std::filesystem::path& folder, const MixedMesh& mesh) {
  detail::PolyMeshWriter(folder, mesh).write();
}

}  // namespace framehex
