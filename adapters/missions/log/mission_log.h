// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "adapters/formats/bags/mcap_log.h"
#include "adapters/missions/log/mission_messages.h"
#include "adapters/missions/log/planner_calls.h"
#include "adapters/missions/run/run_observer.h"
#include "adapters/missions/run/run_record.h"
#include "adapters/missions/run/run_start.h"

namespace prospect {

struct MissionLogOptions {
  MissionMessageOptions messages;
  bool images = false;  ///< of cameras, too
  /// The calls of the planner, too, by which a drive is repeated: one in lockstep is by its seed.
  bool calls = false;
  McapLogOptions file;
};

/// A mission as a bag of ROS 2 in one MCAP file, docs/reference/log.md: what came in, what was
/// believed, planned and commanded, what happened, and what it takes to make the run again. A kill
/// leaves all that was written so far readable.
///
/// Thread-safety: as MissionObserver. None waits for the disk unless the options say so
/// (McapLogOptions::wait). Nothing throws.
class MissionLog final : public RunObserver {
 public:
  MissionLog(const std::string& path, const RunStart& start, const MissionLogOptions& options);

  void on_frame(const SensorFrame& frame) override;  ///< images only with `images`
  void on_belief(const Belief& belief) override;
  void on_prepare(const Belief& belief) override;
  void on_plan(const Belief& belief) override;
  void on_planned(const Plan& plan) override;
  void on_task(const Task& task) override;
  void on_record(const StepRecord& record, const MissionStep& step) override;
  void on_command(double time, const Twist& command) override;
  void on_events(std::span<const Event> events) override;
  void on_status(const DriverStatus& status, const HealthReport& health) override;

  /// The results, and the end of the file.
  void finish(const RunRecord& record);

  /// What is to be told of it, a line each: what was dropped, why it is not whole.
  std::vector<std::string> notes() const;
  /// Why the file is not whole; empty: it is.
  std::string error() const { return log_.error(); }

 private:
  const bool images_, calls_;
  const std::string path_;
  McapLog log_;
  MissionMessages messages_;
  // Of the planner's thread: the time of a plan and of a task is that of the belief before it.
  PlannerCallWriter writer_;
  /// A call with a belief, and before it where W lies in the map's frame, if it is another place.
  void log_call(const Belief& belief, PlannerCall (PlannerCallWriter::*call)(const Belief&));
  /// When a call is logged: its belief's stamp, which of a plan lies ahead, but never back.
  double asked_at(const Belief& belief);
  double asked_ = 0.0;   // [s]
  double status_ = 0.0;  // [s] of the newest
};

}  // namespace prospect
