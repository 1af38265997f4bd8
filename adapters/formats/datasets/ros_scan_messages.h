// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <string_view>
#include <vector>

#include "perception/mapping/occupancy_mapper.h"

namespace prospect {

/// sensor_msgs/msg/LaserScan: beam i looks along (cos a, sin a, 0) in the lidar's frame, a =
/// angle_min + i angle_increment.
struct RosLaserScan {
  double angle_min = 0.0, angle_increment = 0.0;  ///< [rad]
  double time_increment = 0.0;                    ///< between neighbouring beams [s]
  double range_min = 0.0, range_max = 0.0;        ///< [m]
  std::vector<float> ranges;                      ///< [m]
};

// From CDR bytes, as read_ros_header(). Throw InputError, one line, where the bytes end early or
// say what cannot be.
RosLaserScan read_ros_laser_scan(std::string_view cdr, const std::string& name);

/// sensor_msgs/msg/PointCloud2 with fields x, y, z of float32 or float64: the points [m], in order.
/// Left out: points that are not finite, and those at the origin, by which drivers mean none.
/// Refused by name: big-endian points, other types of fields.
std::vector<Eigen::Vector3d> read_ros_point_cloud(std::string_view cdr, const std::string& name);

/// A scan as rays in the lidar's frame. Hits: range_min <= range < range_max. A miss: +infinity, by
/// which REP 117 means that nothing came back, or range_max itself (to 1 mm), which older drivers
/// write. All else says nothing, as the message's definition asks.
///
/// `T_end` maps points of the lidar's frame at the last beam to its frame at the first one: beams
/// between are moved by a share of it. The origin is that of the first beam.
DepthScan rays_of(const RosLaserScan& scan,
                  const Eigen::Isometry3d& T_end = Eigen::Isometry3d::Identity());

}  // namespace prospect
