// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "adapters/robots/dds/dds_base.h"
#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/dds_options.h"
#include "adapters/robots/dds/dds_transforms.h"
#include "models/types.h"
#include "runtime/frame_sink.h"

namespace prospect {

/// Where a robot behind topics of ROS 2 is, as something else tells it: handed on with
/// the stamps of its measurements, and to its base, if one is given.
///
/// By tf: frames.base in frames.map, at the newest stamp that all between them is known at, each
/// time that one comes. By a topic: poses in frames.map, of pose.frame; where that is not
/// frames.base, tf must know where it is on the body. The covariance of (x, y, yaw) is that of the
/// message, carried over to B; where none is told, or zero, it is of pose.sigma and pose.sigma_yaw.
///
/// Where tf knows frames.base in frames.odom, that goes with each pose: so a jump of the pose which
/// the odometry did not make is a correction of the map (pose_jump.h), as map -> odom that is told
/// anew.
///
/// A message with another frame, without a stamp, or that is no pose is left out, and is a fault of
/// its topic (DdsNode::fault()). Declares its topics on the node: make it before DdsNode::start().
/// `frames`, transforms, base and node must outlive it, and the first three the node's thread.
/// Thread-safety: any thread.
class DdsPose {
 public:
  DdsPose(const DdsOptions& options, DdsNode& node, DdsTransforms& transforms, FrameSink& frames,
          DdsBase* base = nullptr);
  ~DdsPose();

  /// Waits for the first pose. Throws InputError, one line, if none comes within options.timeout.
  Pose wait() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;  // shared with the handlers
};

}  // namespace prospect
