// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "adapters/robots/gazebo/gazebo_messages.h"
#include "adapters/robots/gazebo/gazebo_options.h"
#include "perception/fusion/wheel_fusion.h"

namespace prospect {

/// Encoders of a differential drive: the angles by which its wheels turn against its body, from the
/// poses of the wheels' links in the model. Where the model stands is not looked at, so slip is
/// measured as encoders measure it: not at all.
///
///   forward = r (da_left + da_right) / (2 dt),   yaw_rate = r (da_right - da_left) / (separation
///   dt)
///
/// The angle between two messages is taken the short way round: the wheels may turn by half a turn
/// between them at most. A value; one thread at a time.
class WheelEncoder {
 public:
  explicit WheelEncoder(const GazeboOptions& options);

  /// Of the time since the message before; none: the first, one without the wheels, or one that is
  /// not newer. A time that goes back begins anew.
  std::optional<WheelSample> add(const GazeboPoses& poses);

 private:
  std::string left_name_, right_name_;
  double radius_, separation_;
  bool started_ = false;
  double stamp_ = 0.0;
  Eigen::Quaterniond left_, right_;
};

}  // namespace prospect
