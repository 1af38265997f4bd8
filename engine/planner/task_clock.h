// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include "engine/behaviour/task_kind.h"

namespace prospect {

/// Since when the robot has its task, and for how long it has had others than to explore, which is
/// time that does not count for frontiers.
///
/// A value: one a planner. Thread-safety: none. Never throws.
class TaskClock {
 public:
  /// Another task from the next update() on.
  void restart() { restarted_ = true; }

  /// At each step: its stamp [s] and the task in force.
  void update(double stamp, TaskKind task) {
    if (restarted_) given_at_ = stamp;
    restarted_ = false;
    if (task != TaskKind::kExplore && last_) away_ += std::max(0.0, stamp - *last_);
    last_ = stamp;
  }

  /// [s] stamp of the first step with a task that another one preceded; -infinity: with none.
  double given_at() const { return given_at_; }
  /// [s] spent on other tasks than to explore.
  double away() const { return away_; }

 private:
  bool restarted_ = false;
  double given_at_ = -std::numeric_limits<double>::infinity();
  std::optional<double> last_;
  double away_ = 0.0;
};

}  // namespace prospect
