// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "adapters/missions/config/configuration.h"
#include "runtime/mission_end.h"

namespace prospect {

/// BARN's task: from its start to within kBarnReach of its goal, before time is up, without a
/// contact. Source: Perille et al., "Benchmarking metric ground navigation" (2020), and the
/// simulated challenge at ICRA 2022.
inline constexpr double kBarnReach = 1.0;  ///< [m]

/// Length [m] of the way from start to goal by the reference path of a world: a NumPy file (.npy,
/// version 1, integers or doubles, n x 2) of cells (column, row) of 0.15 m, of which cell (c, r) is
/// at (0.15 c - 4.575, 0.15 r + 5.075). Throws InputError for a file that is not one.
double barn_path_length(const std::string& file, const Eigen::Vector2d& start,
                        const Eigen::Vector2d& goal);

/// s * OT / clip(AT, 4 OT, 8 OT): at most 0.25. OT: `length` [m] at 2 m/s; time: AT [s]; none: the
/// robot failed, 0.
double barn_metric(double length, const std::optional<double>& time);

/// When a robot is where, for its time.
struct TimedPlace {
  double time = 0.0;  // [s]
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
};

/// [s] from when the robot has left its start by 0.1 m until it is within kBarnReach of the goal,
/// straight from each place to the next; none: it does not get there.
std::optional<double> barn_time(const std::vector<TimedPlace>& way, const Eigen::Vector2d& goal);

struct BarnOutcome {
  MissionEnd end = MissionEnd::kTimeLimit;
  int contacts = 0;
  std::optional<double> time{};  ///< barn_time(), of a robot that touched nothing
  double length = 0.0;           ///< barn_path_length() [m]
  double metric = 0.0;
  double driven = 0.0;        ///< [m]
  double longest_step = 0.0;  ///< [s] of the planner, by the wall
};

/// Drives the task that `configuration` holds (benchmarks/barn.yaml) in a world of BARN, in
/// lockstep or in real time. Throws as load_world() and run_exploration().
BarnOutcome drive_barn(const std::string& world, const std::string& path,
                       const Configuration& configuration, bool real_time);

}  // namespace prospect
