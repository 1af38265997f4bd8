// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "engine/planner/replanner.h"
#include "engine/safety/guard.h"
#include "runtime/mission.h"
#include "runtime/robot.h"

namespace prospect {

class RunRecorder;

/// A mission in real time on a robot, whatever its adapter: perception of its own unless the robot
/// has one, planner, guard, range stop, pre-flight (run_preflight()), a Driver, and the
/// records. `configuration` is the one in effect; limits those of the guard; reachable null: nobody
/// knows it. A robot that fails a check does not move: the mission ends as MissionEnd::kNotFit, and
/// says which check.
///
/// Throws what the constructors throw, before ExplorationRunOptions::observers is asked, and what
/// Driver::run() does.
ExplorationRunResult live_mission(const Robot& robot, const Configuration& configuration,
                                  const Guard::Options& limits, const ReachableArea* reachable,
                                  const ExplorationRunOptions& options);

/// What a robot tells of itself goes into its configuration. Throws InputError for what does not
/// fit it, std::invalid_argument as check_drives() does.
void take_settings(const Robot& robot, Configuration& configuration);

/// drive.inbox, with what the robot can do at most: beyond, a pose from outside has jumped.
SensorInboxOptions inbox_of(const Configuration& configuration);

/// Those of the configuration, with what is enough by what is true.
MissionOptions mission_options_for(const Configuration& configuration);

/// Asks ExplorationRunOptions::observers; they and the recorder watch the mission.
void start_records(RunRecorder& recorder, const Configuration& configuration,
                   const ExplorationRunOptions& options, MissionOptions& mission);

/// The planner that the options make, or ours with the configured solver, whose steps
/// options.cancelled cuts short: asked on its thread, too. Throws std::invalid_argument for an
/// unknown solver.
std::unique_ptr<Replanner> planner_for(const Configuration& configuration,
                                       const ExplorationRunOptions& options);

/// Throws std::invalid_argument unless the model drives on the ground, and what its sensor measures
/// fits the map (simulator_misfit()).
void check_drives(const Configuration& configuration);

}  // namespace prospect
