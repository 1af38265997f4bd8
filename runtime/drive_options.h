// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "runtime/driver.h"
#include "runtime/preflight_run.h"
#include "runtime/range_stop.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

class Knobs;

/// All that a robot is driven by in real time, whatever its base, but for what it perceives by.
struct DriveOptions {
  DriverOptions driver;
  PreflightRunOptions preflight;
  SensorInboxOptions inbox;
  RangeStopOptions ranges;  ///< the independent look
};
/// The knobs (models/knobs.h): those of the driver, and a group each of the others.
void describe(Knobs& knobs, DriveOptions& options);

}  // namespace prospect
