// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/types.h"
#include "perception/fusion/wheel_fusion.h"

namespace prospect {

/// What a base says that it can do. What it does not say is not known, and a pre-flight check says
/// so. All > 0.
struct BaseLimits {
  std::optional<double> speed;             ///< [m/s]
  std::optional<double> yaw_rate;          ///< [rad/s]
  std::optional<double> acceleration;      ///< [m/s^2]; also when braking
  std::optional<double> yaw_acceleration;  ///< [rad/s^2]
};

/// The newest word of a base.
struct BaseReport {
  bool connected = false;  ///< the link to the motors is up
  /// When the newest word came in [s], in the runtime's clock. Meaningless before the first one:
  /// then `connected` is false.
  double stamp = 0.0;
  Twist velocity;  ///< measured, in B
  /// The velocity is not the base's own word: it is made of the poses that the robot is told
  /// (PoseVelocity), so it confirms nothing that they say.
  bool velocity_of_poses = false;
  /// Wheel motion measured since the report before, oldest first. Stamps are the base's own where
  /// it has a clock (SensorInbox shifts them into the runtime's), else the runtime's.
  std::vector<WheelSample> wheels;
  /// What is wrong with it, a sentence each, as its firmware or driver tells: "bumper pressed".
  /// Any of them stops the robot.
  std::vector<std::string> faults;
};

/// Motors: what takes velocity commands. Implemented by the simulator and by adapters for a
/// transport or a serial line.
///
/// Dead-man. A base stops by itself when commands cease: at the latest dead_man() seconds after the
/// last command came in, and not later than that command's expiry, if it keeps a clock by which it
/// can know it. This must happen on the motors' side of the link (in its firmware, or in a relay
/// process beside it), for a link that is broken carries no stop. A base that has none says so, and
/// the driver refuses it.
///
/// A relay is a process of ours on the motors' side that makes such a base one that has a dead-man:
/// it passes on each command that has not expired, and sends zero velocity once, and again with
/// every period, when the newest one is older than its time. It must be the only one that talks to
/// the motors, must not wait for anything else, and must be started by what starts the motors, so
/// that it lives as long as they do.
///
/// Thread-safety: send(), stop() and report() are called from one thread at a time, the command
/// thread, and return at once: they never wait for the link. name(), dead_man() and limits() never
/// change and may be called from any thread.
///
/// Errors: nothing is to throw: a link that breaks shows in report(). Who drives a base that others
/// wrote makes a fault of what it throws all the same, and of a call that does not return
/// (adapters/robots/user/threaded_base.h).
class Base {
 public:
  virtual ~Base() = default;

  virtual std::string name() const = 0;
  /// [s] > 0 after which it stops by itself; none: it does not.
  virtual std::optional<double> dead_man() const = 0;
  virtual BaseLimits limits() const { return {}; }

  /// Body velocity to hold until the next command, at most until `expires` [s] in the runtime's
  /// clock. One that has expired already is not executed.
  virtual void send(const Twist& command, double expires) = 0;
  /// Zero velocity as fast as the base can brake, without a ramp of ours. The next send() ends it.
  virtual void stop() = 0;
  virtual BaseReport report() = 0;
};

}  // namespace prospect
