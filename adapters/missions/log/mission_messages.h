// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "adapters/formats/bags/mcap_log.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/missions/log/map_messages.h"
#include "adapters/missions/log/planner_calls.h"
#include "adapters/missions/run/run_record.h"
#include "adapters/views/page/landmark_picture.h"
#include "engine/maps/belief.h"
#include "models/image.h"
#include "models/imu_sample.h"
#include "models/robot_description.h"
#include "perception/fusion/wheel_fusion.h"
#include "perception/mapping/depth_image.h"
#include "perception/mapping/occupancy_mapper.h"
#include "runtime/driver.h"
#include "runtime/event_log.h"

namespace prospect {

struct MissionMessageOptions {
  RobotDescription robot;
  std::map<int, PinholeCamera> depth_cameras{};  ///< of depth images, by number of the sensor
  double resolution = 0.1;                       ///< of the ground cells [m]
  double dt = 0.25;                              ///< of the planned poses [s]
  double start = 0.0;      ///< [s] of the clock of all stamps that are given: now
  std::int64_t epoch = 0;  ///< [ns] since 1970 at which that clock was 0
  /// [s] after which the whole map is told again; in between what has changed. 0: always the whole.
  double whole_map_every = 10.0;
};

/// The channels of a mission of a robot with so many depth sensors, docs/reference/log.md, each
/// known by its place in the list.
std::vector<McapLog::Channel> mission_channels(std::size_t depth_sensors = 1);

/// A mission as messages of ROS 2 in CDR, docs/reference/log.md.
///
/// Thread-safety: each function may be called by one thread at a time, different ones at the same
/// time, if `put` may. Nothing throws but what `put` does.
class MissionMessages {
 public:
  /// Gets each message: its channel, time [ns] and bytes.
  using Put = std::function<void(std::size_t, std::int64_t, std::string)>;
  MissionMessages(const MissionMessageOptions& options, Put put);

  /// What does not change: transforms of the robot's parts.
  void fixed();
  void belief(const Belief& belief);
  void command(double time, const Twist& command);
  void step(const StepRecord& step);
  void events(std::span<const Event> events);
  /// dropped: what of these messages was dropped, in words; who: where they go.
  void status(double time, const DriverStatus& status, const char* who, const std::string& dropped);
  /// Of a depth sensor, by its number.
  void scan(double time, const DepthScan& in_B, int sensor = 0);
  void wheels(const WheelSample& wheels);
  void imu(const ImuSample& sample);
  void pair(double time, const Image& left, const Image& right);
  /// Of a depth sensor whose camera is known, by its number.
  void depth(double time, const DepthImage& image, int sensor = 0);
  void picture(double time, const LandmarkPicture& picture);
  void planner_call(double time, const PlannerCall& call);

 private:
  std::int64_t ns(double time) const;

  const MissionMessageOptions options_;
  const Put put_;
  LoggedMap map_;
};

/// A scan as beams of a plane lidar at its origin with the axes of B: of its rays those that are
/// nearest to level, in order of azimuth, the nearest of each. Infinite: a ray that met nothing;
/// NaN: nothing is known.
ros::LaserScan level_scan(const DepthScan& in_B, double range_max);

}  // namespace prospect
