// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/formats/worlds/world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/run_observer.h"
#include "adapters/missions/run/run_record.h"
#include "adapters/robots/faults/injected_fault.h"
#include "adapters/robots/simulator/simulator_options.h"
#include "engine/maps/belief.h"
#include "engine/planner/replanner.h"
#include "engine/safety/guard.h"
#include "models/types.h"
#include "runtime/drive_requests.h"
#include "runtime/driver.h"
#include "runtime/event_log.h"
#include "runtime/health_report.h"
#include "runtime/preflight.h"

namespace octomap {
class OcTree;
}

namespace prospect {

class SolverRegistry;

/// A mission in real time, by threads, instead of in lockstep (driver.h), driven by
/// Configuration::drive.
struct RealTimeRun {
  std::vector<InjectedFault> faults;  ///< of the robot, whatever it is
};

/// One simulated mission: world, configuration and seed in, records out.
struct ExplorationRunOptions {
  std::uint64_t seed = 1;
  bool keep_steps = true;  ///< keep every StepRecord in the result, for the report
  /// Who watches the mission; they outlive it. Asked once, when all that the input could be refused
  /// for has been made, before the first step, with the configuration in effect: of another base
  /// than the simulator, the robot with the cameras that it has there. What it throws ends the run.
  /// Empty: nobody watches.
  std::function<std::vector<RunObserver*>(const Configuration&)> observers;
  std::function<bool()> cancelled;
  DriveRequests* requests = nullptr;  ///< what people ask of the mission; null: nobody
  /// Makes the planner; empty: the Planner of this project with the configured solver.
  std::function<std::unique_ptr<Replanner>(const Configuration&)> make_planner;
  /// Where the configured solver is looked up; null: among those built in.
  const SolverRegistry* solvers = nullptr;
  /// Empty: in lockstep, as fast as the machine is. Else nothing is
  /// reproducible.
  std::optional<RealTimeRun> real_time;
  /// Of a mission in real time: the checks before the first motion, but for those that move the
  /// robot, and no more; nobody watches.
  bool checks_only = false;
};

struct ExplorationRunResult {
  RunRecord record;
  std::shared_ptr<const octomap::OcTree> map;  ///< as built, in the estimated frame
  std::string complaint;  ///< of the simulated sensors at the end: why they cannot be trusted
  // Of a run in real time.
  std::optional<DriverStatus> driver;  ///< at the end
  std::optional<HealthReport> health;  ///< at the end
  /// Of a simulation that somebody else runs: its seconds in one of the machine.
  std::optional<double> real_time_factor;
  /// [s] of the runtime's clock from which the times of injected faults count, of Gazebo.
  std::optional<double> faults_start;
  std::vector<CheckResult> preflight;
  std::vector<Event> events;
};

/// Where the robot of this configuration can stand and what it can see from there, in this world,
/// by the planner's rule for what is passable. Throws as reachable_area(world, options) and
/// frontier_planner_options_for().
ReachableArea reachable_area(const World& world, const Configuration& configuration);

/// Where it has ample room to stand (BodySlice::standing_clearance, of forbidden parts, too),
/// joined to the world's start by such columns.
Grid<std::uint8_t> roomy_columns(const World& world, const Configuration& configuration);
/// Throws InputError, naming the zone, if the body at the world's start reaches into a forbidden
/// part.
void check_start(const World& world, const Configuration& configuration);
/// Where the world ends, for the planner: nothing beyond can be reached.
void tell_extent(const World& world, Configuration& configuration);
/// What of that area counts: within the area of the task, if it has one, and in no forbidden part.
ReachableArea told_area(ReachableArea reachable, const Configuration& configuration);

/// How load_world() must look for a start that this configuration's robot can take.
WorldOptions world_options_for(const Configuration& configuration);
/// The world of a mission, as configured. Throws InputError as load_world(), and for keys that were
/// told and that nothing reads in such a world (refuse_unread()).
std::shared_ptr<const World> mission_world(
    const std::string& name, const Configuration& configuration, ConfigurationUse use,
    const std::function<void(const std::string& what)>& progress = {});

/// The simulator's options for a mission with this seed, with the map it begins with. Throws
/// InputError for a map that cannot be read or has another resolution.
SimulatorOptions simulator_options_for(const Configuration& configuration, std::uint64_t seed);

/// The limits of the guard of a simulated mission. A sensor that delivers seldom is not dead: two
/// of its periods may pass.
Guard::Options guard_limits_for(const Configuration& configuration);

/// Runs one mission in the kinematic simulator, to its end. Throws InputError if the robot cannot
/// start there, std::invalid_argument for an unknown solver or options out of range, all before
/// observers are asked for. In lockstep deterministic but for wall-clock times.
ExplorationRunResult run_exploration(const std::shared_ptr<const World>& world,
                                     const Configuration& configuration,
                                     const ExplorationRunOptions& options);

}  // namespace prospect
