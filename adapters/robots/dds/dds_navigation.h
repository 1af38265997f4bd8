// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "adapters/robots/dds/dds_base.h"
#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/dds_options.h"
#include "adapters/robots/dds/dds_transforms.h"
#include "runtime/clock.h"
#include "runtime/drive_requests.h"
#include "runtime/mission_observer.h"

namespace prospect {

/// The server of an action nav2_msgs/action/NavigateToPose: a goal is a place that the robot is
/// sent to (DriveRequests::go_to()), of the frames that goal_in_map() takes. A newer goal, from
/// wherever, aborts the one before. Refused are a goal that names a behaviour tree, one while a
/// stop is latched, and one after the mission. A goal that is cancelled ends with the robot held.
///
/// Feedback comes twice a second while it is on the way; `distance_remaining` is that of the
/// straight line, what is not known is zero. Results are kept of the newest 20 goals.
///
/// Its clients must use rmw_cyclonedds (dds_service.h). Declares its topics on the node: make it
/// before DdsNode::start(). All that is given outlives the node's thread. Thread-safety: as
/// MissionObserver.
class DdsNavigation final : public MissionObserver {
 public:
  DdsNavigation(const DdsOptions& options, DdsNode& node, const DdsTransforms& transforms,
                const DdsBase& base, const Clock& clock, DriveRequests& requests);
  ~DdsNavigation() override;

  void on_belief(const Belief& belief) override;
  void on_end(const MissionResult& result) override;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;  // shared with the handlers
};

}  // namespace prospect
