// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/validation.hpp"
#include "framehex/field/detail/whole_mesh.hpp"

#include <numeric>

namespace framehex::distributed::detail {

using framehex::detail::CurveKey;
using framehex::detail::row_block;

/// A stretch of the whole mesh's vertices along a space-filling curve ("rows"), and all cells round them.
///
/// Vertices and cells stand in the order of their global numbers. Stretches begin at multiples of `row_block`.
struct CurvePart {
  IndexedTetMesh mesh;
  std::vector<std::int64_t> vertex_ids, cell_ids;  ///< ascending
  std::vector<index_t> regions;                    ///< per cell; empty when the mesh has none
  std::vector<std::int64_t> rows;                  ///< per vertex
  std::vector<std::int64_t> first_rows;            ///< per rank, and the number of all at the end
  double unit = 1;                                 ///< see `own_unit`

  int rank_of(std::int64_t row) const {
    return static_cast<int>(std::upper_bound(first_rows.begin(), first_rows.end(), row) - first_rows.begin()) - 1;
  }
  index_t vertex(std::int64_t id) const {
    return static_cast<index_t>(std::lower_bound(vertex_ids.begin(), vertex_ids.end(), id) - vertex_ids.begin());
  }
};

/// Brings a host's part along the curve.
class CurveDistributor {
public:
  /// @param part  of `validated_part`. @param regions  one label a cell, or empty when `has_regions` is false.
  CurveDistributor(const MpiTransport& transport, const IndexedPart& part, std::span<const index_t> regions,
                   bool has_regions)
      : transport_(transport),
        part_(part),
        regions_(regions),
        has_regions_(has_regions),
        n_ranks_(static_cast<std::size_t>(transport.n_ranks())) {}

  CurvePart run() {
    measure();
    find_rows();
    send_cells();
    return std::move(out_);
  }

  /// After `run`: the row of each of the host's vertices.
  const std::vector<std::int64_t>& rows() const { return rows_; }

private:
  struct Place {
    std::uint64_t key;
    std::int64_t id;
    auto operator<=>(const Place&) const = default;
  };
  struct PlacedVertex {
    std::int64_t id, row;
    std::array<double, 3> point;
  };
  struct PlacedCell {
    std::int64_t id;
    std::array<index_t, 4> vertices;  ///< among those sent with it
    index_t region;
  };

  static std::array<double, 3> flat(const Vector3& p) { return {p.x(), p.y(), p.z()}; }
  static Vector3 vector(const std::array<double, 3>& p) { return {p[0], p[1], p[2]}; }
  bool owns(std::size_t v) const { return part_.owners[v] == transport_.rank(); }

  /// The box of all points, and their unit: that of their distances from the one of the least number.
  void measure() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    box_.fill(infinity);
    for (const Vector3& p : part_.mesh.points)
      for (std::size_t i = 0; i < 3; ++i) {
        const double x = p[static_cast<int>(i)];
        box_[i] = std::min(box_[i], x);
        box_[3 + i] = std::min(box_[3 + i], -x);
      }
    transport_.least(box_);
    std::vector<PlacedVertex> first;
    for (std::size_t v = 0; v < part_.vertex_ids.size(); ++v)
      if (first.empty() || part_.vertex_ids[v] < first[0].id)
        first.assign(1, {part_.vertex_ids[v], 0, flat(part_.mesh.points[v])});
    first = gathered(transport_, first);
    if (first.empty()) return;
    const auto least = std::min_element(first.begin(), first.end(),
                                        [](const PlacedVertex& a, const PlacedVertex& b) { return a.id < b.id; });
    const Vector3 origin = vector(least->point);
    std::array<double, 1> extent{0};
    for (const Vector3& p : part_.mesh.points) extent[0] = std::min(extent[0], -(p - origin).cwiseAbs().maxCoeff());
    transport_.least(extent);
    out_.unit = framehex::detail::own_unit(-extent[0]);
  }

