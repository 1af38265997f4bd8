// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/worlds/world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/robots/faults/injected_fault.h"
#include "benchmarks/told_robot.h"

namespace prospect {

/// A drive with faults, all for the same time.
struct FaultCase {
  std::vector<InjectedFault> faults;  ///< one at least
  double length = 13.0;               ///< [s] of the whole drive
  /// [s] after the fault is over until a person acknowledges a stop that latches.
  double patience = 1.0;
  std::uint64_t seed = 1;  ///< of the simulator
  LocalizedBy by = LocalizedBy::kCameras;
};

/// What became of it. Times and places are of the true robot, every 0.05 s.
struct FaultOutcome {
  double speed = 0.0;  ///< [m/s] when the fault began
  /// [s] and [m] from then until the robot stood, for the first time while the fault held or within
  /// 2 s after it; none: it drove on.
  std::optional<double> stop_time, stop_distance;
  /// Why: what the drive mode or the command thread said first from then on; "plan": nothing, the
  /// plan itself stops; "expiry": nothing, the base stopped as commands ceased.
  std::string cause;
  /// [s] and [m] from the fault until the robot had named what is wrong: until it was to stop;
  /// none: it was not named while the fault held.
  std::optional<double> named_time, named_distance;
  /// [s] from the end of the fault until it drove again, if it stood then; none: it did not, or
  /// there was no need to.
  std::optional<double> recovery;
  bool acknowledged = false;   ///< a person had to
  bool drives_at_end = false;  ///< it has driven in the last 3 s
  int contacts = 0;
  double longest_stand = 0.0;         ///< [s] since the fault began
  std::vector<std::string> events{};  ///< one line each, but for what is ordinary
};

/// A drive with a planner that does little: what is looked at is what is around it. Along the world
/// `corridor` it is at full speed, 0.6 m/s, from 3 s on; any other world it explores. A robot that
/// is told its pose sees all round, in one plane.
Configuration fault_drive_configuration(const std::string& world,
                                        LocalizedBy by = LocalizedBy::kCameras);

/// Drives the simulated robot in real time's way, by threads, on a SimulatedClock, with the
/// configured planner. It has an IMU where a fault is of it. Deterministic. Throws as Simulator and
/// Driver do.
FaultOutcome drive_with_fault(const std::shared_ptr<const World>& world,
                              const Configuration& configuration, const FaultCase& one);

/// One line of words: "stopped by source stale after 0.55 s and 0.21 m; drove on 1.3 s after the
/// fault".
std::string to_text(const FaultOutcome& outcome);

}  // namespace prospect
