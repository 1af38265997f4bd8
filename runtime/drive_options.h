#pragma once

#include "perception/odometry/stereo_odometry.h"
#include "perception/pipeline/perception_options.h"
#include "runtime/preflight_run.h"
#include "runtime/range_stop.h"
#include "runtime/real_time_driver.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

class Knobs;

/// All that a robot is driven by in real time, whatever its base.
struct DriveOptions {
  RealTimeOptions driver;
  PreflightRunOptions preflight;
  SensorInboxOptions inbox;
  RangeStopOptions ranges;  ///< the independent look
  StereoOdometryOptions odometry;
  /// Cameras, mounts, range, map and start are what the robot has. Wheels of a real floor slip, and
  /// nobody has measured how much.
  PerceptionOptions perception = [] {
    PerceptionOptions perception;
    perception.wheel_fusion.sigma_scale = 0.1;
    return perception;
  }();
};
/// The knobs (models/knobs.h): those of the driver, and a group each of the others.
void describe(Knobs& knobs, DriveOptions& options);

}  // namespace prospect
