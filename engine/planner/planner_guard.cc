// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/planner_guard.h"

#include <algorithm>
#include <stdexcept>

#include "engine/safety/certificate.h"
#include "engine/task/zone_map.h"

namespace prospect {

Guard guard_for(const RobotDescription& robot, const PlannerParameters& parameters,
                Guard::Options options) {
  if (!robot.model) throw std::invalid_argument("guard: no motion model; expected one");
  Certifier::Options certificate = Certifier::options_for(robot);
  certificate.margin = parameters.guard_margin();
  certificate.unknown = UnknownPolicy::kFree;
  certificate.known_ground = parameters.unknown != UnknownPolicy::kFree;
  certificate.zones = zone_map_of(parameters.zones);
  certificate.seen_floor = parameters.unseen_floor == UnseenFloor::kBlocked;
  certificate.step = parameters.step;
  options.max_step = std::max(options.max_step, parameters.dt);
  return Guard(robot.model, robot.shape, certificate, options);
}

}  // namespace prospect
