// SPDX-License-Identifier: Apache-2.0
#include "engine/task/task.h"

#include <cmath>
#include <cstdio>

#include "models/types.h"

namespace prospect {
namespace {

std::string metres(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f m", value);
  return text;
}

}  // namespace

std::vector<std::string> faults(const Task& task, const ZoneMap* zones, double room) {
  std::vector<std::string> list;
  if (task.kind == TaskKind::kExplore && task.area) {
    if (const std::string fault = polygon_fault(*task.area); !fault.empty()) {
      list.push_back("area: " + fault);
    }
  }
  if (!has_goal(task.kind)) return list;
  const Goal& goal = task.goal;
  const auto in = [](double value, double low, double high) {
    return value >= low && value <= high;
  };
  if (!in(goal.position_tolerance, 0.05, 10.0)) {
    list.push_back("goal: position_tolerance is " + std::to_string(goal.position_tolerance) +
                   " m; expected 0.05 to 10 m");
  }
  if (!in(goal.yaw_tolerance, 0.02, M_PI)) {
    list.push_back("goal: yaw_tolerance is " + std::to_string(goal.yaw_tolerance) +
                   " rad; expected 0.02 to pi");
  }
  if (task.kind != TaskKind::kGoTo) return list;
  if (goal.yaw && !std::isfinite(*goal.yaw)) {
    list.push_back("goal: the yaw is not finite; expected a finite angle");
  }
  if (!goal.position.allFinite() || !(goal.position.cwiseAbs().maxCoeff() < kFarthest)) {
    list.push_back("goal: is not finite or beyond 1000 km; expected a place within");
    return list;
  }
  for (int part = 0; zones != nullptr && part < zones->num_forbidden(); ++part) {
    const double distance = zones->distance(part, goal.position);
    if (distance >= room) continue;
    const bool bound = zones->zones().bound && part == 0;
    const std::string where =
        distance > 0.0 ? "is " + metres(distance) + " from " + zones->name(part)
                       : (bound ? "is beyond " + zones->name(part) : "is in " + zones->name(part));
    list.push_back("goal: " + where + "; expected at least " + metres(room) +
                   " of room, the robot's radius and its margin");
  }
  return list;
}

}  // namespace prospect
