// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/recording_pipeline.h"

#include <limits>

namespace prospect {

PerceptionOptions recording_options(const Eigen::Isometry3d& start) {
  PerceptionOptions options;
  options.stereo_mount.T_BC.setIdentity();
  options.wheels = false;
  options.start_in_space = start;
  options.max_leap = std::numeric_limits<double>::infinity();
  return options;
}

MappedFrame map_at(PerceptionPipeline& perception, double stamp, const Eigen::Isometry3d* T_WB,
                   const std::function<InputResult()>& take) {
  InputResult pose{InputState::kTaken, ""};
  if (T_WB) pose = perception.external_pose({.stamp = stamp, .T_WB = *T_WB});
  const InputResult result = pose.state == InputState::kTaken ? take() : pose;
  if (result.state != InputState::kLate && perception.mapped().stamp == stamp) {
    return perception.mapped();
  }
  MappedFrame left_out;
  left_out.stamp = stamp;
  left_out.T_WC = perception.mapped().T_WC;
  left_out.reason = result.reason;
  return left_out;
}

}  // namespace prospect
