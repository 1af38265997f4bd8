// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>

namespace prospect {

/// How far ahead a planner must plan: what its next step will take, by what the last ones took.
///   L = clamp(longest of the last 20 steps + slack, least, most)
/// A plan that takes longer all the same is late, which CommandLoop answers. A value; one thread.
class PlanningLatency {
 public:
  /// All in [s]; 0 <= least <= most.
  PlanningLatency(double least, double most, double slack)
      : least_(least), most_(most), slack_(slack) {}

  /// What a step took [s], from the choice of its start to its plan's publication.
  void add(double seconds) {
    if (!std::isfinite(seconds)) return;
    steps_.push_back(seconds);
    if (steps_.size() > kSteps) steps_.pop_front();
  }
  double value() const {
    const double longest =
        steps_.empty() ? least_ : *std::max_element(steps_.begin(), steps_.end()) + slack_;
    return std::clamp(longest, least_, most_);
  }

 private:
  static constexpr std::size_t kSteps = 20;
  double least_, most_, slack_;
  std::deque<double> steps_;
};

}  // namespace prospect
