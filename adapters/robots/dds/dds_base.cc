// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_base.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/datasets/transform_tree.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/goal_pose.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/robots/dds/dds_links.h"
#include "models/sinc.h"
#include "runtime/clock_offset.h"
#include "runtime/pose_velocity.h"

namespace prospect {

struct DdsBase::Impl {
  Impl(const DdsOptions& given, DdsNode& its_node, const DdsTransforms& its_transforms,
       const Clock& its_clock, const PoseJumpOptions& jump)
      : options(given),
        node(its_node),
        transforms(its_transforms),
        clock(its_clock),
        links(dds_links(given), its_node),
        by_poses(jump) {}

  /// What the transforms that are published rest on is the pose in frames.odom.
  void check_parent(const std::string& parent) const {
    const bool rests = options.output.transforms || options.output.odom_transform;
    if (!rests || without_slash(parent).empty() || without_slash(parent) == options.frames.odom) {
      return;
    }
    throw InputError(options.odometry + ": frame_id is '" + parent + "'; expected '" +
                     options.frames.odom + "' (frames.odom)");
  }
  /// Where the frame of the odometry is in B, which it must be or be fixed to.
  Eigen::Isometry3d odometry_frame(const std::string& child) const {
    const std::string field = options.tells_odometry_pose() ? "child_frame_id" : "frame_id";
    if (without_slash(child) == options.frames.base) return Eigen::Isometry3d::Identity();
    if (!options.odometry_by_tf) {
      throw InputError(options.odometry + ": " + field + " is '" + child + "'; expected '" +
                       options.frames.base + "' (frames.base), or odometry_frame: tf");
    }
    const auto T = transforms.newest(options.frames.base, child);
    if (!T) {
      throw InputError(options.odometry + ": no transform from its " + field + " '" + child +
                       "' to '" + options.frames.base + "'; expected it on " + options.tf_static +
                       " or " + options.tf);
    }
    return *T;
  }

  /// Whether it is the one that is listened to: who spoke first, until it has gone. Another is a
  /// fault, and its numbers do not count until that is seen.
  bool is_heard(std::uint64_t publisher) {
    if (publisher == speaker) return true;
    const std::vector<std::uint64_t> there = node.live_publishers(options.odometry);
    if (std::find(there.begin(), there.end(), speaker) != there.end()) return false;
    speaker = publisher;
    return true;
  }

  void add(std::string_view cdr, const std::string& name, std::uint64_t publisher) {
    if (!is_heard(publisher)) return;
    const RosMotion told = read_ros_motion(cdr, options.odometry_type, name);
    if (!(told.stamp > 0.0)) {
      throw InputError(name + ": a motion without a stamp; expected the time of its measurement");
    }
    const Eigen::Isometry3d T_BO = odometry_frame(told.frame);
    // The twist of a rigid body in B: turned, and less what turning adds at the frame's place.
    const Eigen::Vector3d turning = T_BO.linear() * told.angular;
    const Eigen::Vector3d moving =
        T_BO.linear() * told.linear - turning.cross(Eigen::Vector3d(T_BO.translation()));
    const WheelSample sample{told.stamp, moving.head<2>(), turning.z()};
    std::optional<Eigen::Isometry3d> T;
    if (options.tells_odometry_pose()) {
      const RosTransform pose = read_ros_pose(cdr, ros::Odometry::kType, name);
      check_parent(pose.parent);
      T = pose.T * T_BO.inverse();
      ros::check_upright(*T, name);
    }
    const std::lock_guard lock(mutex);
    if (!T) T = moved(sample);
    heard = clock.now();
    if (!options.use_sim_time) offset.add(sample.stamp, *heard);
    velocity = {{moving.x(), moving.y(), 0.0}, turning.z()};
    if (wheels.size() == kMost) wheels.erase(wheels.begin());
    wheels.push_back(sample);
    poses.emplace_back(sample.stamp, *T);
    while (poses.size() > kMost || poses.back().first - poses.front().first > kKept) {
      poses.pop_front();
    }
  }

