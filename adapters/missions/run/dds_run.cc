// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/dds_run.h"

#include "adapters/missions/run/live_mission.h"
#include "adapters/robots/dds/make_robot.h"

namespace prospect {

ExplorationRunResult explore_dds(const Configuration& given, const DdsOptions& topics,
                                 const ExplorationRunOptions& options) {
  check_drives(given);
  Configuration c = given;
  SensorInboxOptions inbox = inbox_of(c);
  // What tf connects is of one clock.
  inbox.one_clock = inbox.one_clock || !topics.has_stereo();
  DdsRobotConfiguration made{
      .topics = topics, .robot = c.robot, .inbox = inbox, .requests = options.requests};
  if (options.real_time) made.faults = options.real_time->faults;
  const Robot robot = make_robot(made);
  take_settings(robot, c);
  return live_mission(robot, c, c.guard, nullptr, options);
}

}  // namespace prospect
