// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>

#include "adapters/robots/gazebo/gazebo_options.h"
#include "models/types.h"

namespace prospect {

/// Where the robot really is, as Gazebo knows it: to measure an estimate against, and for the pose
/// that it starts from. Nothing that drives the robot may ask it.
///
/// Thread-safety: any thread; a thread of its own receives. Errors: the
/// constructor throws as GazeboReceiver does; later nothing throws.
class GazeboTruth {
 public:
  struct Stamped {
    double stamp = 0.0;  ///< [s], the simulation's time
    Pose pose;           ///< of the model in Gazebo's world
  };

  explicit GazeboTruth(const GazeboOptions& options);
  ~GazeboTruth();
  GazeboTruth(GazeboTruth&&) noexcept;

  /// All poses that have come since the call before, oldest first; at most the newest 100 000.
  std::deque<Stamped> take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
