// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/camera.h"
#include "models/robot_description.h"
#include "models/types.h"
#include "runtime/base.h"
#include "runtime/belief_source.h"
#include "runtime/clock.h"
#include "runtime/emergency_stop.h"
#include "runtime/mission_observer.h"
#include "runtime/sensor_inbox.h"
#include "runtime/truth.h"

namespace prospect {

/// A robot as its adapter makes it (make_robot()): its time, its motors, what its sensors deliver,
/// and what is true of it if anybody knows. Nothing of it plans, guards or records. The pointers
/// share what they rest on, so their order does not matter.
struct Robot {
  std::string name;  ///< for records
  std::shared_ptr<const Clock> clock;
  std::shared_ptr<Base> base;
  std::shared_ptr<SensorInbox> frames;  ///< where its sensors' frames come
  std::shared_ptr<BeliefSource>
      beliefs{};                        ///< of a robot that perceives by itself; null: frames do
  /// Of frames: those that it needs; of one that perceives by itself, an IMU's or none.
  std::vector<SensorStream> streams{};
  std::shared_ptr<Truth> truth{};       ///< null: nobody knows

  Pose start;                            ///< of B in W, when it was made
  double made = 0.0;                     ///< [s] of the clock
  bool simulated_time = false;           ///< the clock is a simulation's that somebody else runs
  std::optional<PinholeCamera> depth{};  ///< none: it has no depth images
  /// Of its depth sensors from 1 on (RobotDescription::more_depth, all of which it needs) those
  /// that have depth images, by their number; the others have scans.
  std::map<int, PinholeCamera> more_depth{};
  /// What it was described as, with what it tells of its cameras itself; and who tells, for
  /// messages. Without a model: it tells nothing.
  RobotDescription description{};
  std::string described_by{};
  const EmergencyStopInput* emergency_stop = nullptr;  ///< null: nobody presses one
  std::vector<MissionObserver*> observers{};           ///< what it tells others of its mission
  /// What is wrong with its links, a sentence each; empty: nobody says.
  std::function<std::vector<std::string>()> link_faults{};
};

}  // namespace prospect
