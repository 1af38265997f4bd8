// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adapters/robots/gazebo/gazebo_options.h"
#include "models/types.h"
#include "runtime/relay_process.h"

namespace prospect {

/// The dead-man that Gazebo's DiffDrivePlugin lacks, which holds its last command for ever: a
/// process of its own between us and the plug-in. It passes on each command that has not expired.
/// When the newest one is expired, or older than its dead-man's time, it sends zero velocity, and
/// again with every period. When who started it ends, in whatever way, it sends zero velocity for
/// 0.2 s and ends.
///
/// It counts in the simulation's time, as SimulationClock tells it: a simulation that makes less
/// than a second in one of the machine makes no command older. Of one that says nothing time goes
/// on with the machine's clock.
///
/// What it cannot do: stop the robot after it was killed itself, or when its own link to Gazebo
/// breaks; state() shows either. As any RelayProcess it is started before threads are.
///
/// Thread-safety: one thread at a time; send() and state() return at once.
class VelocityRelay {
 public:
  struct Report {
    bool connected = false;  ///< to the master, and the plug-in listens
    std::string fault;       ///< empty: none
  };

  /// Waits until it runs. Throws InputError with what it says if it cannot reach Gazebo,
  /// NotBuiltIn.
  explicit VelocityRelay(const GazeboOptions& options);

  /// `expires` [s] of the simulation. A velocity that is not finite is a stop. False: it was not
  /// taken.
  bool send(const Twist& velocity, double expires) noexcept;
  /// Its newest word; a fault if it has ended, or was silent for a second of the simulation: a
  /// machine that gives it no time slows the simulation, too. Time in which nobody has asked counts
  /// for 0.1 s at most, as the relay may have stood with who asks.
  /// now [s] of the simulation.
  Report state(double now) noexcept;

  int process() const { return process_->process(); }

 private:
  std::optional<RelayProcess> process_;  // from the constructor on
  double asked_ = 0.0, silent_ = 0.0;    // [s] of the simulation: when, and for how long
  Report report_;
};

}  // namespace prospect
