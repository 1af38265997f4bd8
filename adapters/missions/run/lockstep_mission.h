// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "engine/safety/guard.h"
#include "runtime/lockstep_robot.h"
#include "runtime/truth.h"

namespace prospect {

/// What is known of a robot in lockstep besides.
struct LockstepRun {
  std::string name;                          ///< for records
  Truth* truth = nullptr;                    ///< null: nobody knows
  const ReachableArea* reachable = nullptr;  ///< null: nobody knows it
};

/// A mission in lockstep (run_mission()) on a robot, whatever its adapter: planner, guard and the
/// records. `configuration` is the one in effect; limits those of the guard. Throws what the
/// constructors throw, before ExplorationRunOptions::observers is asked, and what run_mission()
/// does.
ExplorationRunResult lockstep_mission(LockstepRobot& robot, const LockstepRun& run,
                                      const Configuration& configuration,
                                      const Guard::Options& limits,
                                      const ExplorationRunOptions& options);

}  // namespace prospect
