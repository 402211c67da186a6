// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/observer.hpp"

#include <chrono>
#include <limits>

namespace framehex::detail {

/// When to stop: asked often, looks at the clock and at the observer a few times a second.
class Deadline {
public:
  Deadline() = default;
  Deadline(double seconds, const Observer& observer) : seconds_(seconds), observer_(&observer) {}

  /// @return true when the time is up or the observer has cancelled; then always.
  bool passed() {
    if (passed_) return true;
    if (!observer_) return false;
    const Clock::time_point now = Clock::now();
    if (std::chrono::duration<double>(now - start_).count() >= seconds_) return passed_ = true;
    if (now < next_call_) return false;
    next_call_ = now + std::chrono::milliseconds(50);
    if (!keep_going(*observer_, "selection", fraction_)) passed_ = cancelled_ = true;
    return passed_;
  }

  /// An executor that stops when this has passed: what it has made by then is of no use.
  template <Executor E>
  auto watch(const E& executor) {
    return StoppableExecutor(executor, [this] { return passed(); });
  }

  bool cancelled() const { return cancelled_; }
  void set_fraction(double fraction) { fraction_ = fraction < fraction_ ? fraction_ : fraction > 1 ? 1 : fraction; }
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now(), next_call_{};
  double seconds_ = std::numeric_limits<double>::infinity(), fraction_ = 0;
  const Observer* observer_ = nullptr;
  bool passed_ = false, cancelled_ = false;
};

}  // namespace framehex::detail
