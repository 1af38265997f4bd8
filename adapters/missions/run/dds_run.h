// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/robots/dds/dds_options.h"

namespace prospect {

/// A mission on a robot behind topics of ROS 2, in real time, with this project's own perception.
/// The robot begins at the origin of W, looking along x, or where something else says that it is
/// (DdsOptions::pose_source), with the place that its body takes up free, as of a robot that was
/// put down where there is room. Cameras are as its topics say; the configuration's robot is what
/// else it is, and observers are asked for with both. Nobody knows the world: what is true is
/// unknown in the records (Summary::measured). Each step is published (DdsPublisher).
///
/// Throws before observers are asked for, when nothing has been sent to the base: InputError, a
/// line each, for calibrations and transforms that do not come, and topics that do not fit;
/// NotBuiltIn; std::invalid_argument for an unknown solver or options out of range.
/// Faults of options.real_time are injected, in the time since the robot was made.
ExplorationRunResult explore_dds(const Configuration& configuration, const DdsOptions& robot,
                                 const ExplorationRunOptions& options);

}  // namespace prospect
