// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/maps/belief.h"
#include "models/types.h"
#include "runtime/camera_picture.h"

namespace prospect {

class MissionObserver;

/// What a mission drives in lockstep: something that knows its belief, takes velocity commands, and
/// whose time goes on only as they are executed. A simulation, then; other robots are a Robot.
///
/// Thread-safety: called from the mission's thread only. Implementations do not throw; a source
/// that has died is noticed by the age of its beliefs.
class LockstepRobot {
 public:
  virtual ~LockstepRobot() = default;
  /// The newest belief; never null.
  virtual std::shared_ptr<const Belief> sense() = 0;
  /// The newest picture of its cameras; without an image: it has none.
  virtual CameraPicture picture() { return {}; }
  /// Commands a body velocity for `duration` [s] and returns once it has passed.
  virtual void apply(const Twist& command, double duration) = 0;
  /// The robot's clock [s], monotonic; stamps of beliefs are readings of it.
  virtual double time() const = 0;
  /// Why its time does not go on any more; empty: it does. Once told it stays so, and apply() does
  /// nothing.
  virtual std::string fault() const { return {}; }
  /// Why its sensors cannot be trusted; empty: nothing is known against them.
  virtual std::string complaint() const { return {}; }
  /// Who is told of frames as they are measured. They outlive it.
  virtual void watched_by(std::vector<MissionObserver*> /*observers*/) {}
};

}  // namespace prospect
