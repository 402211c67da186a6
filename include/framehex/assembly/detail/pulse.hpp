// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"

#include <algorithm>

namespace framehex::detail {

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

}  // namespace framehex::detail
