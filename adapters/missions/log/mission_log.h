#pragma once

#include <string>
#include <vector>

#include "adapters/formats/bags/mcap_log.h"
#include "adapters/missions/log/mission_messages.h"
#include "adapters/missions/run/run_record.h"
#include "adapters/missions/run/run_start.h"
#include "engine/maps/belief.h"
#include "models/image.h"
#include "perception/fusion/wheel_fusion.h"
#include "perception/mapping/depth_image.h"
#include "perception/mapping/occupancy_mapper.h"
#include "runtime/event_log.h"
#include "runtime/real_time_driver.h"

namespace prospect {

struct MissionLogOptions {
  MissionMessageOptions messages;
  bool images = false;  ///< of cameras, too
  McapLogOptions file;
};

/// A mission as a bag of ROS 2 in one MCAP file, docs/reference/log.md: what came in, what was
/// believed, planned and commanded, what happened, and what it takes to make the run again. A kill
/// leaves all that was written so far readable.
///
/// Thread-safety: each function may be called by one thread at a time, different ones at the same
/// time. None waits for the disk unless the options say so (McapLogOptions::wait). Nothing throws.
class MissionLog {
 public:
  MissionLog(const std::string& path, const RunStart& start, const MissionLogOptions& options);

  void belief(const Belief& belief);
  void command(double time, const Twist& command);
  void step(const StepRecord& step);
  void planner_call(double time, const PlannerCall& call);  ///< all by one thread, in their order
  void events(const std::vector<Event>& events);
  void status(double time, const DriverStatus& status);
  void scan(double time, const DepthScan& in_B);
  void wheels(const WheelSample& wheels);
  void pair(double time, const ImagePair& pair);     ///< nothing without `images`
  void depth(double time, const DepthImage& image);  ///< likewise

  /// The results, and the end of the file.
  void finish(const RunRecord& record);

  /// What is to be told of it, a line each: what was dropped, why it is not whole.
  std::vector<std::string> notes() const;
  /// Why the file is not whole; empty: it is.
  std::string error() const { return log_.error(); }

 private:
  const bool images_;
  const std::string path_;
  McapLog log_;
  MissionMessages messages_;
};

}  // namespace prospect
