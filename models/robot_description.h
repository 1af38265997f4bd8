// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "models/camera.h"
#include "models/motion_model.h"
#include "models/robot_shape.h"

namespace prospect {

/// A depth sensor: what it can see, and where it sits on the robot.
struct DepthSensor {
  RgbdFootprint footprint;
  CameraMount mount;
};

/// Depth sensors that a robot may have.
inline constexpr int kMostDepthSensors = 16;

/// The robot as the planner knows it.
///
/// Heights. W's z axis points up and z = 0 is the floor. B's origin of a planar base stands at z =
/// fixed_z of its model (PoseLayout), everywhere; shape and mounts are given in B. So one rule says
/// which heights the body sweeps, and planner, guard, simulator and maps all ask slice() for it.
struct RobotDescription {
  std::shared_ptr<const MotionModel> model;
  RobotShape shape = CylinderShape{};
  StereoCamera stereo;
  CameraMount stereo_mount;
  RgbdFootprint depth;
  CameraMount depth_mount;
  /// Depth sensors besides that one. Sensor 0 is the one above, sensor n is more_depth[n - 1]; what
  /// any of them sees is seen.
  std::vector<DepthSensor> more_depth{};

  std::vector<DepthSensor> depth_sensors() const {
    std::vector<DepthSensor> all{{depth, depth_mount}};
    all.insert(all.end(), more_depth.begin(), more_depth.end());
    return all;
  }
  /// Height of B's origin above the floor [m]: fixed_z; 0 for a base that moves in 3-D.
  double base_height() const { return model->pose_layout().fixed_z; }
  /// The heights in W that the body of a planar base sweeps [m]: its vertical extent in B, raised
  /// by base_height(). Of a base that moves in 3-D, those of its body when B's origin is at z = 0.
  /// Throws std::invalid_argument for an invalid shape. The model is non-null, here and above.
  VerticalExtent slice() const { return body_slice(shape, base_height()); }
};

}  // namespace prospect
