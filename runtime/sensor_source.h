// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>

#include "runtime/frame_sink.h"

namespace prospect {

/// A robot's sensors: what delivers their frames. Implemented by who has them, beside Base.
class SensorSource {
 public:
  virtual ~SensorSource() = default;
  /// Hands over each frame as it comes, on a thread of its own, and returns soon after `stop` is
  /// requested. Stamps are of the source's clock, of capture; those of the same kind are of one
  /// clock. What it throws, and a return before, is told, and the robot stops for want of frames.
  virtual void deliver(FrameSink& frames, const std::stop_token& stop) = 0;
};

}  // namespace prospect
