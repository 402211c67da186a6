// SPDX-License-Identifier: BSL-1.0
// Progress on the terminal, and what Ctrl-C does.
#pragma once

#include "framehex/observer.hpp"

#include <string>
#include <vector>

namespace program {

/// Turns Ctrl-C (and a polite kill) into cancellation.
///
/// The stages hear of it when they next ask their observer. Where one does not ask in time the process ends on its own
/// after most of a second; temporary files of this process are removed first.
class Interruption {
public:
  /// @param outputs  the files that may be under way.
  explicit Interruption(std::vector<std::string> outputs);
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  ~Interruption();

  bool requested() const;

private:
  struct Watch;
  Watch* watch_;
};

/// Observer of a run: cancels it when interrupted, and draws a bar when `visible` and standard error is a terminal.
framehex::Observer make_observer(const Interruption& interruption, bool visible);

/// Wipes the bar off the line.
void end_progress();

}  // namespace program
