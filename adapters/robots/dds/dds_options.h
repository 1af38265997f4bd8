// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/ros_arguments.h"
#include "runtime/base.h"
#include "runtime/emergency_stop.h"

namespace prospect {

/// A robot that is reached over ROS 2: its topics, frames and what its base is known to do. The
/// file's keys are described in docs/reference/dds.md. A topic that is empty is not used.
struct DdsOptions {
  DdsAddress address;
  double timeout = 10.0;  ///< [s] to wait for calibrations and transforms
  std::string tf = "/tf", tf_static = "/tf_static";
  bool use_sim_time = false;     ///< time is that of a simulation, which the next topic tells
  std::string clock = "/clock";  ///< rosgraph_msgs/msg/Clock

  struct Frames {
    std::string map = "map";         ///< the map's; W's, until it is corrected (correction.h)
    std::string odom = "odom";       ///< of the base's odometry
    std::string base = "base_link";  ///< B
  } frames;

  /// Who says where the robot is.
  enum class PoseSource {
    kStereo,  ///< its stereo pair
    kWheels,  ///< its odometry alone: dead reckoning from where it begins
    kTf,      ///< whoever tells tf where frames.base is in frames.map: AMCL, SLAM
    kTopic    ///< a topic of poses in frames.map: motion capture, say
  };
  struct PoseTopic {
    std::string topic;
    std::string type = "geometry_msgs/msg/PoseWithCovarianceStamped";
    std::string frame;  ///< whose pose it is: frames.base, or what tf knows to be fixed to it
    /// Standard deviations [m], [rad] where no covariance is told.
    double sigma = 0.05, sigma_yaw = 0.02;
  };
  PoseSource pose_source = PoseSource::kStereo;
  PoseTopic pose;
  bool has_stereo() const { return pose_source == PoseSource::kStereo; }
  /// Whether something else localizes it.
  bool is_told_its_pose() const {
    return pose_source == PoseSource::kTf || pose_source == PoseSource::kTopic;
  }

  /// Of a robot that localizes itself by it; else its topics are empty.
  struct Stereo {
    std::string left = "/left/image_rect", left_info = "/left/camera_info";
    std::string right = "/right/image_rect", right_info = "/right/camera_info";
    bool compressed = false;  ///< sensor_msgs/msg/CompressedImage
    bool rectified = true;    ///< by P of camera_info; else K, D, R and P rectify
  } stereo;
  struct Depth {
    std::string image = "/depth/image_rect_raw", info = "/depth/camera_info";
    bool compressed = false;  ///< by compressed_depth_image_transport, as PNG
    bool rectified = true;  ///< by P and R of camera_info; else by K, of a lens without distortion
    double per_metre = 1000.0;                ///< of images of 16 bits; those of floats are metres
    double min_range = 0.3, max_range = 8.0;  ///< [m]
  } depth;
  std::string scan, point_cloud;
  /// Of the depth sensors besides, RobotDescription::more_depth in its order, each a depth image, a
  /// scan or a cloud.
  struct MoreDepth {
    Depth depth{"", ""};
    std::string scan, point_cloud;
  };
  std::vector<MoreDepth> more_depth;
  std::string imu;  ///< sensor_msgs/msg/Imu, of frames.base or a frame that tf fixes to it
  /// Whether its topics tell what its range sensor has in view; a cloud of points does not.
  bool tells_view() const { return !depth.image.empty() || !scan.empty(); }
  /// Cameras are where tf says, in frames.base; else where the robot's description says.
  bool mounts_from_tf = false;

  /// Its velocity; the pose only for transforms. Empty: who is told its pose knows its velocity
  /// from that.
  std::string odometry = "/odom";
  /// nav_msgs/msg/Odometry; or a stamped twist, by which the pose in frames.odom adds up.
  std::string odometry_type = "nav_msgs/msg/Odometry";
  bool tells_odometry_pose() const {
    return !odometry.empty() && odometry_type == "nav_msgs/msg/Odometry";
  }
  /// Its frame (child_frame_id; of a twist frame_id) may be one that tf knows to be fixed to
  /// frames.base; else it is that.
  bool odometry_by_tf = false;
  std::string emergency_stop;  ///< std_msgs/msg/Bool: true stops
  /// Of those who publish it. Of a latched one max_age is the longest liveliness lease that its
  /// publishers may promise.
  EmergencyStopContract emergency_stop_contract;
  std::string acknowledge;  ///< std_msgs/msg/Bool: true acknowledges a stop that latches

  // What people tell it (dds_commands.h).
  std::string goal = "/goal_pose";         ///< geometry_msgs/msg/PoseStamped
  std::string told = "/prospect/command";  ///< std_msgs/msg/String
  std::string services = "/prospect";      ///< before /hold, ...: std_srvs/srv/Trigger
  /// nav2_msgs/action/NavigateToPose (dds_navigation.h)
  std::string action = "/prospect/navigate_to_pose";

  enum class RelayAge {
    kStamp,   ///< by the header's stamp against the clock of the relay's computer
    kArrival  ///< since it came: stamps are of a simulation, say
  };
  struct Command {
    std::string stamped = "/cmd_vel";  ///< geometry_msgs/msg/TwistStamped
    std::string plain;                 ///< geometry_msgs/msg/Twist
    /// [s] of silence after which the base stops by itself: as its driver is set up, or as the
    /// relay (dds_relay.h) does it.
    double dead_man = 0.0;
    /// TwistStamped to a relay, which passes it on to the topics above; empty: there is none.
    std::string relay;
    double relay_period = 0.02;  ///< [s] > 0 in which it looks, and repeats a stop
    RelayAge relay_age = RelayAge::kStamp;
    BaseLimits limits;  ///< what the base reaches, and what the relay bounds commands to
  } command;

  struct Output {
    std::string path = "/prospect/path", map = "/map", octomap = "/octomap_binary";
    std::string markers = "/prospect/markers", diagnostics = "/diagnostics";
    std::string state = "/prospect/state";  ///< drive mode, as diagnostic_msgs/msg/DiagnosticStatus
    double map_period = 1.0;                ///< [s] > 0 between two maps
    bool transforms = true;                 ///< map -> odom on tf
    bool odom_transform = false;  ///< odom -> base on tf, where the base's driver does not
  } output;
};

/// With `namespace: /NS` topics that the file leaves out are NS's, tf and diagnostics, too, and
/// those without a slash at the beginning. Throws InputError, a line a problem with the file's
/// line: unknown or missing keys, values out of range, names that ROS 2 does not take, topics that
/// are used twice, no source of ranges; and for arguments that are none.
DdsOptions read_dds_options(const std::string& path, const RosArguments& arguments = {});

}  // namespace prospect
