// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace framehex {

/// What the indices of an error number.
enum class Entity { none, vertex, edge, triangle, cell, candidate, line, labelled_face, labelled_edge, polyline };

/// Root of everything that framehex throws on bad input.
///
/// `what()` names the entity for a person, `entity()` and `indices()` name it for a program. The indices are those
/// of the input: dense 0-based numbers of the kind `entity()`; an edge is given by its two vertices, a facet
/// without a number of its own by its three vertices (and `Entity::vertex`); a labelled face or edge by its position in
/// the span that was given; a polyline of an outline by its position, loops first.
class error : public std::runtime_error {
public:
  explicit error(const std::string& message) : std::runtime_error(message) {}
  error(const std::string& message, Entity entity, std::vector<std::size_t> indices)
      : std::runtime_error(message), entity_(entity), indices_(std::move(indices)) {}

  Entity entity() const noexcept { return entity_; }
  const std::vector<std::size_t>& indices() const noexcept { return indices_; }

private:
  Entity entity_ = Entity::none;
  std::vector<std::size_t> indices_;
};

// clang-format off

/// An option or parameter outside its documented range.
class invalid_option : public error { using error::error; };

/// A coordinate that is NaN, infinite or beyond 1e30; the vertex. A mesh less than 1e-30 wide; none.
class invalid_coordinate : public error { using error::error; };

/// A cell or triangle that refers to a vertex that does not exist, or twice to one; the cell or triangle.
class invalid_connectivity : public error { using error::error; };

/// A cell whose volume is zero or negative; the cell.
class inverted_cell : public error { using error::error; };

/// A facet used by more than two cells or twice from one side, or a surface edge used by other than two triangles; its vertices.
class nonmanifold : public error { using error::error; };

/// A surface with a hole; the two vertices of an edge on its rim.
class open_surface : public error { using error::error; };

/// A surface that crosses itself, or is refused for another reason by the tetrahedraliser.
class invalid_surface : public error { using error::error; };

/// A planar outline that bounds nothing, is open, or whose segments cross or touch; the polyline, the vertices of the
/// segments, or the vertex.
class invalid_outline : public error { using error::error; };

/// A frame, normal or size that cannot be used; the vertex or triangle.
class invalid_field : public error { using error::error; };

/// A negative, NaN or infinite weight; the candidate.
class invalid_weight : public error { using error::error; };

/// A graph with a self loop or an id out of range; the candidate.
class invalid_graph : public error { using error::error; };

/// Cells of a selection that cannot stand in one mesh; the candidates.
class incompatible_selection : public error { using error::error; };

/// A result that does not pass its own check and could not be mended; vertices of the input near the fault. A defect of
/// framehex: please report it.
class unsound_mesh : public error { using error::error; };

/// The tetrahedraliser is missing, failed, or broke its promises.
class tetrahedralization_error : public error { using error::error; };

/// A file that cannot be read, understood or written whole; the message starts with its name.
class io_error : public error { using error::error; };

// clang-format on

}  // namespace framehex
