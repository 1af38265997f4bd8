#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "adapters/config/configuration.h"
#include "adapters/dds/dds_options.h"
#include "runtime/event_log.h"
#include "runtime/mission.h"
#include "runtime/preflight.h"
#include "runtime/real_time_driver.h"

namespace octomap {
class OcTree;
}

namespace prospect {

class SolverRegistry;

struct DdsRunOptions {
  std::function<void(const MissionStep&)> on_step;  ///< on the planner's thread
  std::function<bool()> cancelled;
  /// Where the configured solver is looked up; null: among those built in.
  const SolverRegistry* solvers = nullptr;
};

struct DdsRunResult {
  MissionResult mission;
  DriverStatus driver;
  std::vector<CheckResult> preflight;  ///< before the first motion
  std::vector<Event> events;
  std::string complaint;            ///< of perception: why its sensors cannot be trusted
  std::vector<std::string> faults;  ///< of the topics, at the end
  double path = 0.0;                ///< [m] by the estimate
  std::shared_ptr<const octomap::OcTree> map;
};

/// A mission on a robot behind topics of ROS 2, in real time, with this project's own perception.
/// The robot begins at the origin of W, looking along x, where its body's place is taken to be
/// free. Cameras are as its topics say; the configuration's robot is what else it is.
///
/// Before the first motion the streams must have been live, and the checks of preflight.h that need
/// no motion pass; if one fails, nothing has been sent to the base, and the mission ends at once
/// with what failed in result.mission.detail. Yaw is not turned to be checked, so the robot drives
/// as the drive mode "yaw unchecked" allows.
///
/// Errors: InputError, one line each, before any command is sent: calibrations or transforms that
/// do not come, topics that do not fit; NotBuiltIn; std::invalid_argument for options out of range.
DdsRunResult explore_dds(const Configuration& configuration, const DdsOptions& robot,
                         const DdsRunOptions& options);

}  // namespace prospect
