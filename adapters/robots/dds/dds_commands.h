// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/goal_pose.h"
#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/dds_options.h"
#include "adapters/robots/dds/dds_transforms.h"
#include "runtime/drive_commands.h"

namespace prospect {

/// A goal in frames.map, which is W, by the transforms at its stamp; with a stamp of zero by the
/// newest. Throws InputError, one line, for one that cannot be: of a frame that tf does not
/// connect, not finite, without a rotation, or upright.
ros::FloorGoal goal_in_map(const ros::PoseStamped& pose, const DdsOptions::Frames& frames,
                           const DdsTransforms& transforms, const std::string& name);

/// What people tell the robot by topics and services of ROS 2:
///
///   goal      geometry_msgs/msg/PoseStamped  to go there (goal_in_map())
///   told      std_msgs/msg/String            "hold", "resume", "cancel" or "stop"
///   services  std_srvs/srv/Trigger           NAME/hold, ...: the same, with an answer
///
/// What is refused is told (DriveRequests::refuse()). That a stop is acknowledged is not among
/// them: DdsOptions::acknowledge.
///
/// Declares its topics on the node: make it before DdsNode::start(). Node, transforms and requests
/// outlive the node's thread.
class DdsCommands {
 public:
  DdsCommands(const DdsOptions& options, DdsNode& node, const DdsTransforms& transforms,
              DriveRequests& requests);
};

}  // namespace prospect
