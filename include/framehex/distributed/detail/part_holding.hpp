// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/detail/curve_part.hpp"

namespace framehex::distributed::detail {

using framehex::detail::ExactSum;

/// Who holds which vertices of a mesh along the curve, and how their values reach the ranks that see them.
class RowExchange {
public:
  RowExchange(const MpiTransport& transport, const CurvePart& part) : transport_(transport), part_(part) {
    const auto n_ranks = static_cast<std::size_t>(transport.n_ranks());
    const auto rank = static_cast<std::size_t>(transport.rank());
    first_row_ = part.first_rows[rank];
    n_own_ = static_cast<std::size_t>(part.first_rows[rank + 1] - first_row_);
    order_.resize(part.rows.size());
    std::iota(order_.begin(), order_.end(), index_t{0});
    std::ranges::sort(order_, {}, [&](index_t v) { return std::pair(!is_own(v), part.rows[v]); });
    row_here_.resize(order_.size());
    for (index_t row = 0; row < order_.size(); ++row) row_here_[order_[row]] = row;
    std::vector<std::vector<std::int64_t>> wanted(n_ranks);
    halo_.resize(n_ranks);
    for (std::size_t row = n_own_; row < order_.size(); ++row) {
      const auto owner = static_cast<std::size_t>(part.rank_of(part.rows[order_[row]]));
      halo_[owner].push_back(order_[row]);
      wanted[owner].push_back(part.rows[order_[row]]);
    }
    shown_.resize(n_ranks);
    for (const Parcel& p : transport.exchange(parcels_of(wanted)))
      for (const std::int64_t row : Unpacker(p.bytes).take<std::int64_t>())
        shown_[static_cast<std::size_t>(p.rank)].push_back(order_[static_cast<std::size_t>(row - first_row_)]);
    is_visited_.assign(order_.size(), 0);
  }

  const MpiTransport& transport() const { return transport_; }
  const CurvePart& part() const { return part_; }
  const std::vector<index_t>& order() const { return order_; }
  std::size_t n_own() const { return n_own_; }
  std::int64_t first_row() const { return first_row_; }
  bool is_own(index_t v) const {
    return part_.rows[v] >= first_row_ && part_.rows[v] < first_row_ + static_cast<std::int64_t>(n_own_);
  }

  /// Brings the halo's values up to date. @param place  vertex -> place of its value.
  template <class Value, class Place>
  void refresh(std::span<Value> values, const Place& place) const {
    std::vector<std::vector<Value>> sent(shown_.size());
    for (std::size_t rank = 0; rank < shown_.size(); ++rank)
      for (const index_t v : shown_[rank]) sent[rank].push_back(values[place(v)]);
    for (const Parcel& p : transport_.exchange(parcels_of(sent))) {
      const auto arrived = Unpacker(p.bytes).take<Value>();
      const auto& here = halo_[static_cast<std::size_t>(p.rank)];
      for (std::size_t i = 0; i < here.size(); ++i) values[place(here[i])] = arrived[i];
    }
  }
  template <class Value>
  void refresh_rows(std::vector<Value>& values) const {
    refresh(std::span(values), [&](index_t v) { return row_here_[v]; });
  }

  /// See WholeMesh.
  template <class... Values>
  std::span<const index_t> pass_on(const std::vector<index_t>& visited, std::span<Values>... values) const {
    for (const index_t v : visited) is_visited_[v] = 1;
    std::vector<std::vector<index_t>> places(shown_.size());
    for (std::size_t rank = 0; rank < shown_.size(); ++rank)
      for (index_t i = 0; i < shown_[rank].size(); ++i)
        if (is_visited_[shown_[rank][i]]) places[rank].push_back(i);
    for (const index_t v : visited) is_visited_[v] = 0;
    std::vector<Parcel> parcels;
    for (std::size_t rank = 0; rank < shown_.size(); ++rank) {
      if (places[rank].empty()) continue;
      Parcel& parcel = parcels.emplace_back(Parcel{static_cast<int>(rank), {}});
      pack(parcel.bytes, places[rank]);
      const auto pack_values = [&]<class Value>(std::span<Value> all) {
        std::vector<Value> some;
        for (const index_t i : places[rank]) some.push_back(all[shown_[rank][i]]);
        pack(parcel.bytes, some);
      };
      (pack_values(values), ...);
    }
    arrived_.clear();
    for (const Parcel& p : transport_.exchange(std::move(parcels))) {
      Unpacker in(p.bytes);
      const auto& here = halo_[static_cast<std::size_t>(p.rank)];
      const std::size_t first = arrived_.size();
      for (const index_t i : in.take<index_t>()) arrived_.push_back(here[i]);
      const auto take_values = [&]<class Value>(std::span<Value> all) {
        std::size_t at = first;
        for (const Value& value : in.take<Value>()) all[arrived_[at++]] = value;
      };
      (take_values(values), ...);
    }
    return arrived_;
  }

private:
  const MpiTransport& transport_;
  const CurvePart& part_;
  std::int64_t first_row_ = 0;
  std::size_t n_own_ = 0;
  std::vector<index_t> order_;               ///< row here -> vertex; one's own first
  std::vector<index_t> row_here_;            ///< the other way round
  std::vector<std::vector<index_t>> halo_;   ///< per rank: its vertices that are seen here
  std::vector<std::vector<index_t>> shown_;  ///< per rank: vertices of one's own that are seen there, in its order
  mutable std::vector<std::uint8_t> is_visited_;
  mutable std::vector<index_t> arrived_;
};

/// What the stages of the field ask; see framehex::detail::WholeMesh.
class PartHolding {
public:
  static constexpr bool is_whole = false;

  explicit PartHolding(const RowExchange& exchange) : exchange_(&exchange) {}

  std::vector<index_t> rows(std::span<const Vector3>) const { return exchange_->order(); }
  std::size_t n_own(std::size_t) const { return exchange_->n_own(); }
  std::size_t n_rows(std::size_t) const { return static_cast<std::size_t>(exchange_->part().first_rows.back()); }
  std::size_t first_row() const { return static_cast<std::size_t>(exchange_->first_row()); }
  std::size_t row_of_all(std::size_t row) const {
    return static_cast<std::size_t>(exchange_->part().rows[exchange_->order()[row]]);
  }
  bool is_own(index_t v) const { return exchange_->is_own(v); }
  double unit(std::span<const Vector3>) const { return exchange_->part().unit; }

  template <class Value>
  void refresh_rows(std::vector<Value>& values) const {
    exchange_->refresh_rows(values);
  }
  template <class Value>
  void refresh(std::span<Value> values) const {
    exchange_->refresh(values, [](index_t v) { return v; });
  }
  template <class Value>
  void gather(std::vector<Value>& values) const {
    values = gathered(exchange_->transport(), values);
  }
  double total(ExactSum& sum) const {
    sum.normalize();
    exchange_->transport().sum(sum.digits());
    return sum.value();
  }
  std::int64_t total(std::int64_t count) const { return sum_of(exchange_->transport(), count); }
  double largest(double value) const {
    std::array<double, 1> least{-value};
    exchange_->transport().least(least);
    return -least[0];
  }
  template <class... Values>
  std::span<const index_t> pass_on(const std::vector<index_t>& visited, Values... values) const {
    return exchange_->pass_on(visited, values...);
  }

private:
  const RowExchange* exchange_;
};

}  // namespace framehex::distributed::detail
