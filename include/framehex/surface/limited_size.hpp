// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/size_field.hpp"
#include "framehex/surface/detail/box_tree.hpp"

#include <cmath>
#include <span>
#include <vector>

namespace framehex {

/// A place where a size field is too large, and the length that is wanted there instead, in the host's unit.
struct SizeLimit {
  Vector3 place;
  double length;
};

/// A size field made smaller near some places: at a distance d of each it is at most the length wanted there + growth * d.
///
/// Without limits it is the size field that it was made of, bit by bit. Const functions are safe from several threads.
/// @par Complexity   O(log n) for n limits of like lengths, besides the evaluation of the size field itself.
template <SizeField Size>
class LimitedSize {
public:
  /// @param size  must outlive this. @param growth  dimensionless, > 0; 0.3 is moderate.
  explicit LimitedSize(const Size& size, double growth = 0.3) : size_(size), growth_(growth) {}
  explicit LimitedSize(const Size&&, double = 0.3) = delete;

  /// In ascending order of lengths.
  const std::vector<SizeLimit>& limits() const { return limits_; }

  /// Adds limits. Those that would lower the size at their place by less than a tenth are left out.
  void add(std::span<const SizeLimit> more) {
    limits_.insert(limits_.end(), more.begin(), more.end());
    std::stable_sort(limits_.begin(), limits_.end(), [](const auto& a, const auto& b) { return a.length < b.length; });
    make_tree();
    std::vector<std::uint8_t> covered(limits_.size(), 0);
    std::vector<SizeLimit> kept;
    for (index_t i = 0; i < limits_.size(); ++i) {
      if (covered[i]) continue;
      kept.push_back(limits_[i]);
      cover(limits_[i], covered);
    }
    limits_ = std::move(kept);
    make_tree();
  }

  double operator()(const Vector3& p) const {
    index_t hint = no_index;
    return sample(p, hint);
  }

  double sample(const Vector3& p, index_t& hint) const {
    const double whole = detail::sampled_size(size_, p, hint);
    return limits_.empty() ? whole : limited(p, whole);
  }

private:
  void make_tree() {
    std::vector<detail::BoxTree::Bounds> boxes(limits_.size(), detail::BoxTree::Bounds::none());
    for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i].add(limits_[i].place);
    tree_ = detail::BoxTree(boxes);
  }

  double at_distance(const SizeLimit& limit, const Vector3& p) const {
    return limit.length + growth_ * (p - limit.place).norm();
  }

  /// Marks the limits that hardly lower the size when `limit` stands.
  void cover(const SizeLimit& limit, std::vector<std::uint8_t>& covered) const {
    constexpr double hardly = 1.1;
    const double reach = (hardly * limits_.back().length - limit.length) / growth_;
    tree_.nearest(limit.place, reach * reach, [&](index_t first, index_t count) {
      for (index_t k = first; k < first + count; ++k) {
        const index_t other = tree_.order()[k];
        if (at_distance(limit, limits_[other].place) <= hardly * limits_[other].length) covered[other] = 1;
      }
      return reach * reach;
    });
  }

  double limited(const Vector3& p, double size) const {
    // No limit farther than this lowers the size any more.
    const auto squared_reach = [&] {
      const double reach = std::max(0.0, (size - limits_.front().length) / growth_);
      return reach * reach;
    };
    tree_.nearest(p, squared_reach(), [&](index_t first, index_t count) {
      for (index_t k = first; k < first + count; ++k) size = std::min(size, at_distance(limits_[tree_.order()[k]], p));
      return squared_reach();
    });
    return size;
  }

  const Size& size_;
  double growth_;
  std::vector<SizeLimit> limits_;  // in ascending order of lengths
  detail::BoxTree tree_;           // of their places
};

}  // namespace framehex
