// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_pose.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/datasets/transform_tree.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/goal_pose.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "perception/odometry/body_pose.h"

namespace prospect {
namespace {

using Covariance6 = Eigen::Matrix<double, 6, 6>;

/// Of (x, y, z, yaw) of B, whose origin is at `arm` from that of the frame whose covariance it is,
/// both in W: d p_B = d p + (0, 0, 1) x arm d yaw. z of a robot on the floor is known.
Eigen::Matrix4d of_body(const Covariance6& told, const Eigen::Vector3d& arm) {
  Eigen::Matrix<double, 3, 6> J = Eigen::Matrix<double, 3, 6>::Zero();
  J(0, 0) = J(1, 1) = J(2, 5) = 1.0;
  J(0, 5) = -arm.y();
  J(1, 5) = arm.x();
  const Eigen::Matrix3d P = J * told * J.transpose();
  const Eigen::Vector3i planar(0, 1, 3);
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  covariance(planar, planar) = 0.5 * (P + P.transpose());
  return covariance;
}

}  // namespace

struct DdsPose::Impl {
  Impl(const DdsOptions& given, const DdsNode& its_node, const DdsTransforms& its_transforms,
       FrameSink& its_frames, DdsBase* its_base)
      : options(given),
        node(its_node),
        transforms(its_transforms),
        frames(its_frames),
        base(its_base) {}

  void take(std::string_view cdr, const std::string& name) {
    const DdsOptions::PoseTopic& by = options.pose;
    const RosTransform told = read_ros_pose(cdr, by.type, name);
    const std::string parent = without_slash(told.parent), child = without_slash(told.child);
    if (!parent.empty() && parent != options.frames.map) {
      throw InputError(name + ": frame_id is '" + told.parent + "'; expected '" +
                       options.frames.map + "' (frames.map)");
    }
    if (!child.empty() && child != by.frame) {
      throw InputError(name + ": child_frame_id is '" + told.child + "'; expected '" + by.frame +
                       "' (pose.frame)");
    }
    if (!(told.stamp > 0.0)) {
      throw InputError(name + ": a pose without a stamp; expected the time of its measurement");
    }
    Eigen::Isometry3d T_BF = Eigen::Isometry3d::Identity();
    if (by.frame != options.frames.base) {
      const auto known = transforms.newest(options.frames.base, by.frame);
      if (!known) {
        throw InputError(name + ": no transform from '" + by.frame + "' (pose.frame) to '" +
                         options.frames.base + "'; expected it on " + options.tf_static + " or " +
                         options.tf);
      }
      T_BF = *known;
    }
    const Eigen::Isometry3d T_WB = told.T * T_BF.inverse();
    put(told.stamp, T_WB, told.covariance, T_WB.translation() - told.T.translation(), name);
  }

  void put(double stamp, const Eigen::Isometry3d& T_WB, const Covariance6& told,
           const Eigen::Vector3d& arm, const std::string& name) {
    ros::check_upright(T_WB, name);
    ExternalPose pose{.stamp = stamp, .T_WB = T_WB};
    Covariance6 known = told;
    if (told.isZero(0.0)) {
      const double s = options.pose.sigma, yaw = options.pose.sigma_yaw;
      known.diagonal() << s * s, s * s, 0.0, 0.0, 0.0, yaw * yaw;
    }
    pose.covariance = of_body(known, arm);
    pose.T_OB = transforms.find(options.frames.odom, options.frames.base, stamp);
    frames.observe(pose);
    if (base) base->add_pose(stamp, T_WB);
    const std::lock_guard lock(mutex);
    first = first.value_or(body_pose(T_WB));
    came.notify_all();
  }

  std::string missing() const {
    const std::string within = " within " + number_text(options.timeout) + " s; expected ";
    if (options.pose_source == DdsOptions::PoseSource::kTf) {
      return options.tf + ", " + options.tf_static + ": no transform from '" + options.frames.base +
             "' to '" + options.frames.map + "'" + within +
             "one that moves, of who localizes the robot";
    }
    const std::string fault = node.fault(options.pose.topic);
    if (!fault.empty()) return fault;
    return options.pose.topic + ": no message" + within + "the robot's pose (" + options.pose.type +
           ")";
  }

  const DdsOptions options;
  const DdsNode& node;
  const DdsTransforms& transforms;
  FrameSink& frames;
  DdsBase* const base;
  mutable std::mutex mutex;
  mutable std::condition_variable came;
  std::optional<Pose> first;
};

DdsPose::DdsPose(const DdsOptions& options, DdsNode& node, DdsTransforms& transforms,
                 FrameSink& frames, DdsBase* base)
    : impl_(std::make_shared<Impl>(options, node, transforms, frames, base)) {
  const auto impl = impl_;
  if (options.pose_source == DdsOptions::PoseSource::kTf) {
    transforms.follow(
        options.frames.map, options.frames.base, [impl](double stamp, const Eigen::Isometry3d& T) {
          impl->put(stamp, T, Covariance6::Zero(), Eigen::Vector3d::Zero(), impl->options.tf);
        });
    return;
  }
  const std::string& type = options.pose.type;
  const std::vector<ros::MessageDefinition> definition =
      type == ros::PoseStamped::kType ? ros::definition_of<ros::PoseStamped>()
      : type == ros::Odometry::kType  ? ros::definition_of<ros::Odometry>()
                                      : ros::definition_of<ros::PoseWithCovarianceStamped>();
  node.subscribe(options.pose.topic, definition, DdsQos{false, false, 50},
                 [impl](std::string_view cdr, const std::string& name) { impl->take(cdr, name); });
}
DdsPose::~DdsPose() = default;

Pose DdsPose::wait() const {
  std::unique_lock lock(impl_->mutex);
  const bool came =
      impl_->came.wait_for(lock, std::chrono::duration<double>(impl_->options.timeout),
                           [&] { return impl_->first.has_value(); });
  if (!came) throw InputError(impl_->missing());
  return *impl_->first;
}

}  // namespace prospect
