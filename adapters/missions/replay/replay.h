// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "adapters/formats/worlds/world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/replay/recorded_run.h"
#include "adapters/missions/run/run_record.h"

namespace prospect {

/// Both plans of a planning step, made from the same belief.
struct ReplayedStep {
  StepRecord recorded;  ///< what drove the robot
  StepRecord other;     ///< what the other planner would do; it drives nothing
};

struct ReplayOptions {
  int from = 0;         ///< first planning step that is reported
  int to = 2147483647;  ///< the last; the mission is driven no farther
  const SolverRegistry* solvers = nullptr;
  std::function<void(const StepRecord&)> progress;
  std::function<bool()> cancelled;
};

/// A mission driven again, and beside it another planner that is asked with the same beliefs from
/// its first step on. Open loop: the other plans are not driven, so what they would have led to is
/// not seen, and the other planner's own past is that of the recorded mission.
struct Replay {
  RunRecord record;  ///< of the mission that was driven: map, robot, zones; its steps are below
  std::vector<ReplayedStep> steps;
  /// Where the mission that is driven now parts from the recorded one: `steps` end before it.
  RunDifference difference;
};

/// `other`: the configuration of the other planner; of it, only robot, planner and solver count.
/// Throws as run_exploration().
Replay replay_beside(const RecordedRun& recorded, const std::shared_ptr<const World>& world,
                     const Configuration& configuration, const Configuration& other,
                     const ReplayOptions& options);

/// A row a step: step, time, then of both plans, recorded_ and other_: cost, each term weighted,
/// violation, plan_ms, evaluations, predicted features, kind, mode, seed, certified; the tracked
/// features of the next step; how far the ends of both horizons are apart [m]; and `open_loop`,
/// which is 1 in each: no other plan was driven. Times of planning last.
std::string replay_csv(const Replay& replay);

}  // namespace prospect
