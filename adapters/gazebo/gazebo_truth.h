#pragma once

#include <memory>
#include <vector>

#include "adapters/gazebo/gazebo_options.h"
#include "models/types.h"

namespace prospect {

/// Where the robot really is, as Gazebo knows it: to measure an estimate against, and for the pose
/// that it starts from. Nothing that drives the robot may ask it.
///
/// Thread-safety: any thread; a thread of its own receives. Errors: as GazeboSensors.
class GazeboTruth {
 public:
  struct Stamped {
    double stamp = 0.0;    ///< [s], the simulation's time
    double arrival = 0.0;  ///< [s], of SteadyClock
    Pose pose;             ///< of the model in Gazebo's world
  };

  explicit GazeboTruth(const GazeboOptions& options);
  ~GazeboTruth();
  GazeboTruth(const GazeboTruth&) = delete;
  GazeboTruth& operator=(const GazeboTruth&) = delete;

  /// All poses that have come since the call before, oldest first; at most the newest 100 000.
  std::vector<Stamped> take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
