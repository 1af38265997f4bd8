#pragma once

#include <optional>

#include "adapters/cli/commands.h"
#include "adapters/dds/dds_options.h"
#include "adapters/run/exploration_run.h"

namespace prospect {

/// What drives the robot of a mission.
struct MissionBase {
  bool gazebo = false;            ///< the Gazebo that runs, in real time; else the simulator
  bool measure = false;           ///< Gazebo's truth measures, against arguments.world
  std::optional<DdsOptions> dds;  ///< a robot behind topics of ROS 2, in real time
  /// Faults of the simulator or Gazebo, in real time; none: the simulator in lockstep.
  std::optional<RealTimeRun> real_time;

  bool in_real_time() const { return gazebo || dds || real_time; }
};

/// A mission, its run folder and summary. Returns the exit code.
int mission(const ExploreArguments& arguments, const Registries& registries,
            const MissionBase& base);

}  // namespace prospect
