// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/dds_options.h"
#include "runtime/link.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

/// [s] of odometry that is silent, a fault of the base.
inline constexpr double kOdometrySilence = 0.5;

/// The contracts of a robot behind topics of ROS 2, those of topics that it has, and of the
/// emergency stop. What is published for people alone has none.
std::vector<Link> dds_links(const DdsOptions& options, const SensorInboxOptions& inbox = {});

/// Whether the publishers and messages of topics are as their contracts say. What is not so for a
/// moment, as while a node starts anew, does not count.
///
/// Make it before DdsNode::start(); the node outlives it. Thread-safety: one thread.
class DdsLinkWatch {
 public:
  DdsLinkWatch(std::vector<Link> links, DdsNode& node);

  /// What is a fault of the base at `now` [s], a line each: "/cmd_vel: published by /prospect (this
  /// program), /teleop; expected one publisher". What a source's age or the emergency stop's own
  /// contract answers is not among it.
  std::vector<std::string> faults(double now);

 private:
  const std::vector<Link> links_;
  DdsNode& node_;
  std::map<std::string, double> doubled_since_;  // [s], of topics
};

}  // namespace prospect
