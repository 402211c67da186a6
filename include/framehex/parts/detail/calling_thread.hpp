// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"

#include <atomic>
#include <thread>

namespace framehex::detail {

/// An observer for work in many threads: asked on the calling one alone, which tells the others.
class CallingThread {
public:
  explicit CallingThread(const Observer& observer) : observer_(observer) {}

  /// For the parts of a stage. It must not outlive this.
  Observer part(std::string_view stage) {
    return [this, stage](const Progress&) { return go_on(stage, fraction_); };
  }

  bool go_on(std::string_view stage, double fraction) {
    if (std::this_thread::get_id() == caller_ && !stopped_) stopped_ = !keep_going(observer_, stage, fraction);
    return !stopped_;
  }

  void set_fraction(double fraction) { fraction_ = fraction; }
  double fraction() const { return fraction_; }
  bool stopped() const { return stopped_; }

private:
  const Observer& observer_;
  std::thread::id caller_ = std::this_thread::get_id();
  std::atomic<bool> stopped_ = false;
  std::atomic<double> fraction_ = 0;
};

}  // namespace framehex::detail
