#pragma once

#include <functional>

#include "models/image.h"
#include "perception/fusion/wheel_fusion.h"
#include "perception/mapping/depth_image.h"
#include "perception/mapping/occupancy_mapper.h"

namespace prospect {

/// Who listens to what simulated sensors deliver, such as a log. Each may be empty; none may throw.
/// Called on the thread that the sensors are used on, with the simulator's time [s].
struct SensorTap {
  std::function<void(double stamp, const DepthScan& in_B)> scan;
  std::function<void(double stamp, const ImagePair& pair)> pair;
  std::function<void(double stamp, const DepthImage& depth)> depth;
  std::function<void(const WheelSample& wheels)> wheels;
};

}  // namespace prospect
