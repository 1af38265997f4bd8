// SPDX-License-Identifier: Apache-2.0
#include "runtime/sensor_frame.h"

#include <type_traits>

namespace prospect {

double stamp_of(const SensorFrame& frame) {
  return std::visit(
      [](const auto& f) {
        if constexpr (std::is_same_v<std::decay_t<decltype(f)>, StereoFrame>) {
          return f.left_stamp;
        } else {
          return f.stamp;
        }
      },
      frame);
}

InputResult feed(PerceptionPipeline& perception, const SensorFrame& frame) {
  return std::visit(
      [&](const auto& f) -> InputResult {
        using Frame = std::decay_t<decltype(f)>;
        if constexpr (std::is_same_v<Frame, StereoFrame>) {
          return perception.stereo({f.left_stamp, f.right_stamp, f.left->view(), f.right->view()});
        } else if constexpr (std::is_same_v<Frame, WheelSample>) {
          return perception.wheels(f);
        } else if constexpr (std::is_same_v<Frame, DepthFrame>) {
          return perception.depth(f.stamp, *f.image, f.sensor);
        } else if constexpr (std::is_same_v<Frame, ScanFrame>) {
          return perception.scan(f.stamp, *f.in_B, f.sensor);
        } else if constexpr (std::is_same_v<Frame, ExternalPose>) {
          return perception.external_pose(f);
        } else if constexpr (std::is_same_v<Frame, Correction>) {
          return perception.correct(f);
        } else if constexpr (std::is_same_v<Frame, ImuSample>) {
          return perception.imu(f);
        } else {
          return {InputState::kRefused, "an estimate; expected images"};
        }
      },
      frame);
}

}  // namespace prospect
