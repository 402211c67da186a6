// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/mixed_mesh.hpp"

#include <array>
#include <concepts>
#include <span>
#include <vector>

namespace framehex {

/// A host's own mesh of several kinds of cells, as a place to write to.
///
/// @code
/// struct MyOutput {
///   using vertex_type = ...;                                                // handles: cheap to copy
///   vertex_type add_vertex(const std::array<double, 3>& point);
///   void add_cell(CellKind kind, std::span<const vertex_type> corners);     // in the order of geometry/cell_kinds.hpp
///   // and, each only if the host keeps such a thing:
///   void add_cell(CellKind kind, std::span<const vertex_type> corners, index_t region);  // instead of the one above
///   void add_face(std::span<const vertex_type> corners, index_t label);     // 3 or 4, boundary: seen from outside
///   void add_edge(std::span<const vertex_type, 2> ends, index_t label);
///   void add_group(const LabelGroup& group);                                // a name of labels
/// };
/// @endcode
template <class O>
concept MixedOutput = requires(O& output, const std::array<double, 3>& point,
                               std::span<const typename O::vertex_type> corners) {
  { output.add_vertex(point) } -> std::convertible_to<typename O::vertex_type>;
  requires requires {
    output.add_cell(CellKind{}, corners);
  } || requires {
    output.add_cell(CellKind{}, corners, index_t{});
  };
};

namespace detail {

/// The handles that the host gave for a row of vertex numbers; valid until the next call.
template <class Vertex>
class HandleRow {
public:
  explicit HandleRow(const std::vector<Vertex>& handles) : handles_(handles) {}

  std::span<const Vertex> operator()(std::span<const index_t> numbers) {
    row_.clear();
    for (const index_t v : numbers) row_.push_back(handles_[v]);
    return row_;
  }

private:
  const std::vector<Vertex>& handles_;
  std::vector<Vertex> row_;
};

}  // namespace detail

/// Writes a mixed mesh into a host's own.
///
/// @param mesh    cells and labels in range, as every stage returns them.
/// @param output  is told all vertices in order, once each; then groups, cells in order, faces and edges. What it has
///                no function for is left out.
/// @throws what `output` throws; it then holds a part of the mesh.
/// @par Complexity   O(n); a handle a vertex.
template <MixedOutput O>
void export_mesh(const MixedMesh& mesh, O& output) {
  using Vertex = typename O::vertex_type;
  std::vector<Vertex> handles;
  handles.reserve(mesh.points.size());
  for (const Vector3& p : mesh.points) handles.push_back(output.add_vertex(std::array<double, 3>{p.x(), p.y(), p.z()}));
  detail::HandleRow<Vertex> row(handles);
  if constexpr (requires(const LabelGroup& group) { output.add_group(group); })
    for (const LabelGroup& group : mesh.groups) output.add_group(group);
  for (std::size_t cell = 0; cell < mesh.n_cells(); ++cell) {
    const std::span<const Vertex> corners = row(mesh.cells[cell]);
    if constexpr (requires { output.add_cell(CellKind{}, corners, index_t{}); })
      output.add_cell(mesh.kinds[cell], corners, mesh.regions.empty() ? index_t{0} : mesh.regions[cell]);
    else
      output.add_cell(mesh.kinds[cell], corners);
  }
  if constexpr (requires(std::span<const Vertex> corners) { output.add_face(corners, index_t{}); })
    for (const LabelledFace& face : mesh.faces)
      output.add_face(row(std::span(face.vertices).first(face.size())), face.label);
  if constexpr (requires(std::span<const Vertex, 2> ends) { output.add_edge(ends, index_t{}); })
    for (const LabelledEdge& edge : mesh.edges) output.add_edge(row(edge.vertices).template first<2>(), edge.label);
}

}  // namespace framehex
