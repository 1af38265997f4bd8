// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/pose_message.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "adapters/formats/worlds/world.h"
#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/dds_options.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/kinematic_robot.h"
#include "models/body_transform.h"
#include "models/robot_description.h"
#include "runtime/clock.h"

namespace prospect::test {

/// The motors of a robot behind topics: what was commanded last, until it is too old.
class DdsMotors {
 public:
  explicit DdsMotors(double dead_man) : dead_man_(dead_man) {}
  void command(const ros::Twist& twist) {
    const std::lock_guard lock(mutex_);
    command_ = {{twist.linear.x, twist.linear.y, 0.0}, twist.angular.z};
    newest_ = clock_.now();
  }
  Twist now() {
    const std::lock_guard lock(mutex_);
    if (clock_.now() - newest_ < dead_man_) return command_;
    stops_ += command_.linear.norm() + std::abs(command_.yaw_rate) > 0.0;
    command_ = {};
    return command_;
  }
  int stops() const { return stops_; }

 private:
  SteadyClock clock_;
  double dead_man_;
  std::mutex mutex_;
  Twist command_;
  double newest_ = -1e9;
  int stops_ = 0;
};

/// A simulated robot behind topics of ROS 2 that has wheels, unless topics.odometry is empty, a
/// lidar of one plane and somebody who localizes it, and no camera. W of the world is frames.map;
/// odom begins where the robot does. Scans come at 10 Hz, odometry at 50 Hz; the localization tells
/// map -> odom at 10 Hz, as AMCL does stamped ahead, or the topic of poses at 25 Hz.
class DdsLidarRobot {
 public:
  /// The robot's depth sensor is the lidar, at the place of its mount.
  DdsLidarRobot(const World& world, const RobotDescription& robot, const DdsOptions& topics,
                const DdsAddress& address)
      : topics_(topics),
        start_(start_of(world, robot)),
        body_(world, robot.shape, {}, start_, 1),
        lidar_(world, rays_of(robot), robot.depth_mount, 1),
        motors_(topics.command.dead_man),
        node_(address) {
    if (!topics.odometry.empty()) {
      odometry_ = node_.advertise<ros::Odometry>(topics.odometry, kReliableQos);
    }
    scan_ = node_.advertise<ros::LaserScan>(topics.scan, kSensorQos);
    tf_ = node_.advertise<ros::TFMessage>(topics.tf, kTransformQos);
    static_ = node_.advertise<ros::TFMessage>(topics.tf_static, kStaticTransformQos);
    if (!topics.pose.topic.empty()) {
      pose_ = node_.advertise<ros::PoseWithCovarianceStamped>(topics.pose.topic, kReliableQos);
    }
    node_.subscribe<ros::TwistStamped>(
        topics.command.stamped, kCommandQos,
        [this](const ros::TwistStamped& m) { motors_.command(m.twist); });
    node_.start();
    const Eigen::Vector3d at = robot.depth_mount.T_BC.translation();
    node_.publish(
        static_,
        ros::TFMessage{{transform(0.0, topics.frames.base, "lidar", at.x(), at.y(), at.z(), 0.0)}});
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }

  /// The localization says from now on that the robot is so much further along x of the map [m].
  void shift(double by) { shift_ = by; }
  /// The localization falls silent.
  void silence() { silent_ = true; }
  /// Ends it; what is true is read after that.
  void stop() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
  }
  const KinematicRobot& body() const { return body_; }
  const Pose& start() const { return start_; }
  const DdsMotors& motors() const { return motors_; }

 private:
  static Pose start_of(const World& world, const RobotDescription& robot) {
    Pose start = world.start;
    start.position.z() = robot.base_height();
    return start;
  }
  static DepthCameraOptions rays_of(const RobotDescription& robot) {
    DepthCameraOptions rays;
    rays.footprint = robot.depth;
    rays.footprint.horizontal_fov = 2.0 * M_PI;
    rays.footprint.vertical_fov = 0.0;
    rays.columns = kBeams;
    rays.rows = 1;
    return rays;
  }
  static ros::TransformStamped transform(double stamp, const std::string& parent,
                                         const std::string& child, double x, double y, double z,
                                         double yaw) {
    return {{ros::time_of(stamp), parent},
            child,
            {{x, y, z}, {0.0, 0.0, std::sin(0.5 * yaw), std::cos(0.5 * yaw)}}};
  }

