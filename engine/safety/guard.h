// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/maps/belief.h"
#include "engine/safety/certificate.h"
#include "engine/safety/plan.h"
#include "models/motion_model.h"

namespace prospect {

class Knobs;

enum class GuardReason {
  kPassed,
  kNonFinite,    ///< the command, the pose or the velocity is not finite
  kLimit,        ///< faster than the model allows, or a time step out of bounds
  kRate,         ///< a larger change of velocity than the model allows
  kVelocity,     ///< the measured velocity is none that the command in force leads to
  kStale,        ///< the belief, one of its sources or the plan is too old, or from the future
  kUncommitted,  ///< the plan does not reach that far, is not certified, does not belong to its
                 ///< commands, or is a stop that does not brake
  kMap,          ///< the newest map forbids what was certified against an older one, or is not
                 ///< of this place
  kLost,         ///< nothing bounds the pose's error, and the motion leaves what is in view
  kForbidden,    ///< the motion enters a keep-out or leaves the bound
  kSlowZone,     ///< it is faster than a slow zone allows
  kOverBudget    ///< the check was given up: Certificate::Status::kOverBudget
};

std::string_view to_string(GuardReason reason);

/// Whether the stop after a refusal may follow the plan: the plan is sound, and the map, the zones
/// or the belief speak against going on.
bool follows_plan(GuardReason reason);

/// A command that is sent at any time of a plan, as a command thread does.
struct TimedCommand {
  /// Input of the model over the next `step`: the command is the body velocity that it leads to
  /// from the command in force.
  Eigen::VectorXd input;
  double step = 0.05;  ///< [s] from one command to the next
  /// How long it may stay in force [s], >= step: until the next one has come for certain, or the
  /// base has stopped by itself.
  double hold = 0.1;
  double share = 1.0;  ///< of the plan's velocities that is to be driven, 0 to 1
  /// Where the robot is when the command begins to act, as predicted from the newest belief; none:
  /// it does not pass.
  std::optional<Pose> pose{};
  /// The caller judges over time whether the base follows (runtime/command_following.h): one
  /// measured velocity that the command in force does not lead to decides nothing here.
  bool following_watched = false;
};

/// What the motors get.
struct GuardVerdict {
  Twist command;  ///< finite and within limits, whatever was asked for
  /// [s] that it may be held: the plan's dt, or the step of a timed command, if within bounds.
  double duration = 0.25;
  GuardReason reason = GuardReason::kPassed;
  std::string detail;
  bool passed() const { return reason == GuardReason::kPassed; }
};

/// The last gate before the motors. A command passes only if it is finite, within limits and rates,
/// from fresh sources, and its plan's remaining committed part, with the stop after it, is
/// certified against the newest map; the command must be the one that the certified inputs give.
/// Otherwise the verdict is the first command of a stop from the command in force, or zero if that
/// is not finite: the hardest admissible braking, straight or along the path of the plan, whichever
/// touches nothing on the newest map, or touches later (choose_stop()); straight if the plan itself
/// is at fault (non-finite, limit, rate, uncommitted).
///
/// Fresh: each source of the belief has a stamp (SourceStamps) and an age limit; a stamp that is
/// not finite or from the future is refused. A map that was given and does not change has an
/// infinite limit. A verdict of kStale names the source and its age.
///
/// What was measured must have to do with what was told. The velocity v of the newest belief and
/// the command p in force before, linear and yaw rate each: the distance from v to {s p, 0 <= s <=
/// 1} is at most a kLag + mismatch v_max, a the largest change of a command per second, and a kLag
/// no more than v_max: less than was told is a base that is slow or held up, whatever else is a
/// motion that nobody certified. The pose of a TimedCommand lies within what the robot can drive
/// and turn in the age of the belief's pose, `hold` and kLag, and kPoseSlack.
///
/// A stopping tail needs no certificate: it is what would be done instead. So it has to be that:
/// with p the command in force and h what the hardest admissible braking (braking_input() of the
/// model) makes of it in one step, a command c passes as
///     |c| <= |h| + m (|p| - |h|),   |c - h| <= m |p|   (linear),   c = h   (yaw rate),
/// all up to `tolerance`; m = mismatch for bases whose commanded velocity turns with the estimated
/// yaw, else 0. So a command that stays as it is passes at rest only, and one that passes takes at
/// least the share 1 - m of what can be taken from the speed, without turning aside.
/// One that turns must be the stop of its plan's inputs: |c| as above, c as near to what its input
/// gives as to h above, the inputs from here on end at rest, and on the newest map they touch
/// nothing, or no earlier than the straight stop.
///
/// Between stages (TimedCommand) what is certified does not rest on what the plan foresaw: the
/// input for `step`, the velocity that it leads to up to `hold`, and then the hardest braking, step
/// by step, from the pose that is predicted for when the command begins to act. If that is free on
/// the newest map, then whatever comes after, nothing or another command, the robot can stop as
/// certified. The command must lead from the command in force towards `share` of that of the plan
/// at `now` (with Plan::ramp_from: at the end of `step`), not beyond it; past the committed part,
/// and in a stopping tail, it must brake, by the rule above.
///
/// Localization that is lost, or whose covariance is none: the certificate lets the robot drive
/// only into what is in view (certificate.h). Bounded time: see there, too.
///
/// check() never throws; the constructor throws std::invalid_argument without a model, with a shape
/// or options that Certifier refuses, or with options of its own out of range. Thread-safety:
/// const; may be called concurrently. Source: architecture, contracts; the faults it must catch are
/// those of the fault notes.
class Guard {
 public:
  struct Options {
    // Age limits [s], >= 0; infinite: any age.
    double max_belief_age = 0.5;
    double max_pose_age = 0.5;
    double max_map_age = 1.0;
    double max_landmarks_age = 1.0;
    double max_ranges_age = 1.0;
    double plan_slack = 0.3;  ///< [s] that a plan may outlive its committed part, >= 0
    /// Longest and shortest time step of a plan [s]: a command is held that long, and over less
    /// than the shortest no braking could be told from none.
    double max_step = 2.0;
    static constexpr double kMinStep = 1e-3;
    /// From a command to a measured velocity that shows it, at most [s].
    static constexpr double kLag = 0.5;
    static constexpr double kPoseSlack = 0.1;  ///< of a predicted pose [m], [rad]
    double tolerance = 1e-6;                   ///< relative, on limits and rates, 0 to 0.1
    /// Share of the largest speeds by which a command may differ from what its input gives from the
    /// newest pose, for bases controlled by acceleration: their body velocity turns with the
    /// estimated yaw. Of a stopping tail: m above. 0 to below 1.
    double mismatch = 0.1;
  };

