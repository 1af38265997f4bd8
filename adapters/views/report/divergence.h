// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "adapters/missions/run/run_record.h"
#include "adapters/views/report/step_table.h"

namespace prospect {

/// What two runs are compared by: an entry a planning step, NaN or "" where there is none.
struct DrivenSteps {
  std::vector<double> time;                ///< [s] since the start, ascending
  std::vector<std::string> mode;           ///< what the robot does
  std::vector<double> target_x, target_y;  ///< where the frontiers want it [m]
  std::vector<double> v, vy, omega;        ///< the command [m/s, rad/s]
  std::vector<double> x, y, yaw;           ///< the estimated pose [m, rad]
};
/// Of steps.csv. Throws InputError if time or pose are missing, or a field holds no number.
DrivenSteps driven_steps(const StepTable& table);
DrivenSteps driven_steps(const std::vector<StepRecord>& steps);

/// Where two runs part. A step of the first is compared with the newest of the second at its time,
/// in this order: mode, target, command, estimated pose.
struct Divergence {
  /// What is taken for equal [m, m/s, rad, rad/s], so that another compiler's rounding is no
  /// difference.
  static constexpr double kEqual = 1e-3;
  static constexpr double kApart = 0.5;  ///< [m]
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  int step = -1;          ///< of the first run; -1: as long as both last they are the same
  double time = kNever;   ///< [s] of it
  std::string what;       ///< "mode: explore, retreat", of the first and of the second
  double apart = kNever;  ///< [s] when the robots are kApart from each other for the first time
};
Divergence first_divergence(const DrivenSteps& first, const DrivenSteps& second);

}  // namespace prospect
