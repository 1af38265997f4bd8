// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/lockstep_mission.h"

#include <memory>

#include "adapters/missions/run/live_mission.h"
#include "adapters/missions/run/run_recorder.h"
#include "engine/planner/planner_guard.h"
#include "runtime/mission.h"

namespace prospect {

ExplorationRunResult lockstep_mission(LockstepRobot& robot, const LockstepRun& run,
                                      const Configuration& configuration,
                                      const Guard::Options& limits,
                                      const ExplorationRunOptions& options) {
  const std::unique_ptr<Replanner> planner = planner_for(configuration, options);
  const Guard guard = guard_for(configuration.robot, configuration.planner, limits);
  RunRecorder recorder(configuration, options.seed, options.keep_steps);
  MissionOptions mission = mission_options_for(configuration);
  mission.cancelled = options.cancelled;
  mission.truth = run.truth;
  start_records(recorder, configuration, options, mission);
  robot.watched_by(mission.observers);
  const MissionResult end = run_mission(robot, *planner, guard, mission, options.requests);
  ExplorationRunResult result;
  result.record = recorder.finish(end, run.name, run.truth, run.reachable);
  result.map = robot.sense()->octree;
  result.complaint = robot.complaint();
  return result;
}

}  // namespace prospect
