#pragma once

#include <memory>
#include <string>

#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/missions/run/run_record.h"
#include "adapters/robots/simulator/simulated_base.h"
#include "runtime/mission.h"

namespace prospect {

class Planner;

/// Turns what a mission shows of each planning step into records, whatever drives the robot: calls
/// ExplorationRunOptions::on_step and on_plan, and sums up at the end. What is not known to be true
/// is NaN in SimulatedTruth. Thread-safety: one thread at a time. Throws what those two throw.
class RunRecorder {
 public:
  /// All of it outlives this. `planner`: the Planner that plans; null: another one does. Throws
  /// InputError if steps are kept and the codecs of their pictures cannot be loaded.
  RunRecorder(const Configuration& configuration, const ExplorationRunOptions& options,
              const Planner* planner);
  ~RunRecorder();

  /// After each planning step, with what is true then.
  void add(const MissionStep& step, const SimulatedTruth& truth);
  /// Once, at the end. reachable: null: nobody knows the world.
  RunRecord finish(const MissionResult& mission, const std::string& world,
                   const SimulatedTruth& truth, const ReachableArea* reachable);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
