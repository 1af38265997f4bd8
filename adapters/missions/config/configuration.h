// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "adapters/formats/files/strict_yaml.h"
#include "adapters/formats/worlds/world_options.h"
#include "adapters/missions/config/key_readers.h"
#include "adapters/missions/config/registries.h"
#include "adapters/robots/gazebo/gazebo_options.h"
#include "adapters/robots/simulator/simulated_base_options.h"
#include "adapters/robots/simulator/simulator_options.h"
#include "engine/planner/planner.h"
#include "perception/pipeline/perception_options.h"
#include "runtime/drive_options.h"
#include "runtime/mission.h"
#include "solvers/registry.h"

namespace prospect {

/// Everything a mission depends on besides its world and seed, as read from a configuration file.
struct Configuration {
  RobotDescription robot;
  PlannerParameters planner;
  PerceptionOptions perception;  ///< cameras, mounts, ranges and start are what the robot has
  SimulatorOptions simulator;
  MissionOptions mission;
  /// How the world is read; slice and what no key names are left to world_options_for().
  WorldOptions world;
  Guard::Options guard;
  DriveOptions drive;                   ///< in real time
  SimulatedBaseOptions simulated_base;  ///< the simulator, in real time
  GazeboOptions gazebo;
  Options base;  ///< what the drivers of a robot of one's own are told
  /// What ends the task as seen: a share of the reachable area, or an area [m^2], as the simulator
  /// really measures them; 0: neither.
  double until_coverage = 0.0, until_area = 0.0;
  /// OctoMap of the same world that the simulated robot begins with; empty: none.
  std::string map;
  std::string solver = "nlopt";
  std::vector<ConfigEntry> entries;  ///< what is in effect, for config.yaml and `prospect config`
  std::vector<std::string> notices;  ///< keys told by the name they had, a line each; for people
};

/// Reads a configuration file; an empty path gives the defaults. Its solver and its
/// terms are some of `registries`. settings stand above the file, the later above the earlier.
/// Throws InputError with every problem at once (file:line: what; expected what).
///
/// The defaults of `perception` are those of a simulated robot (simulated_perception()) where
/// simulator.sensors are cameras and nobody else's robot drives, else those of the structures.
/// A key that the use does not read is refused (refuse_unread()).
Configuration read_configuration(const std::string& path, const Registries& registries = {},
                                 const std::vector<YamlSetting>& settings = {},
                                 ConfigurationUse use = ConfigurationUse::kAny);

/// What reads the keys of a configuration that is used so; of world and topics no more is known.
KeyReader key_reader(const Configuration& configuration, ConfigurationUse use);

/// How a recording is perceived: `perception` of a configuration file and of settings, above
/// `defaults`. What else the file holds is a robot's, and left; settings that the use does not read
/// are refused. `notices`: as of a Configuration. Throws InputError as read_configuration().
PerceptionOptions read_perception(const std::string& path, const std::vector<YamlSetting>& settings,
                                  const PerceptionOptions& defaults, ConfigurationUse use,
                                  std::vector<std::string>* notices = nullptr);

/// Takes the cameras of `robot` and their mounts from who knows them better than the file, and
/// notes them in the entries: the robot is what a reader makes of these, to the bit (angles of at
/// most an ulp more or less). told_by: who that is, in messages. Throws InputError for values out
/// of their range; the configuration is as it was then.
void set_cameras(Configuration& configuration, const RobotDescription& robot,
                 const std::string& told_by);

/// "" if the robot of a sound configuration can be given its task, with these zones, else what is
/// wrong: "goal: is in keep-out 1; expected ...".
std::string task_problem(const Configuration& configuration);

/// "" if the registry knows a back end of that name (built in or not), else what is wrong with it:
/// "unknown solver 'x' (did you mean 'y'?); expected one of: ...".
std::string solver_problem(const std::string& name, const SolverRegistry& solvers);

/// The same as read_configuration() from text; `source` stands for the file's name in messages.
Configuration configuration_from_text(const std::string& text, const std::string& source,
                                      const Registries& registries = {},
                                      const std::vector<YamlSetting>& settings = {});

}  // namespace prospect
