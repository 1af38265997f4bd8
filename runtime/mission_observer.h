// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "models/types.h"
#include "runtime/sensor_frame.h"

namespace prospect {

struct Belief;
struct CameraPicture;
struct DriverStatus;
struct Event;
struct HealthReport;
struct MissionResult;
struct MissionStep;
struct Plan;
struct Task;

/// Who watches a mission: a log, a live page, a record, a program of one's own. Each function does
/// nothing unless it is overridden. The same mission tells the same, in lockstep and in real time.
///
/// Threads. What stands under one heading below is called by one thread, in the order of what
/// happens; different headings at the same time. In lockstep all of it is one thread.
///
/// None may wait: the robot's threads would. None may throw but on_step(): what that throws ends
/// the mission, once the robot is at rest (mission.h).
class MissionObserver {
 public:
  virtual ~MissionObserver() = default;

  // Perception.
  /// What a sensor delivered, before perception takes it; in lockstep as it is measured.
  virtual void on_frame(const SensorFrame& /*frame*/) {}
  /// Before on_belief(), of a robot with cameras in which landmarks are looked for.
  virtual void on_picture(const CameraPicture& /*picture*/) {}
  /// Each new one in real time; in lockstep that of each planning step, before it.
  virtual void on_belief(const Belief& /*belief*/) {}

  // The planner: all calls that its results rest on (replanner.h), then the step.
  virtual void on_prepare(const Belief& /*belief*/) {}
  virtual void on_plan(const Belief& /*belief*/) {}     ///< before Replanner::plan()
  virtual void on_planned(const Plan& /*plan*/) {}      ///< after it, unless it was cancelled
  virtual void on_task(const Task& /*task*/) {}         ///< before set_task(), taken or not
  virtual void on_step(const MissionStep& /*step*/) {}  ///< in lockstep before it is executed

  // Commands.
  /// Each that is sent, at `time` [s] of the robot's clock; a stop is zero.
  virtual void on_command(double /*time*/, const Twist& /*command*/) {}

  // The thread that drives the mission; in real time alone, but for the last.
  /// New ones, and those that happened again (event_log.h).
  virtual void on_events(std::span<const Event> /*events*/) {}
  /// At most five times a second, and at the end.
  virtual void on_status(const DriverStatus& /*status*/, const HealthReport& /*health*/) {}
  virtual void on_end(const MissionResult& /*result*/) {}
};

/// Calls a function of each: tell(observers, &MissionObserver::on_belief, belief).
template <class... Parameters, class... Given>
void tell(const std::vector<MissionObserver*>& observers,
          void (MissionObserver::*what)(Parameters...), const Given&... given) {
  for (MissionObserver* observer : observers) (observer->*what)(given...);
}

}  // namespace prospect
