// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/maps/belief.h"
#include "engine/safety/guard.h"
#include "engine/safety/plan.h"
#include "models/motion_model.h"
#include "runtime/base.h"
#include "runtime/drive_mode.h"
#include "runtime/next_command.h"
#include "runtime/predicted_belief.h"

namespace prospect {

class Knobs;

struct CommandLoopOptions {
  double period = 0.05;  ///< [s] from one command to the next
  /// [s] after which a command expires, >= period: what the guard certifies is that the command
  /// stays in force so long, and is followed by a stop.
  double hold = 0.15;
  ActuationDelay delay;
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, CommandLoopOptions& options);

/// Why a command is what it is, in the order in which they are asked.
enum class CommandReason {
  kBase,           ///< the base is not there, or reports a fault
  kEmergencyStop,  ///< the drive mode says so
  kStand,          ///< likewise: zero velocity
  kComfortStop,    ///< likewise: braking
  kObstacle,       ///< ranges show what the map does not know
  kNoBelief,       ///< nothing is known of where the robot is
  kNoPlan,         ///< there is no plan, or it was given up
  kGuard,          ///< the guard has refused the command: the plan is given up
  kTail,           ///< the plan is past its committed part, or is a stop: its stop
  kPlan            ///< the plan's
};
std::string_view to_string(CommandReason reason);

/// What is known when a command is due.
struct CommandInputs {
  double now = 0.0;                      ///< [s]
  std::shared_ptr<const Plan> plan;      ///< the newest; null: none
  std::shared_ptr<const Belief> belief;  ///< the newest; null: none
  BaseReport base;
  DriveSpeed drive;          ///< what the drive mode lets the motors do
  double range_share = 1.0;  ///< of the speed that raw ranges allow, 0 to 1
};

/// What the base is told.
struct CommandStep {
  Twist command;
  double expires = 0.0;  ///< [s]
  /// Base::stop() instead: the base brakes as it can. `command` is what it is taken to do then.
  bool stop = false;
  CommandReason reason = CommandReason::kNoPlan;
  std::string detail;  ///< a sentence, where something is wrong
  GuardReason guard = GuardReason::kPassed;
};

/// What a planner must know to predict where the robot will be.
struct CommandState {
  std::vector<SentCommand> sent;     ///< those of the last seconds, oldest first
  Twist command;                     ///< in force
  std::shared_ptr<const Plan> plan;  ///< in force; null: the robot brakes or rests
  std::shared_ptr<const Plan> next;  ///< taken, and begins later; null: none
  double share = 0.0;                ///< of the plan's velocities that is driven
  /// Without a plan in force: the commands of the stop that follow, a period each, then rest.
  /// Empty: it brakes straight.
  std::vector<Twist> stop;
};

/// Those sent, and those that will be until time `until` [s] if nothing comes between.
std::vector<SentCommand> commands_until(const MotionModel& model, const CommandState& state,
                                        double now, double until, double period);

/// What a command thread does at each period: pure but for a small state. Each step
///   takes the newest plan, if it is on time;
///   asks what forbids driving (CommandReason, in that order) and brakes as hard as the model can,
///     or has the base stop;
///   else samples the plan in force by time, ramps within the rates, and lets the guard check the
///     command from the pose that is predicted for now;
///   gives the command an expiry.
/// It waits for nobody and asks no clock.
///
/// Plans. A plan takes effect at its stamp, which lies ahead when it is made; until then the one
/// before stays in force. One that comes later than a period after its stamp is late and is not
/// driven: the robot is not where the plan begins, but on the stop of the plan before. At rest it
/// is taken all the same, as the robot is where it was. A plan whose command the guard refuses is
/// given up, as is the one that was to follow it: the robot brakes until a newer plan comes.
///
/// Stops. A plan that is given up for what the map, the zones or the belief say, one that is a
/// stop, and a comfort stop lead along the plan's path as long as that is free on the newest map
/// (Guard::stop_commands(), asked anew at each period); all others brake straight.
///
/// Thread-safety: one thread. Never throws.
class CommandLoop {
 public:
  /// model and guard outlive it. Throws std::invalid_argument on options out of range.
  CommandLoop(std::shared_ptr<const MotionModel> model, const Guard& guard,
              const CommandLoopOptions& options);

  CommandStep step(const CommandInputs& inputs);

  CommandState state() const;
  int late_plans() const { return late_plans_; }
  const CommandLoopOptions& options() const { return options_; }

 private:
  void adopt(const std::shared_ptr<const Plan>& plan, double now);
  void give_up();
  /// The command of the stop along the path of a plan; null, without a belief, or at rest: no
  /// change.
  void stop_along(const Plan* plan, const CommandInputs& inputs, const Pose& pose,
                  CommandStep& step);
  /// The plan's command, or the guard's braking where it refuses that one.
  void drive(const CommandInputs& inputs, const Pose& pose, CommandStep& step);

  std::shared_ptr<const MotionModel> model_;
  const Guard& guard_;
  CommandLoopOptions options_;
  Twist previous_;  // in force
  double share_ = 0.0;
  std::deque<SentCommand> sent_;
  std::shared_ptr<const Plan> seen_, current_, next_;
  std::shared_ptr<const Plan> given_up_;  // by the guard, and nothing driven since
  std::vector<Twist> stop_;               // the last command and those after it, if a plan's stop
  int late_plans_ = 0;
};

}  // namespace prospect