  void run(const std::stop_token& stop) {
    double before = clock_.now();
    Pose odom;
    for (int n = 0; !stop.stop_requested(); ++n) {
      clock_.wait_until(before + 0.02, stop);
      const double now = clock_.now();
      const Twist command = motors_.now();
      const Twist twist = body_.move(command, now - before) ? command : Twist();
      odom = advance(odom, twist, now - before);
      before = now;
      if (odometry_ >= 0) tell_odometry(now, odom, twist);
      if (n % 5 == 0) localize(now);
      if (n % 2 == 0) tell_pose(now);
      if (n % 5 == 0) scan(now);
    }
  }

  void tell_odometry(double now, const Pose& odom, const Twist& twist) {
    const auto& frames = topics_.frames;
    ros::Odometry m;
    m.header = {ros::time_of(now), frames.odom};
    m.child_frame_id = frames.base;
    m.pose.pose = ros::pose_message(odom);
    m.twist.twist.linear.x = twist.linear.x();
    m.twist.twist.angular.z = twist.yaw_rate;
    node_.publish(odometry_, m);
    node_.publish(tf_, ros::TFMessage{{transform(now, frames.odom, frames.base, odom.position.x(),
                                                 odom.position.y(), 0.0, odom.yaw)}});
  }

  void localize(double now) {
    if (silent_ || pose_ >= 0) return;
    node_.publish(tf_, ros::TFMessage{{transform(now + 0.1, topics_.frames.map, topics_.frames.odom,
                                                 start_.position.x() + shift_, start_.position.y(),
                                                 0.0, start_.yaw)}});
  }
  void tell_pose(double now) {
    if (silent_ || pose_ < 0) return;
    const Pose& at = body_.pose();
    ros::PoseWithCovarianceStamped m;
    m.header = {ros::time_of(now), topics_.frames.map};
    m.pose.pose.position = {at.position.x() + shift_, at.position.y(), 0.0};
    m.pose.pose.orientation = {0.0, 0.0, std::sin(0.5 * at.yaw), std::cos(0.5 * at.yaw)};
    m.pose.covariance[0] = m.pose.covariance[7] = 0.0009;
    m.pose.covariance[35] = 0.0001;
    node_.publish(pose_, m);
  }
  void scan(double now) {
    const DepthScan rays = lidar_.sense(body_.pose());
    std::vector<float> ranges(kBeams, std::numeric_limits<float>::quiet_NaN());
    const auto beam = [&](const Eigen::Vector3d& point) -> float& {
      const Eigen::Vector3d d = point - rays.origin;
      const double share = (std::atan2(d.y(), d.x()) + M_PI) / (2.0 * M_PI);
      return ranges[std::min<std::size_t>(kBeams - 1,
                                          static_cast<std::size_t>(share * double{kBeams}))];
    };
    for (const auto& p : rays.hits) beam(p) = static_cast<float>((p - rays.origin).norm());
    for (const auto& p : rays.misses) beam(p) = std::numeric_limits<float>::infinity();
    ros::LaserScan m;
    m.header = {ros::time_of(now), "lidar"};
    m.angle_increment = static_cast<float>(2.0 * M_PI / kBeams);
    m.angle_min = static_cast<float>(-M_PI) + 0.5F * m.angle_increment;
    m.angle_max = m.angle_min + m.angle_increment * static_cast<float>(kBeams - 1);
    m.range_min = static_cast<float>(lidar_.options().footprint.min_range);
    m.range_max = static_cast<float>(lidar_.options().footprint.max_range);
    m.ranges = ranges;
    node_.publish(scan_, m);
  }

  static constexpr int kBeams = 360;
  const DdsOptions topics_;
  SteadyClock clock_;
  Pose start_;
  KinematicRobot body_;
  DepthCamera lidar_;
  DdsMotors motors_;
  std::atomic<double> shift_{0.0};
  std::atomic<bool> silent_{false};
  DdsNode node_;
  int odometry_ = -1, scan_ = -1, tf_ = -1, static_ = -1, pose_ = -1;
  std::jthread thread_;  // ends first
};

}  // namespace prospect::test
