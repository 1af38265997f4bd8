#pragma once

#include <memory>

#include "models/camera.h"
#include "models/motion_model.h"
#include "models/robot_shape.h"

namespace prospect {

/// The robot as the planner knows it.
struct RobotDescription {
  std::shared_ptr<const MotionModel> model;
  RobotShape shape = CylinderShape{};
  StereoCamera stereo;
  CameraMount stereo_mount;
  RgbdFootprint depth;
  CameraMount depth_mount;
};

}  // namespace prospect
