// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/observer.hpp"

#include <algorithm>
#include <string_view>

namespace framehex::detail {

/// What a front needs to know of its stage.
struct FrontCourse {
  std::string_view stage;
  const Observer& observer;
  index_t rounds, sweeps;
  std::size_t max_points;
  double expected;  ///< steps until the queue is empty, about; > 0
};

/// The course of an insertion: points propose neighbours until none is left to propose; then, round after round, the
/// points are relaxed and those that may find new neighbours propose again.
///
/// @param step    callable: lets the next point of the queue propose; false when there was none.
/// @param n_new   callable: how many points there are but the given ones.
/// @param relax   callable: one sweep.
/// @param awaken  callable: puts points that may propose again into the queue.
template <class Step, class Count, class Relax, class Awaken>
Status run_front(const FrontCourse& course, Step&& step, Count&& n_new, Relax&& relax, Awaken&& awaken) {
  constexpr std::size_t steps_per_report = 1024;
  Status status = Status::complete;
  index_t round = 0;
  const auto report = [&](double done) {
    if (keep_going(course.observer, course.stage, (round + done) / (course.rounds + 1.0))) return true;
    status = Status::cancelled;
    return false;
  };
  // Points keep a distance, so that a bounded domain holds finitely many; `max_points` ends it before memory does.
  const auto empty_queue = [&] {
    for (std::size_t n = 0; step(); ++n) {
      if (n_new() > course.max_points) {
        status = Status::budget_exhausted;
        return;
      }
      if (n % steps_per_report == 0 && !report(std::min(static_cast<double>(n) / course.expected, 1.0))) return;
    }
  };
  empty_queue();
  for (round = 1; round <= course.rounds && status == Status::complete; ++round) {
    for (index_t sweep = 0; sweep < course.sweeps && report(0); ++sweep) relax();
    if (status != Status::complete) break;
    awaken();
    empty_queue();
  }
  return status;
}

}  // namespace framehex::detail