  void find_rows() {
    std::vector<std::size_t> own;
    std::vector<Place> places(part_.vertex_ids.size());
    const CurveKey key_of({box_[0], box_[1], box_[2]}, {-box_[3], -box_[4], -box_[5]});
    for (std::size_t v = 0; v < places.size(); ++v) {
      if (!owns(v)) continue;
      places[v] = {key_of(part_.mesh.points[v]), part_.vertex_ids[v]};
      own.push_back(v);
    }
    std::sort(own.begin(), own.end(), [&](std::size_t v, std::size_t w) { return places[v] < places[w]; });
    std::vector<Place> sorted;
    for (const std::size_t v : own) sorted.push_back(places[v]);
    const std::vector<Place> splitters = split(sorted);

    // Own vertices to the rank of their stretch, which numbers them.
    struct Sent {
      Place place;
      std::array<double, 3> point;
    };
    std::vector<std::vector<Sent>> by_rank(n_ranks_);
    for (const std::size_t v : own) {
      const auto after = std::upper_bound(splitters.begin(), splitters.end(), places[v]);
      by_rank[static_cast<std::size_t>(after - splitters.begin())].push_back({places[v], flat(part_.mesh.points[v])});
    }
    std::vector<Sent> stretch = send_joined(transport_, by_rank);
    std::sort(stretch.begin(), stretch.end(), [](const Sent& a, const Sent& b) { return a.place < b.place; });
    const std::int64_t first_row = out_.first_rows[static_cast<std::size_t>(transport_.rank())];
    for (std::size_t i = 0; i < stretch.size(); ++i)
      vertices_.push_back({stretch[i].place.id, first_row + static_cast<std::int64_t>(i), stretch[i].point});

    std::vector<std::vector<Place>> questions(n_ranks_);
    for (std::size_t rank = 0; rank < n_ranks_; ++rank)
      for (const Sent& s : by_rank[rank]) questions[rank].push_back(s.place);
    const auto own_rows = ask<std::int64_t>(transport_, questions, [&](const Place& place, int) {
      return first_row + (std::ranges::lower_bound(stretch, place, {}, &Sent::place) - stretch.begin());
    });
    rows_.assign(places.size(), 0);
    std::vector<std::size_t> next(n_ranks_, 0);
    for (const std::size_t v : own) {
      const auto after = std::upper_bound(splitters.begin(), splitters.end(), places[v]);
      const auto rank = static_cast<std::size_t>(after - splitters.begin());
      rows_[v] = own_rows[rank][next[rank]++];
    }
    ask_owners();
  }

  /// Rows of the vertices of other owners.
  void ask_owners() {
    std::vector<std::size_t> own;
    for (std::size_t v = 0; v < rows_.size(); ++v)
      if (owns(v)) own.push_back(v);
    const auto id_of = [&](std::size_t v) { return part_.vertex_ids[v]; };
    std::ranges::sort(own, {}, id_of);
    std::vector<std::vector<std::int64_t>> questions(n_ranks_);
    for (std::size_t v = 0; v < rows_.size(); ++v)
      if (!owns(v)) questions[static_cast<std::size_t>(part_.owners[v])].push_back(part_.vertex_ids[v]);
    const auto answers = ask<std::int64_t>(transport_, questions, [&](std::int64_t id, int) {
      return rows_[*std::ranges::lower_bound(own, id, {}, id_of)];
    });
    std::vector<std::size_t> next(n_ranks_, 0);
    for (std::size_t v = 0; v < rows_.size(); ++v) {
      const auto rank = static_cast<std::size_t>(part_.owners[v]);
      if (!owns(v)) rows_[v] = answers[rank][next[rank]++];
    }
  }

  /// The first places of all stretches but the first rank's: found bit by bit, by counting what lies before.
  std::vector<Place> split(const std::vector<Place>& sorted) {
    const std::int64_t n = sum_of(transport_, static_cast<std::int64_t>(sorted.size()));
    constexpr auto block = static_cast<std::int64_t>(row_block);
    const std::int64_t n_blocks = (n + block - 1) / block;
    for (std::int64_t rank = 0; rank <= transport_.n_ranks(); ++rank)
      out_.first_rows.push_back(std::min(n, block * (rank * n_blocks / transport_.n_ranks())));
    std::vector<Place> splitters(n_ranks_ - 1, Place{0, 0});
    std::vector<std::int64_t> before(splitters.size());
    for (int bit = 2 * 63 - 1; bit >= 0; --bit) {
      const auto with_bit = [&](Place place) {
        if (bit >= 63)
          place.key |= std::uint64_t{1} << (bit - 63);
        else
          place.id |= std::int64_t{1} << bit;
        return place;
      };
      for (std::size_t i = 0; i < splitters.size(); ++i)
        before[i] = std::lower_bound(sorted.begin(), sorted.end(), with_bit(splitters[i])) - sorted.begin();
      transport_.sum(before);
      for (std::size_t i = 0; i < splitters.size(); ++i)
        if (before[i] <= out_.first_rows[i + 1]) splitters[i] = with_bit(splitters[i]);
    }
    return splitters;
  }

