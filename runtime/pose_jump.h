// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <limits>
#include <optional>
#include <string>

#include "perception/pipeline/perception_pipeline.h"

namespace prospect {

class Knobs;

struct PoseJumpOptions {
  double distance = 0.2;  ///< [m] of a pose beyond what the robot can have driven
  double turn = 0.2;      ///< [rad] likewise
  // The most that the robot does [m/s], [rad/s]; infinite: nothing is a jump.
  double speed = std::numeric_limits<double>::infinity();
  double yaw_rate = std::numeric_limits<double>::infinity();
};
/// The knobs (models/knobs.h) of `distance` and `turn`; what the robot does is its model's.
void describe(Knobs& knobs, PoseJumpOptions& options);

/// Notices poses that no motion of the robot explains: a localization that corrects itself or goes
/// wrong, or two that speak in turns.
///
/// A pose at t has jumped if, against one at s of the 0.5 s before it,
///   |p_t - p_s| > distance + 1.5 speed (t - s)   or   |yaw_t - yaw_s| > turn + 1.5 yaw_rate (t -
///   s)
/// in the plane. So a correction that is spread over several poses is one, too. The next poses are
/// compared with it and those after it alone.
///
/// Where both tell where odometry alone has the robot (ExternalPose::T_OB), and that has not jumped
/// so, the map was corrected: that is no jump, and counted in ExternalPose::corrections.
///
/// Thread-safety: one thread. Never throws; a pose that is not finite is not compared.
class PoseJumpWatch {
 public:
  explicit PoseJumpWatch(const PoseJumpOptions& options) : options_(options) {}

  /// Sets pose.jumps and pose.corrections. Stamps are of one clock. Returns "by 0.83 m and 0.02 rad
  /// in 0.10 s"; empty: it has not jumped.
  std::string add(ExternalPose& pose);

 private:
  struct Seen {
    double stamp = 0.0;
    Pose pose;
    std::optional<Pose> by_odometry;
  };
  bool apart(const Pose& a, const Pose& b, double dt) const;
  PoseJumpOptions options_;
  std::deque<Seen> seen_;
  PoseJumps jumps_;
  int corrections_ = 0;
};

}  // namespace prospect
