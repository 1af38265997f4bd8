// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "runtime/sensor_frame.h"

namespace prospect {

/// Takes what a robot's sensors deliver: an inbox, what stands before it, or who listens.
/// Thread-safety: as who implements it says. Does not throw, but for want of memory.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  /// Stamps are of the source's clock.
  virtual void observe(const SensorFrame& frame) = 0;
};

}  // namespace prospect
