// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "runtime/base.h"
#include "runtime/belief_source.h"
#include "runtime/driver.h"
#include "runtime/mission_observer.h"
#include "runtime/preflight.h"

namespace prospect {

class Knobs;

struct PreflightRunOptions {
  PreflightOptions checks;
  double patience = 20.0;  ///< [s] that streams may take to become live
  double turn = 0.2;       ///< [rad] to turn on the spot, to the left; 0: no turn
  double turn_rate = 0.4;  ///< [rad/s], at most half of what the model allows
  double distance = 0.05;  ///< [m] to drive straight ahead; 0: none
  double speed = 0.15;     ///< [m/s], at most half of what the model allows
  double settle = 0.5;     ///< [s] of rest after each motion, until what was measured has come
};
/// The knobs (models/knobs.h).
void describe(Knobs& knobs, PreflightRunOptions& options);

/// What the checks know besides.
struct PreflightInputs {
  /// What is known beforehand: heights of the body, resolution, and what else no stream tells.
  PreflightFacts known{};
  /// Asked once the streams are live, of several looks; empty: nothing sees the floor.
  std::function<std::optional<PreflightFacts::Floor>()> floor{};
  /// Told of beliefs meanwhile.
  std::vector<MissionObserver*> observers{};
  /// Asked at each period; the base is stopped, and what was not made has failed. Empty: nobody.
  std::function<bool()> cancelled{};
};

/// Makes the checks of preflight.h on a robot: it stands until its streams have been live for
/// checks.live_time, its base can be driven and it knows where it is, or `patience` is over; then
/// checks_before_motion(). Floor and stereo pairs are judged by the median of several looks.
/// If none fails it turns by `turn` and what braking adds; checks_of_turn() compares. If none fails
/// then it drives `distance` straight ahead; checks_of_distance() compares. The base's own odometry
/// is its wheels.
///
/// Both motions go through a CommandLoop: they ramp within the model's rates, and the guard must
/// pass each of their commands on the newest map, as must `ranges`. Who has the robot stand or stop
/// by `requests` or the emergency stop has it not move. If they do not, a model that
/// cannot turn on the spot, or a belief that is lost, the checks of the motion are not possible and
/// say why. Nothing is left out. A base that does not follow meanwhile (CommandFollowing) is
/// stopped at once: a check "following" has failed.
///
/// A thread of its own asks for beliefs meanwhile. driver: how commands are sent and whether the
/// base follows. Errors: throws std::invalid_argument on options out of range and without a model,
/// before anything else.
PreflightResult run_preflight(const DriverParts& parts, Base& base, BeliefSource& beliefs,
                              const PreflightRunOptions& options, const DriverOptions& driver,
                              const PreflightInputs& inputs = {});

}  // namespace prospect
