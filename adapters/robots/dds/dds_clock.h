// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/robots/dds/dds_node.h"
#include "runtime/clock.h"
#include "runtime/simulation_clock.h"

namespace prospect {

/// The time that a simulation publishes, rosgraph_msgs/msg/Clock, as nodes of ROS 2 with
/// use_sim_time take it (runtime/simulation_clock.h). It has a node of its own, NAME_clock, so that
/// no image delays it.
///
/// Thread-safety: as Clock. Errors: the constructor throws InputError if no time comes within
/// `timeout` [s], and as DdsNode.
class DdsClock {
 public:
  DdsClock(const DdsAddress& address, const std::string& topic, double timeout);
  const Clock& clock() const { return clock_; }

 private:
  const SteadyClock machine_;
  SimulationClock clock_;
  DdsNode node_;  // its thread ends first
};

}  // namespace prospect
