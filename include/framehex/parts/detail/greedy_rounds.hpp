// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/detail/candidate_states.hpp"
#include "framehex/selection/detail/occupancy.hpp"

#include <cmath>

namespace framehex::detail {

/// Classes of weights: rising by falling weight, the same for equal weights on all ranks.
class WeightClasses {
public:
  static constexpr std::size_t size = 2048;

  explicit WeightClasses(double heaviest) { std::frexp(heaviest, &exponent_); }

  std::uint16_t of(double weight) const {
    int exponent = 0;
    const double mantissa = std::frexp(weight, &exponent);  // 0.5 to 1
    const auto below = static_cast<std::size_t>(exponent_ - exponent) * n_steps +
                       static_cast<std::size_t>((1 - mantissa) * (2 * n_steps));
    return static_cast<std::uint16_t>(weight > 0 ? std::min(below, size - 1) : size - 1);
  }

private:
  static constexpr std::size_t n_steps = 32;  ///< a factor of two
  int exponent_ = 0;
};

/// Takes what fits of all ranks' candidates together, by falling weight, in rounds.
///
/// In a round a rank decides its candidates in order; one that a heavier undecided one keeps out waits, as do those that it
/// keeps out in turn. Then the states of those that others have copies of are exchanged. The heaviest undecided one of all
/// never waits, so this ends, and who is taken does not depend on who holds what.
///
/// Rounds are for one class of weights after another. Other ranks are told of a candidate when its turn has come and
/// nothing that was taken before keeps it out: few are left then.
template <Transport Tr>
class GreedyRounds {
public:
  using States = CandidateStates<Tr>;

  /// @param states  what is taken stays, and so does what is refused. Collective.
  GreedyRounds(const Tr& transport, CandidatePool& pool, BorderExchange<Tr>& border, States& states)
      : transport_(transport),
        pool_(pool),
        border_(border),
        states_(states),
        classes_(heaviest_of_all()),
        taken_(pool.candidates, pool.patch->mesh.tets.size()) {
    for (index_t v = 0; v < pool_.size(); ++v)
      if (states_[v] == States::taken)
        taken_.add(v);
      else if (states_[v] == States::undecided)
        later_.push_back(v);
  }

  /// Collective. @param stop  asked now and then on this rank; @return false when one of them said so.
  template <class Stop>
  bool run(Stop&& stop) {
    for (bool is_last = false; !is_last;) {
      drop_blocked(later_);
      const std::size_t last_class = find_last_class();
      is_last = last_class + 1 == WeightClasses::size;
      open(last_class);
      if (!run_rounds(stop)) return false;
    }
    return true;
  }

  std::size_t n_rounds() const { return n_rounds_; }

private:
  /// Of the candidates at borders that are left, the share that is told of at a time, and how many are worth it.
  static constexpr std::int64_t shares = 8, least_share = 1000;

  double heaviest_of_all() const {
    std::array<double, 1> heaviest{0};
    for (const double w : pool_.weights) heaviest[0] = std::min(heaviest[0], -w);
    transport_.least(std::span<double>(heaviest));
    return -heaviest[0];
  }

  /// The class up to which candidates are decided next; the last one when none at a border is lighter. Collective.
  std::size_t find_last_class() const {
    constexpr std::size_t all = WeightClasses::size - 1;
    if (transport_.n_ranks() == 1) return all;
    std::vector<std::int64_t> counts(WeightClasses::size, 0);
    for (const index_t v : later_)
      if (v < pool_.n_own && border_.is_at_border(v)) ++counts[classes_.of(pool_.weights[v])];
    transport_.sum(std::span<std::int64_t>(counts));
    std::int64_t left = 0, so_far = 0;
    for (const std::int64_t n : counts) left += n;
    for (std::size_t c = 0; c < all; ++c) {
      so_far += counts[c];
      if (so_far == left) return all;
      if (so_far >= std::max(left / shares, least_share)) return c;
    }
    return all;
  }

  /// Makes candidates of the classes up to one those that are decided on, and tells others of them. Collective.
  void open(std::size_t last_class) {
    const auto rest = std::partition(later_.begin(), later_.end(), [&](index_t v) {
      return last_class + 1 == WeightClasses::size || classes_.of(pool_.weights[v]) <= last_class;
    });
    open_.assign(later_.begin(), rest);
    later_.erase(later_.begin(), rest);
    std::vector<index_t> own;
    for (const index_t v : open_)
      if (v < pool_.n_own && border_.is_at_border(v)) own.push_back(v);
    const auto n_before = static_cast<index_t>(pool_.size());
    border_.tell(own);
    states_.grow();
    for (index_t v = n_before; v < pool_.size(); ++v) open_.push_back(v);
  }

  template <class Stop>
  bool run_rounds(Stop&& stop) {
    for (;; ++n_rounds_) {
      decide(stop);
      std::array<std::int64_t, 2> sums{0, stop() ? 1 : 0};
      for (const index_t v : open_) sums[0] += v < pool_.n_own ? 1 : 0;
      transport_.sum(std::span<std::int64_t>(sums));
      if (sums[1] > 0) return false;
      for (const index_t v : states_.exchange())
        if (states_[v] == States::taken) taken_.add(v);
      std::erase_if(open_, [this](index_t v) { return states_[v] != States::undecided; });
      if (sums[0] == 0) return true;
    }
  }

  template <class Stop>
  void decide(Stop&& stop) {
    constexpr std::size_t n_at_once = 4096;
    CandidateOccupancy waiting(pool_.candidates, pool_.patch->mesh.tets.size());
    std::vector<index_t> left;
    const auto before = [this](index_t u, index_t v) { return pool_.is_before(u, v); };
    // Block by block: the heaviest block most others, which then need not be put in order.
    while (!open_.empty() && !stop()) {
      const auto end =
          open_.begin() + static_cast<std::ptrdiff_t>(std::min(open_.size(), std::max(open_.size() / 8, n_at_once)));
      if (end != open_.end()) std::nth_element(open_.begin(), end, open_.end(), before);
      std::sort(open_.begin(), end, before);
      for (auto v = open_.begin(); v != end; ++v) {
        if (taken_.blocks(*v)) {
          states_.set(*v, States::refused);
        } else if (*v >= pool_.n_own || waiting.blocks(*v)) {
          waiting.add(*v);
          left.push_back(*v);
        } else {
          states_.set(*v, States::taken);
          taken_.add(*v);
        }
      }
      open_.erase(open_.begin(), end);
      drop_blocked(open_);
    }
    open_.insert(open_.end(), left.begin(), left.end());
  }

  void drop_blocked(std::vector<index_t>& list) {
    std::erase_if(list, [this](index_t v) {
      const bool blocked = taken_.blocks(v);
      if (blocked) states_.set(v, States::refused);
      return blocked;
    });
  }

  const Tr& transport_;
  CandidatePool& pool_;
  BorderExchange<Tr>& border_;
  States& states_;
  WeightClasses classes_;
  CandidateOccupancy taken_;
  std::vector<index_t> later_, open_;
  std::size_t n_rounds_ = 0;
};

}  // namespace framehex::detail
