// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "adapters/robots/dds/dds_base.h"
#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/dds_options.h"
#include "models/motion_model.h"
#include "runtime/clock.h"
#include "runtime/drive_requests.h"
#include "runtime/mission.h"

namespace prospect {

/// What a mission tells the other nodes, transforms with each belief, all else after each planning
/// step:
///
///   path         nav_msgs/msg/Path              the states of the plan
///   map          nav_msgs/msg/OccupancyGrid     the ground map: 0 free, 100 occupied, -1 unknown
///   octomap      octomap_msgs/msg/Octomap       the octree, three states
///   /tf          tf2_msgs/msg/TFMessage         map -> odom, and odom -> base if asked for
///   markers      visualization_msgs/msg/MarkerArray   target, plan, landmarks
///   diagnostics  diagnostic_msgs/msg/DiagnosticArray  what the robot does and why, topics; once a
///                                               second the drive mode and what became of goals
///   state        diagnostic_msgs/msg/DiagnosticStatus  the drive mode, its cause, and why
///
/// Stamps are of the robot's clock (DdsBase::ros_time()). Without odometry there is no map -> odom.
/// Maps go out every output.map_period.
///
/// Declares its topics on the node: make it before DdsNode::start(). Base, node and clock must
/// outlive it. Thread-safety: as MissionObserver; both throw only if memory is used up.
class DdsPublisher final : public MissionObserver {
 public:
  DdsPublisher(const DdsOptions& options, DdsNode& node, const DdsBase& base, const Clock& clock,
               std::shared_ptr<const MotionModel> model, const DriveRequests& requests);
  ~DdsPublisher() override;

  void on_belief(const Belief& belief) override;
  void on_step(const MissionStep& step) override;
  void on_status(const DriverStatus& status, const HealthReport& health) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
