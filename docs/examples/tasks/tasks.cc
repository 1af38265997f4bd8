// SPDX-License-Identifier: Apache-2.0
// What a robot is told between two plans: tasks, and zones on its ground.
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "engine/planner/planner.h"
#include "engine/safety/guard.h"
#include "models/unicycle.h"
#include "solvers/registry.h"

int main() {
  prospect::RobotDescription robot;
  robot.model = std::make_shared<prospect::Unicycle>();
  prospect::Planner planner(robot, prospect::PlannerParameters(), prospect::make_solver("nlopt"));
  prospect::Guard guard = planner.make_guard();

  std::string fault = planner.set_task(prospect::Task::go_to({14.0, 5.5}, M_PI));  // "": taken
  if (fault.empty()) std::printf("task: %s\n", to_string(planner.task().kind).data());
  planner.set_task(prospect::Task::hold());             // pause: brakes and stays
  planner.set_task(prospect::Task::explore());          // resume: what was learned is kept
  planner.set_task(prospect::Task::return_to_start());  // to the pose of the first plan
  std::printf("task: %s\n", to_string(planner.task().kind).data());

  prospect::Zones zones;
  zones.keep_out = {{{7, 5}, {8, 5}, {8, 6}, {7, 6}}};
  fault = planner.set_zones(zones);
  guard.set_zones(std::make_shared<const prospect::ZoneMap>(zones));  // the guard asks for itself
  std::printf("zones: %s\n", fault.empty() ? "taken" : fault.c_str());

  zones.keep_out = {{{7, 5}, {8, 5}}};  // no polygon
  fault = planner.set_zones(zones);
  std::printf("zones: %s\n", fault.empty() ? "taken" : fault.c_str());
  return fault.empty() ? 1 : 0;
}
