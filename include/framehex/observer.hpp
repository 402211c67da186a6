// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <functional>
#include <string_view>

namespace framehex {

/// How far a long stage has come.
struct Progress {
  std::string_view stage;  ///< name of the stage, a literal
  double fraction;         ///< 0 to 1, never falls within a stage
};

/// Called now and then by every long stage, always on the calling thread, at least every 0.2 s or so.
/// Returns false to cancel: the stage then stops with the status `cancelled`. Empty: no progress, no cancellation.
using Observer = std::function<bool(const Progress&)>;

/// Reports progress. @return false when the stage is to stop.
inline bool keep_going(const Observer& observer, std::string_view stage, double fraction) {
  return !observer || observer(Progress{stage, fraction});
}

/// How a stage ended. Anything but `complete` still comes with the best result so far.
enum class Status { complete, budget_exhausted, cancelled };

}  // namespace framehex
