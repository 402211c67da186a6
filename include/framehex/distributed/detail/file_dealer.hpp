// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/detail/part_labels.hpp"
#include "framehex/distributed/detail/part_numbering.hpp"
#include "framehex/io/mesh_builder.hpp"

#include <functional>

namespace framehex::distributed::detail {

/// A point on its way to the rank that tells others where it is.
struct DealtPoint {
  std::int64_t number;  ///< by which cells name it
  std::int64_t id;      ///< among those of the file
  std::array<double, 3> place;
};

/// A tetrahedron on its way to the rank that gets it.
struct DealtCell {
  std::int64_t id;
  std::array<std::int64_t, 4> corners;
  std::int64_t label;  ///< as in the file
};

/// What one rank has been dealt of a file.
struct DealtShare {
  std::vector<DealtPoint> points;
  std::vector<DealtCell> cells;
  std::vector<LabelName> names;  ///< on the rank that reads

  void take(const std::vector<Parcel>& arrived) {
    for (const Parcel& p : arrived) {
      Unpacker in(p.bytes);
      const auto more_points = in.take<DealtPoint>();
      const auto more_cells = in.take<DealtCell>();
      points.insert(points.end(), more_points.begin(), more_points.end());
      cells.insert(cells.end(), more_cells.begin(), more_cells.end());
    }
  }
};

/// The rank that is told of a number of a point.
inline std::size_t clerk_of(std::int64_t number, int n_ranks) {
  return static_cast<std::uint64_t>(number) / 1024 % static_cast<std::uint64_t>(n_ranks);
}

/// Deals out what a reader finds while it reads: takes the place of a MeshBuilder on the first rank, while the others
/// `receive_dealt`.
///
/// @tparam Numbered  points are told their numbers in the file; else they are counted from 0.
template <bool Numbered>
class FileDealer {
public:
  static constexpr bool takes_numbers = Numbered;

  /// @param release  gives back the memory of what was read; called after each block.
  FileDealer(const MpiTransport& transport, std::string name, DealtShare& own, std::function<void()> release)
      : transport_(transport),
        name_(std::move(name)),
        own_(own),
        release_(std::move(release)),
        points_(static_cast<std::size_t>(transport.n_ranks())),
        cells_(points_.size()) {}

  void add_point(double x, double y, double z) { add_point(n_points_, x, y, z); }

  void add_point(std::int64_t number, double x, double y, double z) {
    if (!Vector3(x, y, z).allFinite()) framehex::detail::throw_not_finite(name_, n_points());
    points_[clerk_of(number, transport_.n_ranks())].push_back({number, n_points_++, {x, y, z}});
    if (++n_waiting_ == n_at_once) send(false);
  }
  std::size_t n_points() const { return static_cast<std::size_t>(n_points_); }

  void add(int dimension, CellKind kind, std::span<const std::int64_t> corners, std::int64_t label,
           std::size_t number) {
    for (const std::int64_t corner : corners) {
      if (!Numbered && (corner < 0 || corner >= std::int64_t{no_index}))
        framehex::detail::throw_missing_vertex(name_, number, corner, n_points());
      if (corner > greatest_) greatest_ = corner, greatest_user_ = number;
    }
    if (dimension != 3) return;
    if (kind != CellKind::tetrahedron)
      throw invalid_connectivity(name_ + ": cell " + std::to_string(n_cells_) + " is not a tetrahedron", Entity::cell,
                                 {static_cast<std::size_t>(n_cells_)});
    const auto rank = static_cast<std::size_t>(n_cells_ / cells_a_turn) % cells_.size();
    cells_[rank].push_back({n_cells_++, {corners[0], corners[1], corners[2], corners[3]}, label});
    if (++n_waiting_ == n_at_once) send(false);
  }

  void add_vtk(std::int64_t type, std::span<const std::int64_t> corners, std::int64_t label, std::size_t number) {
    framehex::detail::add_vtk_cell(*this, name_, type, corners, label, number);
  }

  void add_name(int dimension, std::int64_t label, std::int64_t group, const std::string& name) {
    own_.names.push_back({dimension, group, label, name});
  }

