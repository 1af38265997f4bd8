// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adapters/missions/config/registries.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/program/cli/configuration_arguments.h"
#include "adapters/robots/dds/dds_options.h"
#include "runtime/user_robot.h"

namespace CLI {
class App;
}

namespace prospect {

class SignalGuard;

struct ExploreArguments {
  std::string world = "office";
  ConfigurationArguments configuration;
  std::uint64_t seed = 1;
  std::string out;          ///< run folder; empty: runs/WORLD_SOLVER_SEED
  bool overwrite = false;   ///< also a drive that it holds
  bool log = false;         ///< mission.mcap in the run folder; drive always writes it
  bool log_images = false;  ///< with the cameras' images in it
  std::optional<int> live;  ///< port of the live view; none: there is none
  std::string live_host = "127.0.0.1", live_token;  ///< LiveOptions
  int save_problems = 0;  ///< write the problem of every so manyeth planning step; 0: none
  bool check = false;     ///< of a mission in real time: look at the robot, and end
  bool json = false;
  bool quiet = false;
  std::string command_line;  ///< as typed, for the run folder
};

/// What drives the robot of a mission.
struct MissionBase {
  bool gazebo = false;              ///< the Gazebo that runs, in real time; else the simulator
  bool lockstep = false;            ///< that Gazebo is stepped, instead
  bool measure = false;             ///< Gazebo's truth measures, against arguments.world
  std::optional<DdsOptions> dds;    ///< a robot behind topics of ROS 2, in real time
  const UserRobot* user = nullptr;  ///< the program's own, in real time; null: none
  /// Faults of the robot, in real time; none: the simulator in lockstep.
  std::optional<RealTimeRun> real_time;

  bool in_real_time() const { return gazebo || dds || real_time; }
  bool knows_world() const { return !dds && !user && (!gazebo || measure); }
};

/// What explore, drive and a user's robot take alike, and what is of worlds, for the first two.
/// arguments outlives the command line.
void add_mission_options(CLI::App* command, ExploreArguments& arguments);
void add_world_options(CLI::App* command, ExploreArguments& arguments);
/// --check, of a mission in real time.
void add_check_option(CLI::App* command, ExploreArguments& arguments);
/// --fault, for what may break.
void add_fault_option(CLI::App* command, std::vector<std::string>& faults);
/// Throws InputError, one line, for one that cannot be.
std::vector<InjectedFault> parsed_faults(const std::vector<std::string>& faults);

/// A mission, its run folder and summary. Returns the exit code.
int mission(const ExploreArguments& arguments, const Registries& registries,
            const MissionBase& base, SignalGuard& signals);

}  // namespace prospect