  void add_pose(double stamp, const Eigen::Isometry3d& T_WB) {
    const std::lock_guard lock(mutex);
    if (!by_poses.add(stamp, T_WB) || !by_poses.velocity()) return;
    heard = clock.now();
    if (!options.use_sim_time) offset.add(stamp, *heard);
    velocity = *by_poses.velocity();
  }

  /// The newest pose, and the arc that was driven since then.
  Eigen::Isometry3d moved(const WheelSample& sample) const {
    if (poses.empty()) return Eigen::Isometry3d::Identity();
    const double dt = std::max(0.0, sample.stamp - poses.back().first);
    const double turn = sample.yaw_rate * dt;
    const auto turned_by = [](double angle) {
      return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ());
    };
    const Eigen::Vector3d way(sample.velocity.x() * dt, sample.velocity.y() * dt, 0.0);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = turned_by(turn).toRotationMatrix();
    T.translation() = sinc(0.5 * turn) * (turned_by(0.5 * turn) * way);
    return poses.back().second * T;
  }

  void publish(const Twist& command) {
    ros::TwistStamped message;
    message.header = {stamp(clock.now()), options.frames.base};
    message.twist.linear = {command.linear.x(), command.linear.y(), 0.0};
    message.twist.angular.z = command.yaw_rate;
    if (stamped >= 0) node.publish(stamped, message);
    if (plain >= 0) node.publish(plain, message.twist);
  }

  ros::Time stamp(double time) const {
    if (options.use_sim_time) return ros::time_of(time);
    const std::lock_guard lock(mutex);
    if (const std::optional<double> known = offset.offset()) return ros::time_of(time - *known);
    const double day =
        std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    return ros::time_of(day + (time - clock.now()));
  }

  static constexpr double kKept = 2.0;  // [s] of poses
  static constexpr std::size_t kMost = 2000;
  const DdsOptions options;
  DdsNode& node;
  const DdsTransforms& transforms;
  const Clock& clock;
  DdsLinkWatch links;         // of the command thread
  std::uint64_t speaker = 0;  // of the odometry; of the node's thread
  int stamped = -1, plain = -1;
  std::vector<std::string> command_topics;
  mutable std::mutex mutex;
  ClockOffset offset;
  std::optional<double> heard;
  PoseVelocity by_poses;
  Twist velocity;
  std::vector<WheelSample> wheels;
  std::deque<std::pair<double, Eigen::Isometry3d>> poses;  // by the robot's stamps
  std::optional<EmergencyStopInput> emergency_stop;
};

DdsBase::DdsBase(const DdsOptions& options, DdsNode& node, const DdsTransforms& transforms,
                 const Clock& clock, DriveRequests* requests, const PoseJumpOptions& jump)
    : impl_(std::make_shared<Impl>(options, node, transforms, clock, jump)) {
  const auto impl = impl_;
  const std::string& type = options.odometry_type;
  const std::vector<ros::MessageDefinition> definition =
      type == ros::TwistStamped::kType ? ros::definition_of<ros::TwistStamped>()
      : type == ros::TwistWithCovarianceStamped::kType
          ? ros::definition_of<ros::TwistWithCovarianceStamped>()
          : ros::definition_of<ros::Odometry>();
  if (!options.odometry.empty()) {
    node.subscribe(options.odometry, definition, DdsQos{false, false, 50},
                   [impl](std::string_view cdr, const std::string& name, std::uint64_t publisher) {
                     impl->add(cdr, name, publisher);
                   });
  }
  if (!options.emergency_stop.empty()) {
    const EmergencyStopContract& contract = options.emergency_stop_contract;
    impl->emergency_stop.emplace(options.emergency_stop, contract);
    DdsQos qos = kReliableQos;
    qos.transient_local = contract.latched;
    if (contract.latched) qos.lease = contract.max_age;
    node.subscribe<ros::Bool>(options.emergency_stop, qos,
                              [impl](const ros::Bool& m, std::uint64_t publisher) {
                                impl->emergency_stop->told(publisher, m.data, impl->clock.now());
                              });
  }
  if (requests && !options.acknowledge.empty()) {
    node.subscribe<ros::Bool>(options.acknowledge, kReliableQos, [requests](const ros::Bool& m) {
      if (m.data) requests->acknowledge();
    });
  }
  const DdsOptions::Command& command = options.command;
  if (!command.relay.empty()) {
    impl_->stamped = node.advertise<ros::TwistStamped>(command.relay, kCommandQos);
    impl_->command_topics = {command.relay};
    return;
  }
  if (!command.stamped.empty()) {
    impl_->stamped = node.advertise<ros::TwistStamped>(command.stamped, kCommandQos);
    impl_->command_topics.push_back(command.stamped);
  }
  if (!command.plain.empty()) {
    impl_->plain = node.advertise<ros::Twist>(command.plain, kCommandQos);
    impl_->command_topics.push_back(command.plain);
  }
}
DdsBase::~DdsBase() = default;

