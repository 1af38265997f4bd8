#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "engine/behaviour/behaviour.h"
#include "engine/maps/belief.h"
#include "engine/planner/replanner.h"
#include "runtime/drive_requests.h"
#include "runtime/mission.h"

namespace prospect {

/// Whether a mission is over, and how it ended: the rules of all that drive one, in lockstep or in
/// real time. Times are of the robot's clock [s]. Thread-safety: one thread. Does not throw, unless
/// MissionOptions::missing does.
///
/// An end whose outcome is "done" needs evidence: that of the planner (behaviour.h), nothing that
/// is missing, a path back that was driven. A mission that has not moved says what the certificate
/// refused.
///
/// With return_when_done the path back begins once what is left of the time limit is no more than
/// what it takes (Replanner::return_path()). It is asked for again after a third of what is left
/// beside it, at most every kAskEvery: a robot drives no faster than twice as fast as return_path()
/// counts on.
class MissionProgress {
 public:
  /// options outlives it.
  MissionProgress(const MissionOptions& options, double start);

  /// Before a planning step: whether it is over because it was cancelled, time is up, or
  /// localization does not come back.
  bool over_before(const Belief& belief, double now, bool cancelled);
  /// After a planning step: counts it and says whether it is over because the task is. Where the
  /// robot is to return then, `planner` is told to, once, and it is not over yet.
  bool over_after(const MissionStep& step, Replanner& planner);

  /// Takes the place that people have asked for since the call before, if any: the planner is told
  /// to go there, and the robot to drive. At the end of that way over_after() tells it to stand and
  /// the planner to go on with the task.
  void take_detour(DriveRequests& requests, Replanner& planner);

  MissionResult result;

  static constexpr double kAskEvery = 15.0;  ///< [s]

 private:
  bool over(MissionEnd end, std::string detail);
  bool turned_back(const MissionStep& step, Replanner& planner);
  bool begin_return(Replanner& planner);

  const MissionOptions& options_;
  DriveRequests* detour_ = nullptr;  // whose path the robot is on; null: nobody's
  double start_;
  double last_localized_;
  std::optional<Eigen::Vector2d> began_at_;  // in W [m]
  double strayed_ = 0.0;                     // [m] farthest from there
  std::string refused_;                      // newest refusal of the certificate
  std::string missing_;                      // of MissionOptions::missing
  double ask_return_path_at_ = 0.0;          // [s] since the start
};

}  // namespace prospect
