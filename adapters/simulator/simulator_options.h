#pragma once

#include <cstdint>

#include "adapters/simulator/depth_camera.h"
#include "adapters/simulator/feature_camera.h"
#include "adapters/simulator/kinematic_robot.h"
#include "adapters/simulator/landmark_builder.h"
#include "adapters/simulator/odometry_model.h"
#include "models/camera.h"
#include "models/robot_shape.h"
#include "perception/occupancy_mapper.h"

namespace prospect {

/// Everything a simulated mission depends on besides its world and the commands.
struct SimulatorOptions {
  std::uint64_t seed = 1;

  RobotShape shape = CylinderShape{};
  ActuationNoise actuation;  ///< none by default: commands are executed exactly

  CameraMount depth_mount;
  DepthCameraOptions depth;
  double depth_rate = 5.0;  ///< [Hz]

  CameraMount stereo_mount;
  FeatureCameraOptions features;
  double image_rate = 10.0;  ///< [Hz]: tracking of features; keyframes are taken among these images

  OdometryOptions odometry;
  LandmarkBuilderOptions landmarks;
  /// slice is set from the shape's vertical extent, max_range from the depth camera.
  OccupancyMapperOptions mapping;
};

}  // namespace prospect
