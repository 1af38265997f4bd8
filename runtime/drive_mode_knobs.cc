// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "runtime/drive_mode.h"

namespace prospect {

void describe(Knobs& knobs, DriveModeOptions& o) {
  knobs.number("live_time", o.live_time, {0.0, 60.0}, "s",
               "that all sources must have been live before the robot is ready");
  knobs.number("rest_time", o.rest_time, {0.02, 10.0}, "s", "without motion that are rest");
  knobs.number("recover_time", o.recover_time, {0.0, 60.0}, "s",
               "of good localization before full speed again");
  knobs.number("stop_time", o.stop_time, {0.1, 60.0}, "s",
               "longest stop; a longer one is a fault and latches");
  knobs.number("degraded_share", o.degraded_share, {0.01, 1.0}, "1",
               "of the speed, while localization is degraded");
  knobs.number("lost_share", o.lost_share, {0.01, 1.0}, "1",
               "of the speed, while localization is lost");
  knobs.number("unchecked_share", o.unchecked_share, {0.01, 1.0}, "1",
               "of the speed, until sign and gain of yaw are checked");
}

}  // namespace prospect
