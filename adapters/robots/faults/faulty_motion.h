// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "adapters/robots/faults/injected_fault.h"
#include "models/types.h"

namespace prospect {

/// A base that moves otherwise than it is told (the faults of FaultSource::kBase), as the command
/// that one which moves as it is told would need for the same.
class FaultyMotion {
 public:
  explicit FaultyMotion(std::vector<InjectedFault> faults) : faults_(std::move(faults)) {}

  /// time: [s] since the start of the faults.
  Twist made_of(const Twist& command, double time) {
    const auto has = [&](FaultVerb verb) {
      return fault_at(faults_, FaultSource::kBase, verb, time) != nullptr;
    };
    Twist moved = command;
    if (has(FaultVerb::kInverted)) moved.linear = -moved.linear;
    if (has(FaultVerb::kMirrored)) moved.yaw_rate = -moved.yaw_rate;
    if (has(FaultVerb::kDouble)) {
      moved.linear *= 2.0;
      moved.yaw_rate *= 2.0;
    }
    if (has(FaultVerb::kIgnores)) moved = {};
    if (has(FaultVerb::kOneWheel)) {
      const double right = moved.linear.x() + 0.5 * kFaultyTrack * moved.yaw_rate;
      moved = {{0.5 * right, 0.0, 0.0}, right / kFaultyTrack};
    }
    const bool moves = !command.linear.isZero(0.0) || command.yaw_rate != 0.0;
    runs_away_ = has(FaultVerb::kRunaway) && (runs_away_ || moves);
    if (runs_away_) moved.linear.x() += kRunaway;
    return moved;
  }
  /// Base::stop() ends what runs away, until it is told to move again.
  void stop() { runs_away_ = false; }

 private:
  std::vector<InjectedFault> faults_;
  bool runs_away_ = false;
};

}  // namespace prospect
