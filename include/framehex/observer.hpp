// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string_view>

namespace framehex {

/// How far a long stage has come.
struct Progress {
  std::string_view stage;  ///< name of the stage, a literal
  double fraction;         ///< 0 to 1, never falls within a stage
};

/// Called now and then by every long stage, always on the calling thread, at least every 0.2 s or so. Single passes over a
/// mesh (its validation, its adjacency, its features), of less than a microsecond an entity, are silent.
/// Returns false to cancel: the stage then stops with the status `cancelled`. Empty: no progress, no cancellation.
using Observer = std::function<bool(const Progress&)>;

/// Reports progress. @return false when the stage is to stop.
inline bool keep_going(const Observer& observer, std::string_view stage, double fraction) {
  return !observer || observer(Progress{stage, fraction});
}

/// How a stage ended. Anything but `complete` still comes with the best result so far.
enum class Status { complete, budget_exhausted, cancelled };

namespace detail {

/// What a stage returns that leaves nothing when it is cancelled.
template <class Result>
Result cancelled() {
  Result nothing;
  nothing.status = Status::cancelled;
  return nothing;
}

/// Reports the progress of a stage made of many small steps, and remembers that it was cancelled.
class Pulse {
public:
  Pulse(const Observer& observer, std::string_view stage) : observer_(observer), stage_(stage) {}

  /// Called with every small step; most calls report nothing.
  /// @param fraction  how far the stage has come, 0 to 1; what is less than before counts as no progress.
  /// @return false when the stage is to stop.
  bool beat(double fraction) {
    constexpr std::size_t steps_between = 128;
    return n_steps_++ % steps_between != 0 ? !stopped_ : report(fraction);
  }

  /// A step that does not know how far the stage has come.
  bool beat() { return beat(fraction_); }

  /// The same without leaving any out.
  bool report(double fraction) {
    if (stopped_) return false;
    fraction_ = std::clamp(fraction, fraction_, 1.0);
    stopped_ = !keep_going(observer_, stage_, fraction_);
    return !stopped_;
  }

  bool stopped() const { return stopped_; }
  double fraction() const { return fraction_; }

private:
  const Observer& observer_;
  std::string_view stage_;
  double fraction_ = 0;
  std::size_t n_steps_ = 0;
  bool stopped_ = false;
};

}  // namespace detail

}  // namespace framehex
