// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "runtime/drive_watch.h"

namespace prospect {

void describe(Knobs& knobs, DriveWatchOptions& o) {
  knobs.number("max_silence", o.max_silence, {0.01, 60.0}, "s", "since the base's newest report");
  knobs.number("rest_speed", o.rest_speed, {0.0, 10.0}, "m/s", "below which the base is at rest");
  knobs.number("rest_rate", o.rest_rate, {0.0, 10.0}, "rad/s", "below which it is at rest");
  knobs.number("stray_speed", o.stray_speed, {0.0, 100.0}, "m/s",
               "by which the base may move faster than it is told to");
  knobs.number("stray_rate", o.stray_rate, {0.0, 100.0}, "rad/s",
               "by which the base may turn faster than it is told to");
  knobs.number("stray_time", o.stray_time, {0.0, 60.0}, "s", "of such motion that are no noise");
  knobs.number("settle_time", o.settle_time, {0.0, 60.0}, "s",
               "for which a command counts after it was replaced");
}

}  // namespace prospect
