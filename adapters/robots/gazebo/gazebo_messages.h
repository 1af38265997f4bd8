// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "models/image.h"
#include "models/imu_sample.h"
#include "models/types.h"
#include "perception/mapping/depth_image.h"

namespace prospect {

/// What is used of Gazebo's messages, as values. Stamps are the simulation's time [s]. All of
/// reading throws std::runtime_error, one line: bytes that are no such message, numbers that are
/// not finite, images whose sizes do not fit their data or whose format is not read.

/// gazebo.msgs.PosesStamped: of a model in W, of a link in its model.
struct GazeboPoses {
  struct Named {
    std::string name;  ///< "robot", "robot::left_wheel"
    Eigen::Vector3d position;
    Eigen::Quaterniond orientation;
  };
  double stamp = 0.0;
  std::vector<Named> poses;

  /// The newest of that name; null: none.
  const Named* find(std::string_view name) const;
};
GazeboPoses read_gazebo_poses(std::string_view message);

/// gazebo.msgs.ImagesStamped of a stereo camera, left first. RGB, BGR and RGBA become grey by the
/// weights 0.299, 0.587, 0.114; grey is taken as it is.
struct GazeboPair {
  double stamp = 0.0;
  ImagePair images;
};
GazeboPair read_gazebo_pair(std::string_view message);

/// Noise of the pixels: Gaussian, added to the grey levels, rounded and cut at 0 and 255; a
/// function of the seed, the stamp, the camera and the pixel (PixelNoise). Without it the images of
/// a robot that stands are one image that came twice. Gazebo's own rests on no seed.
struct GazeboImageNoise {
  double sigma = 0.0;  ///< [grey levels] one standard deviation
  std::uint64_t seed = 1;

  void add(GazeboPair& pair) const;
};

/// gazebo.msgs.ImageStamped of a depth camera: 32-bit floats [m] along the optical axis. What lies
/// outside `range` becomes invalid.
struct GazeboDepth {
  double stamp = 0.0;
  DepthImage image;
};
GazeboDepth read_gazebo_depth(std::string_view message, const DepthRange& range);

/// gazebo.msgs.IMU of a sensor along the axes of B.
ImuSample read_gazebo_imu(std::string_view message);

/// gazebo.msgs.Pose as DiffDrivePlugin takes it for a velocity: x is the speed [m/s], the yaw of
/// the orientation the yaw rate [rad/s], turned round if `turned_yaw`. A yaw rate is cut at 3
/// rad/s, as a yaw beyond pi would be another.
std::string gazebo_velocity(const Twist& velocity, bool turned_yaw);

}  // namespace prospect
