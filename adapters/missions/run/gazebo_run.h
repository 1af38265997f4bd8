// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "adapters/formats/worlds/world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"

namespace prospect {

/// A mission in the Gazebo that runs, in real time (options.real_time), or in one that stands and
/// is stepped by the mission, in lockstep (stepped_gazebo.h); with this project's own perception:
/// stereo pairs, depth images and wheel motion become the belief. Of what Gazebo knows to be true
/// the pose at the start is taken, and nothing else: the robot begins with that pose, and with the
/// place that its body takes up free, as of a robot that was put down where there is room.
///
/// measured: null, or the world that Gazebo runs, as World: then the truth measures, and what the
/// robot has seen, how far its estimate is off, and contacts are in the records; else they are
/// unknown there (Summary::measured).
///
/// Time is that of the simulation (SimulationClock). Throws before observers are asked for:
/// InputError, one line, if no Gazebo answers, it has no such robot, or says nothing of it;
/// NotBuiltIn; std::invalid_argument for an unknown solver or options out of range. The robot has
/// not moved then. Faults of options.real_time are injected, in the time since then.
ExplorationRunResult explore_gazebo(const Configuration& configuration,
                                    const std::shared_ptr<const World>& measured,
                                    const ExplorationRunOptions& options);

}  // namespace prospect
