#pragma once

#include <memory>

#include "engine/maps/belief.h"
#include "models/types.h"

namespace prospect {

/// What a mission drives: something that knows its belief and takes velocity commands. Implemented
/// by the simulator and by motor adapters.
///
/// Thread-safety: called from the mission's thread only. Implementations do not throw; a source
/// that has died is noticed by the age of its beliefs.
class Robot {
 public:
  virtual ~Robot() = default;
  /// The newest belief; never null.
  virtual std::shared_ptr<const Belief> sense() = 0;
  /// Commands a body velocity for `duration` [s] and returns once it has passed.
  virtual void apply(const Twist& command, double duration) = 0;
  /// The robot's clock [s], monotonic; stamps of beliefs are readings of it.
  virtual double time() const = 0;
};

}  // namespace prospect
