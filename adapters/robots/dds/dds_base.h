// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>

#include "adapters/formats/ros/std_msgs.h"
#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/dds_options.h"
#include "adapters/robots/dds/dds_transforms.h"
#include "runtime/base.h"
#include "runtime/clock.h"
#include "runtime/drive_requests.h"
#include "runtime/emergency_stop.h"
#include "runtime/pose_jump.h"

namespace prospect {

/// A base behind topics of ROS 2: velocity commands go out, odometry comes in. Its dead-man is the
/// one that its driver is set up with (DdsOptions::Command::dead_man): it is declared, and nothing
/// here can see whether it is so. Where the driver has none, commands go to a relay beside it
/// (dds_relay.h), which is seen: without it the link does not stand.
///
/// Commands: TwistStamped, stamped with the robot's clock, and Twist; to a relay TwistStamped
/// alone. One that has expired is not sent. Nothing is sent before the first send() or stop().
///
/// Report: velocity and wheel motion of the odometry's twist, or of a stamped twist, which is the
/// body's: of frames.base, or with odometry_by_tf of another frame that is fixed to it, and is
/// carried over. The link
/// stands while odometry has come and somebody subscribes to commands. Faults: odometry that is
/// silent for half a second, a camera that moves (DdsTransforms::moved()), and what else is not as
/// the contracts of the links say (dds_links.h). Of several publishers of odometry the first counts
/// until it has gone. Where there is no odometry, poses say how fast it is (PoseVelocity).
///
/// Clocks: the offset between the robot's clock and the runtime's is estimated from the odometry's
/// stamps, or the poses' (ClockOffset); with use_sim_time both are one.
///
/// Who acknowledges a stop by topic (DdsOptions::acknowledge) asks so of `requests`; null: nobody.
///
/// Declares its topics on the node: make it before DdsNode::start(). Clock, transforms and requests
/// must outlive the node. Thread-safety: as Base; the rest any thread.
class DdsBase final : public Base {
 public:
  DdsBase(const DdsOptions& options, DdsNode& node, const DdsTransforms& transforms,
          const Clock& clock, DriveRequests* requests = nullptr, const PoseJumpOptions& jump = {});
  ~DdsBase() override;

  std::string name() const noexcept override;
  std::optional<double> dead_man() const noexcept override;
  BaseLimits limits() const noexcept override;
  void send(const Twist& command, double expires) noexcept override;
  void stop() noexcept override;
  BaseReport report() noexcept override;

  /// A pose that the robot is told: where there is no odometry, its newest word.
  void add_pose(double stamp, const Eigen::Isometry3d& T_WB);
  /// What is published on the topic of the emergency stop; null: there is no such topic.
  const EmergencyStopInput* emergency_stop() const;
  /// `time` [s] of the runtime's clock as a stamp of the robot's. Before the offset has settled,
  /// of this machine's time of day.
  ros::Time ros_time(double time) const;
  /// Pose of the base in the frame odom by its odometry, or by its twists from where it began, at
  /// `time` [s] of the runtime's clock: the one whose stamp is nearest, of the newest 2 s. None:
  /// none has come.
  std::optional<Eigen::Isometry3d> odometry(double time) const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;  // shared with the handlers
};

}  // namespace prospect
