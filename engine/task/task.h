// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "engine/behaviour/task_kind.h"
#include "engine/task/polygon.h"
#include "engine/task/zone_map.h"

namespace prospect {

/// A place to go to, in the map's frame (engine/maps/correction.h), and how near to it is there.
struct Goal {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< of B's origin [m]
  std::optional<double> yaw;                           ///< [rad]; none: any heading
  double position_tolerance = 0.15;                    ///< [m], 0.05 to 10
  double yaw_tolerance = 0.15;                         ///< [rad], 0.02 to pi
};

/// What a robot is told to do, until it is told something else. A value.
struct Task {
  TaskKind kind = TaskKind::kExplore;
  /// kExplore: only frontiers in here are driven to (the path there may lead outside); none: all.
  std::optional<Polygon> area;
  /// kGoTo: where to. kReturn: tolerances; the place is where the first plan was made.
  Goal goal;

  static Task explore(std::optional<Polygon> area = std::nullopt) {
    Task task;
    task.area = std::move(area);
    return task;
  }
  static Task go_to(const Eigen::Vector2d& position, std::optional<double> yaw = std::nullopt) {
    Task task;
    task.kind = TaskKind::kGoTo;
    task.goal.position = position;
    task.goal.yaw = yaw;
    return task;
  }
  static Task return_to_start() {
    Task task;
    task.kind = TaskKind::kReturn;
    return task;
  }
  static Task hold() {
    Task task;
    task.kind = TaskKind::kHold;
    return task;
  }
};

/// One line a fault, "goal: is 0.05 m from zones.keep_out[1]; expected at least 0.20 m, ...";
/// empty: usable. zones: null: none. room [m]: what the body needs about its origin.
std::vector<std::string> faults(const Task& task, const ZoneMap* zones, double room);

}  // namespace prospect