  /// @throws as MeshBuilder::finish.
  void finish(Volume volume) {
    if (!Numbered && greatest_ >= n_points_)
      framehex::detail::throw_missing_vertex(name_, greatest_user_, greatest_, n_points());
    if (n_cells_ == 0 && volume == Volume::required) throw io_error(name_ + ": holds no tetrahedron");
    send(true);
  }

private:
  /// Points and cells that wait for others, to be sent together; cells that one rank gets on end.
  static constexpr std::size_t n_at_once = std::size_t{1} << 17;
  static constexpr std::int64_t cells_a_turn = 2048;

  void send(bool is_last) {
    std::vector<Parcel> parcels = parcels_of(points_, cells_);
    for (auto& row : points_) row.clear();
    for (auto& row : cells_) row.clear();
    n_waiting_ = 0;
    own_.take(transport_.exchange(std::move(parcels)));
    any_rank(transport_, is_last);
    if (release_) release_();
  }

  const MpiTransport& transport_;
  std::string name_;
  DealtShare& own_;
  std::function<void()> release_;
  std::vector<std::vector<DealtPoint>> points_;  ///< by rank, as the cells
  std::vector<std::vector<DealtCell>> cells_;
  std::size_t n_waiting_ = 0, greatest_user_ = 0;
  std::int64_t n_points_ = 0, n_cells_ = 0, greatest_ = -1;
};

/// What a rank that does not read does meanwhile.
inline void receive_dealt(const MpiTransport& transport, DealtShare& share) {
  for (bool is_last = false; !is_last; is_last = any_rank(transport, false)) share.take(transport.exchange({}));
}

/// A part out of what was dealt to this rank. Collective.
///
/// @param name    of the file, for errors.
/// @throws io_error  for a number that two points have; invalid_connectivity  for one that none has.
inline LabelledPart part_of_share(const MpiTransport& transport, const std::string& name, DealtShare share) {
  std::ranges::sort(share.points, {}, &DealtPoint::number);
  const auto twice = std::ranges::adjacent_find(share.points, {}, &DealtPoint::number);
  if (twice != share.points.end()) throw io_error(name + ": node " + std::to_string(twice->number) + " stands twice");

  IndexedPart part;
  std::vector<std::int64_t> numbers, labels;
  for (const DealtCell& cell : share.cells) {
    numbers.insert(numbers.end(), cell.corners.begin(), cell.corners.end());
    labels.push_back(cell.label);
  }
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  std::vector<std::vector<std::int64_t>> questions(static_cast<std::size_t>(transport.n_ranks()));
  for (const std::int64_t n : numbers) questions[clerk_of(n, transport.n_ranks())].push_back(n);
  const auto answers = ask<DealtPoint>(transport, questions, [&](std::int64_t number, int) {
    const auto at = std::ranges::lower_bound(share.points, number, {}, &DealtPoint::number);
    return at != share.points.end() && at->number == number ? *at : DealtPoint{number, -1, {}};
  });
  std::vector<std::size_t> next(questions.size(), 0);
  for (const std::int64_t n : numbers) {
    const std::size_t clerk = clerk_of(n, transport.n_ranks());
    const DealtPoint& point = answers[clerk][next[clerk]++];
    if (point.id < 0)
      throw invalid_connectivity(name + ": a cell refers to node " + std::to_string(n) + ", which does not exist");
    part.vertex_ids.push_back(point.id);
    part.mesh.points.emplace_back(point.place[0], point.place[1], point.place[2]);
  }
  for (const DealtCell& cell : share.cells) {
    part.cell_ids.push_back(cell.id);
    auto& tet = part.mesh.tets.emplace_back();
    for (std::size_t i = 0; i < 4; ++i)
      tet[i] = static_cast<index_t>(std::ranges::lower_bound(numbers, cell.corners[i]) - numbers.begin());
  }
  agree_on_vertices(transport, part, true);
  return {std::move(part), {std::move(labels), std::move(share.names)}};
}

}  // namespace framehex::distributed::detail