  Guard(std::shared_ptr<const MotionModel> model, const RobotShape& shape,
        const Certifier::Options& certificate, Options options);
  Guard(std::shared_ptr<const MotionModel> model, const RobotShape& shape,
        const Certifier::Options& certificate)
      : Guard(std::move(model), shape, certificate, Options()) {}

  /// Other zones from now on; null: none. Not while another thread checks.
  void set_zones(std::shared_ptr<const ZoneMap> zones) { certifier_.set_zones(std::move(zones)); }

  /// Which source of the belief is older than its limit, or from the future, and by how much: "the
  /// map is 1.4 s old; expected at most 1 s"; empty if none is.
  std::string stale_source(const Belief& newest, double now) const;

  /// May plan.commands[stage] be sent at time `now` [s], given the newest belief and the command in
  /// force before it?
  GuardVerdict check(const Plan& plan, int stage, const Twist& previous, const Belief& newest,
                     double now) const;

  /// May the command that asked.input leads to be sent at time `now` [s]?
  GuardVerdict check(const Plan& plan, const TimedCommand& asked, const Twist& previous,
                     const Belief& newest, double now) const;

  /// The commands of the stop to drive now (choose_stop()), each for `step` [s], from `pose` and
  /// the command in force on: the next command is the first. along: the plan whose path the robot
  /// is on; null: none. Straight if the pose is not finite, rest at once if `previous` is not.
  /// Finite and within limits, the last one rest; never empty.
  std::vector<Twist> stop_commands(const Plan* along, const Pose& pose, const Twist& previous,
                                   const Belief& newest, double step) const;

 private:
  /// Refuses; the command is the first of a stop. along: a plan whose path the stop may follow from
  /// `pose`; null: it is straight.
  GuardVerdict stop(GuardReason reason, const std::string& detail, const Twist& previous,
                    const Belief& newest, double dt, const Plan* along, const Pose& pose) const;
  Twist hardest_braking(const Twist& previous, const Belief& newest, double dt) const;
  bool brakes(const Twist& command, const Twist& previous, const Belief& newest, double dt) const;
  struct Objection {
    GuardReason reason;
    std::string detail;
  };
  /// Against a command that follows another after dt [s], from these sources; none: passes so far.
  std::optional<Objection> objection(const Twist& command, const Twist& previous,
                                     const Belief& newest, double dt, double now) const;
  /// Against a stopping tail that steers, from a stage on; none: it may be driven.
  std::optional<Objection> objection_to_stop(const Plan& plan, int stage, const Twist& previous,
                                             const Belief& newest) const;
  bool within_rates(const Twist& command, const Twist& previous, double dt) const;
  /// Whether the measured velocity is one that the command in force leads to.
  bool follows(const Twist& measured, const Twist& previous) const;
  /// Whether the robot can be at `pose` when a command sent now begins to act.
  bool can_be_at(const Pose& pose, const Belief& newest, double now, double hold) const;

  std::shared_ptr<const MotionModel> model_;
  Certifier certifier_;
  Options options_;
  double linear_acceleration_ = 0.0;   // [m/s^2]
  double angular_acceleration_ = 0.0;  // [rad/s^2]
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, Guard::Options& options);

}  // namespace prospect
