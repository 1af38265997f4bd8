// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "adapters/robots/faults/injected_fault.h"
#include "runtime/clock.h"
#include "runtime/mission_observer.h"

namespace prospect {

/// A disk that is stuck or slow as injected faults say: the planner's thread waits at each step, as
/// if it wrote to it.
class FaultyDisk final : public MissionObserver {
 public:
  /// The clock outlives it; the time of the faults begins at `start` [s].
  FaultyDisk(const Clock& clock, std::vector<InjectedFault> faults, double start)
      : clock_(clock), faults_(std::move(faults)), start_(start) {}

  void on_step(const MissionStep&) override {
    const double now = clock_.now(), time = now - start_;
    double wait = 0.0;
    if (const auto* stuck = fault_at(faults_, FaultSource::kDisk, FaultVerb::kStuck, time)) {
      wait = std::min(kLongestThreadSleep, stuck->from + stuck->duration - time);
    } else if (off_at_times(faults_, FaultSource::kDisk, kOnOff, time)) {
      wait = kOnOff;
    } else if (fault_at(faults_, FaultSource::kDisk, FaultVerb::kSlow, time)) {
      wait = kSlowPlanner;
    }
    if (wait > 0.0) clock_.wait_until(now + wait, {});
  }

 private:
  const Clock& clock_;
  const std::vector<InjectedFault> faults_;
  const double start_;
};

}  // namespace prospect
