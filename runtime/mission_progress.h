// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>

#include "engine/behaviour/behaviour.h"
#include "engine/maps/belief.h"
#include "engine/planner/replanner.h"
#include "runtime/drive_requests.h"
#include "runtime/mission.h"

namespace prospect {

/// Commands that the guard turned into stops since the step before.
struct GuardStops {
  int count = 0;
  GuardReason reason = GuardReason::kPassed;  ///< of the last of them
};

/// A mission's planning steps, and whether it is over: the same for all that drive one, in lockstep
/// or in real time. A step is over_before(), plan(), over_after(); its observers are told of each
/// call of the planner. Times are of the robot's clock [s]. Thread-safety: one thread. Does not
/// throw, unless MissionOptions::missing or on_step() of an observer do.
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
  /// options and planner outlive it.
  MissionProgress(const MissionOptions& options, Replanner& planner, double start);

  /// Before a planning step: whether it is over because the robot has fallen, it was cancelled,
  /// time is up, or localization does not come back.
  bool over_before(const Belief& belief, double now, bool cancelled);
  /// Replanner::prepare() with that belief.
  void prepare(const Belief& belief);
  /// Replanner::go_on().
  bool go_on(double seconds) { return planner_.go_on(seconds); }
  /// The plan that begins as `from` says, at its stamp; null: it was cancelled while it was made,
  /// which is no step, and ends the mission. newest: the belief now.
  std::shared_ptr<const Plan> plan(const Belief& newest, const Belief& from, double now);
  /// After plan() from what was the newest belief: tells observers of the step, counts it, and says
  /// whether the mission is over because the task is. Where the robot is to return then, the
  /// planner is told to, once, and it is not over yet.
  bool over_after(const Belief& newest, const Plan& plan, const GuardStops& stops);

  /// Takes the place that people have asked for since the call before, if any: the planner is told
  /// to go there, and the robot to drive; or that they have cancelled it. At the end of that way
  /// over_after() tells it to stand and the planner to go on with the task.
  void take_detour(DriveRequests& requests);

  MissionResult result;

  static constexpr double kAskEvery = 15.0;  ///< [s]

 private:
  bool over(MissionEnd end, std::string detail);
  bool turned_back(const MissionStep& step);
  bool begin_return();
  std::string set_task(const Task& task);
  void end_detour(DetourState state, const std::string& why);

  const MissionOptions& options_;
  Replanner& planner_;
  DriveRequests* detour_ = nullptr;  // whose path the robot is on; null: nobody's
  int place_ = 0;                    // of that, its number
  double start_;
  double last_localized_;
  std::optional<Eigen::Vector2d> began_at_;  // in W [m]
  double strayed_ = 0.0;                     // [m] farthest from there
  std::string refused_;                      // newest refusal of the certificate
  std::string missing_;                      // of MissionOptions::missing
  double ask_return_path_at_ = 0.0;          // [s] since the start
};

}  // namespace prospect
