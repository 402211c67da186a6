// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/selection/detail/clique_cover.hpp"

#include <cmath>

namespace framehex {

/// Upper bound on the weight of every selection, from the linear relaxation over a clique cover:
///
///     max w.x   with   sum of x over each clique <= 1,   0 <= x <= 1.
///
/// By duality, any prices y >= 0 on the cliques bound every selection by
///
///     sum_c y_c + sum_v max(0, w_v - sum of y over v's cliques),
///
/// so the bound is valid after any number of iterations; it is summed in integers and is not subject to rounding.
/// The primal x is fractional and says where a selection is in doubt.
///
/// @par Complexity   One iteration passes twice over the cover, about 2 ns an entry; 20 bytes a clique and 24 a
/// candidate.
/// @par Determinism  Does not depend on the executor.
/// @par Source       Primal-dual hybrid gradient with diagonal steps (Pock, Chambolle, ICCV 2011) and a reflected
///                   Halpern iteration with restarts (Lu, Yang, arXiv 2407.16144).
class LpBound {
public:
  /// @param cover    all conflicts; more cliques make the bound lower.
  /// @param weights  of the candidates, in units; must outlive this.
  /// @param primal, dual  where to start: x a candidate and y a clique, y in units of the largest weight; empty: zero.
  /// @param lent     the cover's cliques of each candidate, where somebody has them who outlives this: the cover's own
  ///                 are then empty until cliques are added.
  LpBound(CliqueCover cover, std::span<const std::int64_t> weights, std::vector<float> primal = {},
          std::vector<float> dual = {}, const Csr<index_t>* lent = nullptr)
      : cover_(std::move(cover)), lent_(lent), weights_(weights), x_(std::move(primal)), y_(std::move(dual)) {
    for (const std::int64_t w : weights) largest_ = std::max(largest_, w);
    x_.resize(weights.size(), 0.0F);
    y_.resize(cover_.size(), 0.0F);
    for (const std::int64_t w : weights) bound_ += w;
    restart_at(x_, y_);
  }

  const CliqueCover& cover() const { return cover_; }
  std::size_t iterations() const { return n_iterations_; }

  /// Lowest bound so far, in units.
  std::int64_t bound() const { return bound_; }

  /// Relaxed selection, 0 to 1 a candidate; holds the cliques only approximately.
  std::span<const float> primal() const { return next_x_; }
  /// Prices of the cliques, relative to the largest weight.
  std::span<const float> dual() const { return next_y_; }

  /// Weight of each candidate less the prices of its cliques, relative to the largest weight. Negative: held back.
  std::vector<float> reduced_weights() const {
    std::vector<float> reduced(weights_.size());
    for (std::size_t v = 0; v < weights_.size(); ++v) {
      reduced[v] = cost(v);
      for (const index_t c : cliques_of(v)) reduced[v] -= next_y_[c];
    }
    return reduced;
  }

  /// Prices that prove a bound: integers, in units / 2^bits.
  struct Prices {
    std::vector<std::int64_t> of_clique;
    std::int64_t total = 0;  ///< the bound they prove
    int bits = 0;
  };

  /// The prices of the last iteration.
  Prices prices() const {
    Prices prices;
    // As fine as leaves room for all sums in 62 bits.
    const double n_terms = static_cast<double>(cover_.size() + weights_.size() + 1);
    prices.bits =
        std::clamp(61 - std::ilogb(static_cast<double>(std::max<std::int64_t>(largest_, 1)) * n_terms), 0, 20);
    const double scale = std::ldexp(static_cast<double>(largest_), prices.bits);
    prices.of_clique.resize(cover_.size());
    for (std::size_t c = 0; c < cover_.size(); ++c)
      prices.total += prices.of_clique[c] = std::llround(std::min(static_cast<double>(next_y_[c]), 1.0) * scale);
    for (std::size_t v = 0; v < weights_.size(); ++v) {
      std::int64_t rest = weights_[v] * (std::int64_t{1} << prices.bits);
      for (const index_t c : cliques_of(v)) rest -= prices.of_clique[c];
      prices.total += std::max<std::int64_t>(rest, 0);
    }
    return prices;
  }

  /// Runs `n` iterations, then updates the bound.
  template <Executor E = SerialExecutor>
  void iterate(std::size_t n, const E& executor = {}) {
    if (largest_ == 0) return;
    for (std::size_t i = 0; i < n; ++i) step(executor);
    const Prices now = prices();
    bound_ = std::min(bound_, now.total >> now.bits);
  }

  /// Appends cliques at price 0 and goes on from the present point.
  void add_cliques(const Csr<index_t>& cliques) {
    for (std::size_t c = 0; c < cliques.size(); ++c) {
      cover_.cliques.values.insert(cover_.cliques.values.end(), cliques[c].begin(), cliques[c].end());
      cover_.cliques.end_row();
    }
    cover_.cliques_of_vertex = detail::transpose(cover_.cliques, weights_.size());
    lent_ = nullptr;
    next_y_.resize(cover_.size(), 0.0F);
    restart_at(std::vector<float>(next_x_), std::vector<float>(next_y_));
  }

private:
  static constexpr std::size_t block_size = 8192;

