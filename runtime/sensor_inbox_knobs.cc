// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "models/knobs.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

void describe(Knobs& knobs, SensorInboxOptions& o) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  knobs.number("pair_tolerance", o.pair_tolerance, {0.0, 1.0}, "s",
               "between the stamps of the left and the right image of a pair");
  knobs.integer("capacity", o.capacity, {1, 1000}, "1",
                "images, depth images or scans of a source that wait");
  knobs.integer("wheel_capacity", o.wheel_capacity, {1, 100000}, "1",
                "wheel samples, poses or samples of an IMU that wait");
  knobs.number("max_image_age", o.max_image_age, {0.0, kAny}, "s",
               "oldest image or pose taken, from capture on");
  knobs.number("max_wheel_age", o.max_wheel_age, {0.0, kAny}, "s",
               "of the newest sample of wheels or an IMU, beyond which it is stale");
  knobs.number("max_range_age", o.max_range_age, {0.0, kAny}, "s",
               "oldest depth image or scan taken, from capture on");
  knobs.boolean("cameras_in_runtime_clock", o.cameras_in_runtime_clock,
                "images are stamped by the runtime's clock");
  knobs.boolean("wheels_in_runtime_clock", o.wheels_in_runtime_clock,
                "wheel samples are stamped by the runtime's clock");
  knobs.boolean("depth_in_runtime_clock", o.depth_in_runtime_clock,
                "depth images are stamped by the runtime's clock");
  knobs.boolean("scan_in_runtime_clock", o.scan_in_runtime_clock,
                "scans are stamped by the runtime's clock");
  knobs.boolean("poses_in_runtime_clock", o.poses_in_runtime_clock,
                "poses from outside are stamped by the runtime's clock");
  knobs.boolean("imu_in_runtime_clock", o.imu_in_runtime_clock,
                "samples of an IMU are stamped by the runtime's clock");
  knobs.boolean("one_clock", o.one_clock,
                "clocks of sources that are not the runtime's are one and the same");
  knobs.group("pose_jump", [&] { describe(knobs, o.pose_jump); });
  knobs.number("clock_drift", o.clock_drift, {0.0, 0.2}, "1",
               "most by which a source's clock is faster or slower than the runtime's");
}

}  // namespace prospect