std::string DdsBase::name() const noexcept { return "dds"; }
std::optional<double> DdsBase::dead_man() const noexcept {
  const DdsOptions::Command& command = impl_->options.command;
  // A relay sees it at the end of a period at the latest.
  return command.dead_man + (command.relay.empty() ? 0.0 : command.relay_period);
}
BaseLimits DdsBase::limits() const noexcept { return impl_->options.command.limits; }

void DdsBase::send(const Twist& command, double expires) noexcept {
  if (!(impl_->clock.now() < expires)) return;
  if (!command.linear.allFinite() || !std::isfinite(command.yaw_rate)) return stop();
  try {
    impl_->publish(command);
  } catch (...) {
    // Memory is used up: silence, which the dead-man ends.
  }
}

void DdsBase::stop() noexcept {
  try {
    impl_->publish({});
  } catch (...) {
    // As in send().
  }
}

BaseReport DdsBase::report() noexcept {
  BaseReport report;
  try {
    const DdsOptions& o = impl_->options;
    const DdsNode& node = impl_->node;
    bool listens = false;
    for (const std::string& topic : impl_->command_topics) {
      listens = listens || node.subscribers(topic) > 0;
    }
    report.faults = impl_->links.faults(impl_->clock.now());
    if (const std::string moved = impl_->transforms.moved(impl_->clock.now()); !moved.empty()) {
      report.faults.push_back(moved);
    }
    if (impl_->emergency_stop) {
      impl_->emergency_stop->set_present(node.live_publishers(o.emergency_stop),
                                         impl_->clock.now());
    }
    const std::lock_guard lock(impl_->mutex);
    report.connected = listens && impl_->heard.has_value();
    report.stamp = impl_->heard.value_or(0.0);
    report.velocity_of_poses = o.odometry.empty();
    report.velocity = impl_->velocity;
    report.wheels = std::exchange(impl_->wheels, {});
    if (impl_->heard && !o.odometry.empty() &&
        impl_->clock.now() - *impl_->heard > kOdometrySilence) {
      report.faults.push_back(o.odometry + ": odometry is silent");
    }
  } catch (...) {
    // Memory is used up: no word is a link that is down.
    report.connected = false;
  }
  return report;
}

const EmergencyStopInput* DdsBase::emergency_stop() const {
  return impl_->emergency_stop ? &*impl_->emergency_stop : nullptr;
}

void DdsBase::add_pose(double stamp, const Eigen::Isometry3d& T_WB) {
  if (impl_->options.odometry.empty()) impl_->add_pose(stamp, T_WB);
}

ros::Time DdsBase::ros_time(double time) const { return impl_->stamp(time); }

std::optional<Eigen::Isometry3d> DdsBase::odometry(double time) const {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->poses.empty()) return std::nullopt;
  const double at = time - impl_->offset.offset().value_or(0.0);
  const auto* nearest = &impl_->poses.back();
  for (const auto& pose : impl_->poses) {
    if (std::abs(pose.first - at) < std::abs(nearest->first - at)) nearest = &pose;
  }
  return nearest->second;
}

}  // namespace prospect
