// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/log/mission_messages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adapters/formats/datasets/mission_topics.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/map_msgs.h"
#include "adapters/formats/ros/message_definition.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/pose_message.h"
#include "adapters/formats/ros/rcl_interfaces.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "adapters/missions/log/step_messages.h"

namespace prospect {
namespace {

/// Topics by their place in the file's list of channels.
enum Topic : std::size_t {
  kTfStatic,
  kTf,
  kOdometry,
  kTruth,
  kCommand,
  kMap,
  kMapUpdates,
  kPlan,
  kMarkers,
  kStandings,
  kStep,
  kCostToGo,
  kEvents,
  kDiagnostics,
  kScan,
  kWheels,
  kImu,
  kLeft,
  kLeftInfo,
  kRight,
  kRightInfo,
  kDepth,
  kDepthInfo,
  kPictures,
  kPictureFeatures,
  kPlannerCalls,
  kMoreDepth  // image and calibration of each depth sensor from 1 on
};

template <ros::Message T>
McapLog::Channel channel(const char* topic) {
  return {topic, T::kType, ros::definition_text(ros::definition_of<T>())};
}

ros::Transform transform_of(const Eigen::Isometry3d& T) {
  const Eigen::Vector3d& p = T.translation();
  const Eigen::Quaterniond q(T.linear());
  return {{p.x(), p.y(), p.z()}, {q.x(), q.y(), q.z(), q.w()}};
}

Eigen::Isometry3d isometry_of(const Pose& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = pose.position;
  T.linear() = Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

ros::Twist twist_of(const Twist& twist) {
  return {{twist.linear.x(), twist.linear.y(), twist.linear.z()}, {0.0, 0.0, twist.yaw_rate}};
}

ros::CameraInfo info_of(const PinholeCamera& camera, double baseline, const ros::Header& header) {
  ros::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(camera.width);
  info.height = static_cast<std::uint32_t>(camera.height);
  info.distortion_model = "plumb_bob";
  info.d.assign(5, 0.0);
  info.k = {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
  info.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.p = {camera.fx, 0.0, camera.cx, -camera.fx * baseline, 0.0, camera.fy, camera.cy, 0.0, 0.0,
            0.0,       1.0, 0.0};
  return info;
}

ros::Image image_of(int width, int height, const char* encoding, std::size_t pixel,
                    const void* bytes, const ros::Header& header) {
  ros::Image image;
  image.header = header;
  image.width = static_cast<std::uint32_t>(width);
  image.height = static_cast<std::uint32_t>(height);
  image.encoding = encoding;
  image.step = static_cast<std::uint32_t>(static_cast<std::size_t>(width) * pixel);
  image.data = {static_cast<const std::uint8_t*>(bytes),
                static_cast<std::size_t>(height) * image.step};
  return image;
}

constexpr const char* kBody = "base_link";
constexpr const char* kLidar = "lidar";
constexpr const char* kLeftCamera = "camera_left_optical";
constexpr const char* kRightCamera = "camera_right_optical";
constexpr const char* kDepthCamera = "camera_depth_optical";

/// Frame of a depth sensor's scans.
std::string lidar_name(int sensor) {
  return sensor == 0 ? kLidar : kLidar + ('_' + std::to_string(sensor));
}

/// Frame of a depth sensor's images.
std::string depth_name(int sensor) {
  return sensor == 0 ? kDepthCamera : "camera_depth_" + std::to_string(sensor) + "_optical";
}

ros::TFMessage static_transforms(const RobotDescription& robot, const ros::Time& stamp) {
  ros::TFMessage message;
  const auto add = [&](const char* parent, const char* child, const Eigen::Isometry3d& T) {
    message.transforms.push_back({{stamp, parent}, child, transform_of(T)});
  };
  Eigen::Isometry3d lidar = Eigen::Isometry3d::Identity();
  lidar.translation() = robot.depth_mount.T_BC.translation();
  Eigen::Isometry3d right = robot.stereo_mount.T_BC;
  right.translation() += right.linear().col(0) * robot.stereo.baseline;
  // The estimate is not corrected by anything: its drift is in odom to base_link.
  add(kMapFrame, "odom", Eigen::Isometry3d::Identity());
  add(kBody, kLidar, lidar);
  add(kBody, kLeftCamera, robot.stereo_mount.T_BC);
  add(kBody, kRightCamera, right);
  add(kBody, kDepthCamera, robot.depth_mount.T_BC);
  for (std::size_t n = 0; n < robot.more_depth.size(); ++n) {
    lidar.translation() = robot.more_depth[n].mount.T_BC.translation();
    const auto sensor = static_cast<int>(n) + 1;
    add(kBody, lidar_name(sensor).c_str(), lidar);
    add(kBody, depth_name(sensor).c_str(), robot.more_depth[n].mount.T_BC);
  }
  return message;
}

std::uint8_t level_of(Severity severity) {
  switch (severity) {
    case Severity::kInfo:
      return ros::Log::kInfo;
    case Severity::kWarning:
      return ros::Log::kWarn;
    case Severity::kError:
      return ros::Log::kError;
    case Severity::kFatal:
      break;
  }
  return ros::Log::kFatal;
}

}  // namespace

std::vector<McapLog::Channel> mission_channels(std::size_t depth_sensors) {
  std::vector<McapLog::Channel> all = {channel<ros::TFMessage>("/tf_static"),
                                       channel<ros::TFMessage>("/tf"),
                                       channel<ros::Odometry>("/odometry"),
                                       channel<ros::Odometry>("/truth/odometry"),
                                       channel<ros::TwistStamped>("/cmd_vel"),
                                       channel<ros::OccupancyGrid>(topic::kMap),
                                       channel<ros::OccupancyGridUpdate>(topic::kMapUpdates),
                                       channel<ros::Path>(topic::kPlan),
                                       channel<ros::MarkerArray>(topic::kMarkers),
                                       channel<ros::MarkerArray>(topic::kFrontiers),
                                       channel<ros::DiagnosticArray>(topic::kStep),
                                       channel<ros::PointCloud2>(topic::kCostToGo),
                                       channel<ros::Log>("/rosout"),
                                       channel<ros::DiagnosticArray>("/diagnostics"),
                                       channel<ros::LaserScan>("/scan"),
                                       channel<ros::TwistStamped>("/wheels"),
                                       channel<ros::Imu>("/imu"),
                                       channel<ros::Image>("/camera/left/image_rect"),
                                       channel<ros::CameraInfo>("/camera/left/camera_info"),
                                       channel<ros::Image>("/camera/right/image_rect"),
                                       channel<ros::CameraInfo>("/camera/right/camera_info"),
                                       channel<ros::Image>("/camera/depth/image_rect"),
                                       channel<ros::CameraInfo>("/camera/depth/camera_info"),
                                       channel<ros::CompressedImage>(topic::kPictures),
                                       channel<ros::PointCloud2>(topic::kPictureFeatures),
                                       channel<PlannerCall>(topic::kPlannerCalls)};
  for (std::size_t n = 1; n < depth_sensors; ++n) {
    const std::string prefix = "/camera/depth_" + std::to_string(n);
    all.push_back(channel<ros::Image>((prefix + "/image_rect").c_str()));
    all.push_back(channel<ros::CameraInfo>((prefix + "/camera_info").c_str()));
  }
  return all;
}

MissionMessages::MissionMessages(const MissionMessageOptions& options, Put put)
    : options_(options), put_(std::move(put)), map_(options.whole_map_every) {}

void MissionMessages::fixed() {
  const std::int64_t now = ns(options_.start);
  put_(kTfStatic, now, ros::to_cdr(static_transforms(options_.robot, stamp_at(now))));
}

std::int64_t MissionMessages::ns(double time) const {
  return options_.epoch + (std::isfinite(time) ? std::llround(1e9 * time) : 0);
}

void MissionMessages::belief(const Belief& belief) {
  const std::int64_t now = ns(belief.stamp);
  ros::Odometry odometry;
  odometry.header = {stamp_at(now), kMapFrame};
  odometry.child_frame_id = kBody;
  odometry.pose.pose = ros::pose_message(belief.pose);
  odometry.twist.twist = twist_of(belief.twist);
  constexpr std::array<std::size_t, 4> kAxes = {0, 1, 2, 5};  // x, y, z, yaw of six
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      odometry.pose.covariance[6 * kAxes[i] + kAxes[j]] =
          belief.covariance(static_cast<int>(i), static_cast<int>(j));
    }
  }
  put_(kOdometry, now, ros::to_cdr(odometry));
  ros::TFMessage tf;
  tf.transforms.push_back({{stamp_at(now), "odom"}, kBody, transform_of(isometry_of(belief.pose))});
  put_(kTf, now, ros::to_cdr(tf));
}

void MissionMessages::planner_call(double time, const PlannerCall& call) {
  put_(kPlannerCalls, ns(time), ros::to_cdr(call));
}

void MissionMessages::command(double time, const Twist& command) {
  ros::TwistStamped message;
  const std::int64_t now = ns(time);
  message.header = {stamp_at(now), kBody};
  message.twist = twist_of(command);
  put_(kCommand, now, ros::to_cdr(message));
}

void MissionMessages::step(const StepRecord& step) {
  const std::int64_t now = ns(step.stamp);
  ros::Odometry truth;
  truth.header = {stamp_at(now), kMapFrame};
  truth.child_frame_id = kBody;  // what hangs on it by /tf_static hangs on its true pose, too
  truth.pose.pose = ros::pose_message(step.true_pose);
  put_(kTruth, now, ros::to_cdr(truth));
  if (const auto change = map_.change(step.time, options_.resolution, step.map_changes)) {
    if (change->whole) {
      put_(kMap, now, ros::to_cdr(whole_map(change->cells, now), change->cells.values.size()));
    } else {
      put_(kMapUpdates, now, ros::to_cdr(part_of_map(*change, now), change->cells.values.size()));
    }
  }
  put_(kPlan, now, ros::to_cdr(horizon_path(step, options_.dt, now)));
  put_(kMarkers, now, ros::to_cdr(step_markers(step, options_.resolution, now)));
  if (!step.standings.empty()) {
    put_(kStandings, now, ros::to_cdr(frontier_markers(step, now)));
  }
  if (step.cost_to_go) {
    std::string bytes;
    const ros::PointCloud2 points = cost_to_go_points(*step.cost_to_go, now, bytes);
    put_(kCostToGo, now, ros::to_cdr(points, bytes.size()));
  }
  put_(kStep, now, ros::to_cdr(step_values(step, now)));
}

void MissionMessages::events(std::span<const Event> events) {
  for (const Event& event : events) {
    const std::int64_t now = ns(event.last_stamp);
    ros::Log message;
    message.stamp = stamp_at(now);
    message.level = level_of(event.severity);
    message.name = event.source;
    message.msg = event.cause + ": " + event.text;
    put_(kEvents, now, ros::to_cdr(message));
  }
}

void MissionMessages::status(double time, const DriverStatus& status, const char* who,
                             const std::string& dropped) {
  const std::int64_t now = ns(time);
  ros::DiagnosticArray array;
  array.header = {stamp_at(now), kMapFrame};
  const auto add = [&](std::byte level, const char* name, std::string text,
                       std::vector<ros::KeyValue> values) {
    ros::DiagnosticStatus one;
    one.level = level;
    one.name = name;
    one.message = std::move(text);
    one.hardware_id = "prospect";
    one.values = std::move(values);
    array.status.push_back(std::move(one));
  };
  using Status = ros::DiagnosticStatus;
  const DriveMode mode = status.mode.mode;
  add(mode == DriveMode::kStopped                                    ? Status::kError
      : mode == DriveMode::kDegraded || mode == DriveMode::kStopping ? Status::kWarn
                                                                     : Status::kOk,
      "drive", status.why,
      {{"mode", std::string(to_string(mode))},
       {"cause", std::string(to_string(status.mode.cause))},
       {"reason", std::string(to_string(status.reason))},
       {"detail", status.detail},
       {"late_plans", std::to_string(status.late_plans)},
       {"guard_stops", std::to_string(status.guard_stops)},
       {"capture_to_command", status.capture_to_command.to_text()},
       {"planning", status.planning.to_text()},
       {"command_period", status.command_period.to_text()}});
  add(dropped.empty() ? Status::kOk : Status::kWarn, who, dropped, {});
  put_(kDiagnostics, now, ros::to_cdr(array));
}

void MissionMessages::scan(double time, const DepthScan& in_B, int sensor) {
  const std::vector<DepthSensor> sensors = options_.robot.depth_sensors();
  if (sensor < 0 || sensor >= static_cast<int>(sensors.size())) return;
  const std::int64_t now = ns(time);
  ros::LaserScan scan =
      level_scan(in_B, sensors[static_cast<std::size_t>(sensor)].footprint.max_range);
  scan.header = {stamp_at(now), lidar_name(sensor)};
  put_(kScan, now, ros::to_cdr(scan, 4 * scan.ranges.size()));
}

void MissionMessages::wheels(const WheelSample& wheels) {
  ros::TwistStamped message;
  const std::int64_t now = ns(wheels.stamp);
  message.header = {stamp_at(now), kBody};
  message.twist = {{wheels.velocity.x(), wheels.velocity.y(), 0.0}, {0.0, 0.0, wheels.yaw_rate}};
  put_(kWheels, now, ros::to_cdr(message));
}

void MissionMessages::imu(const ImuSample& sample) {
  ros::Imu message;
  const std::int64_t now = ns(sample.stamp);
  message.header = {stamp_at(now), kBody};
  message.orientation_covariance[0] = -1.0;  // none is measured
  const Eigen::Vector3d w = sample.R_BS * sample.angular_velocity;
  const Eigen::Vector3d a = sample.R_BS * sample.linear_acceleration;
  message.angular_velocity = {w.x(), w.y(), w.z()};
  message.linear_acceleration = {a.x(), a.y(), a.z()};
  put_(kImu, now, ros::to_cdr(message));
}

void MissionMessages::pair(double time, const Image& left, const Image& right) {
  const std::int64_t now = ns(time);
  const auto put = [&](Topic image_topic, Topic info_topic, const char* frame, const Image& image,
                       double baseline) {
    const ros::Header header{stamp_at(now), frame};
    put_(image_topic, now,
         ros::to_cdr(image_of(image.width, image.height, "mono8", 1, image.pixels.data(), header),
                     image.pixels.size()));
    put_(info_topic, now, ros::to_cdr(info_of(options_.robot.stereo.left, baseline, header)));
  };
  put(kLeft, kLeftInfo, kLeftCamera, left, 0.0);
  put(kRight, kRightInfo, kRightCamera, right, options_.robot.stereo.baseline);
}

void MissionMessages::depth(double time, const DepthImage& image, int sensor) {
  const auto camera = options_.depth_cameras.find(sensor);
  if (!image.whole() || camera == options_.depth_cameras.end()) return;
  const std::int64_t now = ns(time);
  const ros::Header header{stamp_at(now), depth_name(sensor)};
  const auto at = static_cast<std::size_t>(sensor);
  put_(sensor == 0 ? kDepth : kMoreDepth + 2 * (at - 1), now,
       ros::to_cdr(image_of(image.width, image.height, "32FC1", 4, image.depth.data(), header),
                   4 * image.depth.size()));
  put_(sensor == 0 ? kDepthInfo : kMoreDepth + 2 * (at - 1) + 1, now,
       ros::to_cdr(info_of(camera->second, 0.0, header)));
}

void MissionMessages::picture(double time, const LandmarkPicture& picture) {
  const std::int64_t now = ns(time);
  ros::CompressedImage image;
  image.header = {stamp_at(now), kLeftCamera};
  image.format = "jpeg";
  image.data = std::span(picture.jpeg);
  put_(kPictures, now, ros::to_cdr(image, picture.jpeg.size()));
  std::string bytes;
  const ros::PointCloud2 features = picture_features(picture, now, bytes);
  put_(kPictureFeatures, now, ros::to_cdr(features, bytes.size()));
}

ros::LaserScan level_scan(const DepthScan& in_B, double range_max) {
  struct Ray {
    double azimuth, elevation;
    float range;
  };
  std::vector<Ray> rays;
  double flattest = std::numeric_limits<double>::infinity();
  const auto add = [&](const Eigen::Vector3d& point, bool hit) {
    const Eigen::Vector3d d = point - in_B.origin;
    const double level = d.head<2>().norm();
    if (!(level > 1e-6)) return;
    const double elevation = std::abs(std::atan2(d.z(), level));
    flattest = std::min(flattest, elevation);
    rays.push_back({std::atan2(d.y(), d.x()), elevation,
                    hit ? static_cast<float>(level) : std::numeric_limits<float>::infinity()});
  };
  for (const Eigen::Vector3d& hit : in_B.hits) add(hit, true);
  for (const Eigen::Vector3d& miss : in_B.misses) add(miss, false);
  constexpr double kLevel = 0.6 * M_PI / 180.0;
  const double most = std::max(kLevel, 1.05 * flattest);
  std::erase_if(rays, [&](const Ray& ray) { return ray.elevation > most; });
  ros::LaserScan scan;
  scan.range_min = 0.0F;
  // A range that is range_max itself means that nothing was met.
  scan.range_max = static_cast<float>(range_max + 0.01);
  if (rays.empty()) return scan;
  std::sort(rays.begin(), rays.end(),
            [](const Ray& a, const Ray& b) { return a.azimuth < b.azimuth; });
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < rays.size(); ++i) {
    const double gap = rays[i].azimuth - rays[i - 1].azimuth;
    if (gap > 1e-4) step = std::min(step, gap);
  }
  const double first = rays.front().azimuth, last = rays.back().azimuth;
  const std::size_t beams =
      std::isfinite(step) ? static_cast<std::size_t>(std::lround((last - first) / step)) + 1 : 1;
  scan.angle_min = static_cast<float>(first);
  scan.angle_max = static_cast<float>(last);
  scan.angle_increment =
      beams > 1 ? static_cast<float>((last - first) / static_cast<double>(beams - 1)) : 0.0F;
  scan.ranges.assign(beams, std::numeric_limits<float>::quiet_NaN());
  for (const Ray& ray : rays) {
    const std::size_t beam =
        beams > 1 ? static_cast<std::size_t>(std::lround((ray.azimuth - first) / (last - first) *
                                                         static_cast<double>(beams - 1)))
                  : 0;
    float& range = scan.ranges[beam];
    if (std::isnan(range) || ray.range < range) range = ray.range;
  }
  return scan;
}

}  // namespace prospect
