// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/planar_outline.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace framehex::detail {

/// Vertices and segments of an outline by name, with the polylines that have them: what errors say.
class OutlineNames {
public:
  explicit OutlineNames(const PlanarOutline& outline) : outline_(outline) {}

  std::string vertex(index_t v) const {
    for (std::size_t i = 0; i < outline_.n_polylines(); ++i) {
      const auto row = outline_.polyline(i);
      if (std::find(row.begin(), row.end(), v) != row.end())
        return "vertex " + std::to_string(v) + " of " + polyline(i);
    }
    return "vertex " + std::to_string(v);
  }

  std::string segment(index_t a, index_t b) const {
    const std::string name = "segment (" + std::to_string(a) + ", " + std::to_string(b) + ")";
    const std::string owner = owner_of_segment(a, b);
    return owner.empty() ? name : name + " of " + owner;
  }

  /// The first polyline that has a segment; nothing where none has.
  std::string owner_of_segment(index_t a, index_t b) const {
    const std::vector<std::size_t> owners = polylines_of(a, b);
    return owners.empty() ? std::string{} : polyline(owners[0]);
  }

  /// What is wrong with a segment that is there twice, and how it is meant to be given.
  std::string repeated(index_t a, index_t b) const {
    const std::vector<std::size_t> owners = polylines_of(a, b);
    std::string text = segment(a, b) + " occurs twice";
    if (owners.size() < 2) return text;
    if (owners[0] == owners[1] && outline_.polyline(owners[0]).size() == 3)
      return polyline(owners[0]) + " goes to and fro between vertices " + std::to_string(a) + " and " +
             std::to_string(b) + ": it encloses nothing";
    text += ", again in " + polyline(owners[1]);
    if (owners[1] < outline_.loops.size())
      text +=
          ": of regions side by side give the loop round all of them, and what they share once, as an inner polyline "
          "(in text: after a line `inner`)";
    return text;
  }

private:
  std::vector<std::size_t> polylines_of(index_t a, index_t b) const {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < outline_.n_polylines(); ++i) {
      const auto row = outline_.polyline(i);
      for (std::size_t k = 1; k < row.size(); ++k)
        if (std::minmax(row[k - 1], row[k]) == std::minmax(a, b)) found.push_back(i);
    }
    return found;
  }

  std::string polyline(std::size_t i) const {
    const std::size_t n_loops = outline_.loops.size();
    return i < n_loops ? "loop " + std::to_string(i) : "inner polyline " + std::to_string(i - n_loops);
  }

  const PlanarOutline& outline_;
};

}  // namespace framehex::detail
