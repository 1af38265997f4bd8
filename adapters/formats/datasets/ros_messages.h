// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/formats/datasets/raw_image.h"
#include "adapters/formats/datasets/stereo_calibration.h"
#include "models/imu_sample.h"

namespace prospect {

class Elements;

/// Stamp and frame of a message.
struct RosHeader {
  double stamp = 0.0;  ///< [s]; 0: not set
  std::string frame;
};

// Messages of ROS 2 from CDR bytes, little- or big-endian. `name` stands for the message in errors:
// InputError, one line, where the bytes end early or say what cannot be.
RosHeader read_ros_header(std::string_view cdr, const std::string& name);

/// sensor_msgs/msg/Image or, if `compressed`, CompressedImage: grey, colour (rgb8, bgr8, with
/// opacity, yuv422), Bayer patterns as colour, 16 bits and floats.
RawImage read_ros_image(std::string_view cdr, bool compressed, const std::string& name);

/// sensor_msgs/msg/CameraInfo: of the images, its binning and roi applied (of_images()).
CameraInfo read_ros_camera_info(std::string_view cdr, const std::string& name);

/// A pose of one frame in another.
struct RosTransform {
  double stamp = 0.0;  ///< [s]
  std::string parent, child;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();  ///< child to parent
  /// Of x, y, z and the turns about them, in the parent; zero: it is not told.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};
/// tf2_msgs/msg/TFMessage. What is no transform (no pose, a frame without a name) has T =
/// unknown_pose() (trajectory.h), and is counted.
std::vector<RosTransform> read_ros_transforms(std::string_view cdr, const std::string& name,
                                              Elements& transforms);
/// nav_msgs/msg/Odometry, geometry_msgs/msg/PoseStamped or PoseWithCovarianceStamped (both without
/// child) or TransformStamped, by `type`. Refused as not known: a variance of x, y or yaw that is
/// negative or no number, by which filters and trackers say so.
RosTransform read_ros_pose(std::string_view cdr, const std::string& type, const std::string& name);
/// Whether read_ros_pose() reads this type.
bool is_ros_pose(const std::string& type);

/// The velocity of a frame, in it.
struct RosMotion {
  double stamp = 0.0;  ///< [s]
  std::string frame;
  Eigen::Vector3d linear, angular;  ///< [m/s], [rad/s]
};
/// Of nav_msgs/msg/Odometry that of its child frame, of geometry_msgs/msg/TwistStamped or
/// TwistWithCovarianceStamped that of the header's, by `type`. Refused: what is not finite, and
/// variances as of a pose.
RosMotion read_ros_motion(std::string_view cdr, const std::string& type, const std::string& name);

struct RosImu {
  RosHeader header;
  ImuSample sample;  ///< in the header's frame
};
/// sensor_msgs/msg/Imu. Refused: no stamp, what is not finite, and variances of the angular
/// velocity as of a pose.
RosImu read_ros_imu(std::string_view cdr, const std::string& name);

}  // namespace prospect