  std::span<const index_t> cliques_of(std::size_t v) const { return (lent_ ? *lent_ : cover_.cliques_of_vertex)[v]; }

  /// Sums what `body(begin, end)` returns over blocks that do not depend on the number of workers.
  template <Executor E, class Body>
  double sum_over_blocks(std::size_t n, const E& executor, Body&& body) {
    const std::size_t n_blocks = (n + block_size - 1) / block_size;
    partial_.assign(n_blocks, 0.0);
    executor(n_blocks, [&](std::size_t block, std::size_t) {
      partial_[block] = body(block * block_size, std::min(n, (block + 1) * block_size));
    });
    double sum = 0;
    for (const double p : partial_) sum += p;
    return sum;
  }

  /// One step of the operator from (x, y) to (next_x, next_y), then (x, y) to its Halpern point: the reflection of the
  /// step, drawn a little to the anchor.
  template <Executor E>
  void step(const E& executor) {
    const float keep = static_cast<float>(n_inner_ + 1) / static_cast<float>(n_inner_ + 2);
    const double moved_x = sum_over_blocks(x_.size(), executor,
                                           [&](std::size_t begin, std::size_t end) { return step_primal(begin, end); });
    const double moved_y = sum_over_blocks(
        y_.size(), executor, [&](std::size_t begin, std::size_t end) { return step_dual(begin, end, keep); });
    // x is moved last: the dual step reads where it was.
    sum_over_blocks(x_.size(), executor, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) x_[v] = keep * (2 * next_x_[v] - x_[v]) + (1 - keep) * anchor_x_[v];
      return 0.0;
    });
    ++n_iterations_;
    ++n_inner_;
    if (restart_is_due(std::sqrt(moved_x + moved_y))) restart();
  }

  float cost(std::size_t v) const {
    return static_cast<float>(static_cast<double>(weights_[v]) / static_cast<double>(largest_));
  }

  double step_primal(std::size_t begin, std::size_t end) {
    double moved = 0;
    for (std::size_t v = begin; v < end; ++v) {
      const auto row = cliques_of(v);
      float price = 0;
      for (const index_t c : row) price += y_[c];
      const float rate = step_size / (balance_ * static_cast<float>(std::max<std::size_t>(row.size(), 1)));
      next_x_[v] = std::clamp(x_[v] + rate * (cost(v) - price), 0.0F, 1.0F);
      moved += static_cast<double>((next_x_[v] - x_[v]) * (next_x_[v] - x_[v]) / rate);
    }
    return moved;
  }

  double step_dual(std::size_t begin, std::size_t end, float keep) {
    double moved = 0;
    for (std::size_t c = begin; c < end; ++c) {
      const auto row = cover_.cliques[c];
      float use = 0;
      for (const index_t v : row) use += 2 * next_x_[v] - x_[v];
      const float rate = step_size * balance_ / static_cast<float>(std::max<std::size_t>(row.size(), 1));
      next_y_[c] = std::max(0.0F, y_[c] + rate * (use - 1));
      moved += static_cast<double>((next_y_[c] - y_[c]) * (next_y_[c] - y_[c]) / rate);
      y_[c] = keep * (2 * next_y_[c] - y_[c]) + (1 - keep) * anchor_y_[c];
    }
    return moved;
  }

  /// The length of the step says how far the fixed point is: after enough progress, or when it stalls, the anchor
  /// moves.
  bool restart_is_due(double residual) {
    const double before = std::exchange(last_residual_, residual);
    if (n_inner_ == 1) {
      first_residual_ = residual;
      return false;
    }
    return residual < 0.2 * first_residual_ || (residual < 0.8 * first_residual_ && residual > before) ||
           static_cast<double>(n_inner_) > 0.36 * static_cast<double>(n_iterations_);
  }

  /// Moves the anchor here, and balances the steps by how far primal and dual have gone.
  void restart() {
    const auto distance = [](const std::vector<float>& a, const std::vector<float>& b) {
      double sum = 0;
      for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>((a[i] - b[i]) * (a[i] - b[i]));
      return std::sqrt(sum);
    };
    const double far_x = distance(next_x_, anchor_x_), far_y = distance(next_y_, anchor_y_);
    if (far_x > 1e-6 && far_y > 1e-6)
      balance_ = static_cast<float>(std::sqrt(far_y / far_x * static_cast<double>(balance_)));
    restart_at(std::vector<float>(next_x_), std::vector<float>(next_y_));
  }

  void restart_at(std::vector<float> x, std::vector<float> y) {
    x_ = anchor_x_ = next_x_ = std::move(x);
    y_ = anchor_y_ = next_y_ = std::move(y);
    n_inner_ = 0;
  }

  static constexpr float step_size = 0.99F;

  CliqueCover cover_;
  const Csr<index_t>* lent_;
  std::span<const std::int64_t> weights_;
  std::int64_t largest_ = 0, bound_ = 0;
  std::vector<float> x_, y_, next_x_, next_y_, anchor_x_, anchor_y_;
  std::vector<double> partial_;
  float balance_ = 1;  ///< above 1: longer dual, shorter primal steps
  std::size_t n_iterations_ = 0, n_inner_ = 0;
  double first_residual_ = 0, last_residual_ = 0;
};

}  // namespace framehex