  /// Each cell to all ranks that have a vertex of it.
  void send_cells() {
    std::vector<std::vector<PlacedVertex>> vertices(n_ranks_);
    std::vector<std::vector<PlacedCell>> cells(n_ranks_);
    std::vector<std::vector<index_t>> taking(n_ranks_);
    for (index_t c = 0; c < part_.mesh.tets.size(); ++c) {
      std::array<int, 4> ranks{};
      for (std::size_t i = 0; i < 4; ++i) ranks[i] = out_.rank_of(rows_[part_.mesh.tets[c][i]]);
      std::sort(ranks.begin(), ranks.end());
      const auto end = std::unique(ranks.begin(), ranks.end());
      for (auto rank = ranks.begin(); rank != end; ++rank) taking[static_cast<std::size_t>(*rank)].push_back(c);
    }
    std::vector<index_t> number(part_.mesh.points.size(), no_index);
    for (std::size_t rank = 0; rank < n_ranks_; ++rank) {
      for (const index_t c : taking[rank]) {
        PlacedCell cell{part_.cell_ids[c], part_.mesh.tets[c], has_regions_ ? regions_[c] : 0};
        for (index_t& v : cell.vertices) {
          if (number[v] == no_index) {
            number[v] = static_cast<index_t>(vertices[rank].size());
            vertices[rank].push_back({part_.vertex_ids[v], rows_[v], flat(part_.mesh.points[v])});
          }
          v = number[v];
        }
        cells[rank].push_back(cell);
      }
      for (const index_t c : taking[rank])
        for (const index_t v : part_.mesh.tets[c]) number[v] = no_index;
    }
    join(transport_.exchange(parcels_of(vertices, cells)));
  }

  void join(const std::vector<Parcel>& arrived) {
    struct Cell {
      std::int64_t id;
      std::array<std::int64_t, 4> vertices;
      index_t region;
    };
    std::vector<Cell> cells;
    std::vector<PlacedVertex> vertices =
        std::move(vertices_);  // of one's own; those without a cell come from nowhere else
    for (const Parcel& p : arrived) {
      Unpacker in(p.bytes);
      const auto sent_vertices = in.take<PlacedVertex>();
      const auto sent_cells = in.take<PlacedCell>();
      vertices.insert(vertices.end(), sent_vertices.begin(), sent_vertices.end());
      for (const PlacedCell& c : sent_cells) {
        Cell& cell = cells.emplace_back(Cell{c.id, {}, c.region});
        for (std::size_t i = 0; i < 4; ++i) cell.vertices[i] = sent_vertices[c.vertices[i]].id;
      }
    }
    std::ranges::sort(vertices, {}, &PlacedVertex::id);
    const auto repeated = std::ranges::unique(vertices, {}, &PlacedVertex::id);
    vertices.erase(repeated.begin(), repeated.end());
    std::ranges::sort(cells, {}, &Cell::id);
    for (const PlacedVertex& v : vertices) {
      out_.vertex_ids.push_back(v.id);
      out_.rows.push_back(v.row);
      out_.mesh.points.push_back(vector(v.point));
    }
    for (const Cell& cell : cells) {
      out_.cell_ids.push_back(cell.id);
      if (has_regions_) out_.regions.push_back(cell.region);
      auto& tet = out_.mesh.tets.emplace_back();
      for (std::size_t i = 0; i < 4; ++i) tet[i] = out_.vertex(cell.vertices[i]);
    }
  }

  const MpiTransport& transport_;
  const IndexedPart& part_;
  std::span<const index_t> regions_;
  bool has_regions_;
  std::size_t n_ranks_;
  std::array<double, 6> box_{};  ///< least coordinates, and least of their opposites
  std::vector<std::int64_t> rows_;
  std::vector<PlacedVertex> vertices_;  ///< of the stretch
  CurvePart out_;
};

}  // namespace framehex::distributed::detail
