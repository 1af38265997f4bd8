// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "runtime/command_following.h"

namespace prospect {

void describe(Knobs& knobs, CommandFollowingOptions& o) {
  knobs.number("lag", o.lag, {0.0, 5.0}, "s",
               "by which motion may be later than drive.command.delay says");
  knobs.number("slip", o.slip, {0.0, 1.0}, "1",
               "share by which motion may be more or less than it is told");
  knobs.number("hold", o.hold, {0.0, 1.0}, "1",
               "by which the share that it makes of its commands may change");
  knobs.number("least_speed", o.least_speed, {0.001, 1.0}, "m/s", "that counts as motion");
  knobs.number("least_rate", o.least_rate, {0.001, 3.0}, "rad/s", "that counts as turning");
  knobs.number("gyro_bias", o.gyro_bias, {0.0, 1.0}, "rad/s",
               "most that a gyro may be off while the robot stands");
  knobs.number("more_distance", o.more_distance, {0.01, 10.0}, "m",
               "driven beyond what was told, or the other way, that stops the robot");
  knobs.number(
      "turn", o.turn, {0.01, 10.0}, "rad",
      "turned beyond what was told, or the other way, or told and not turned, that stops it");
  knobs.number("less_distance", o.less_distance, {0.01, 10.0}, "m",
               "told and not driven that stops it");
}

}  // namespace prospect
