// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "runtime/mission.h"

namespace prospect {

void describe(Knobs& knobs, MissionOptions& o) {
  knobs.number("time_limit", o.time_limit, {1.0, 1e6}, "s",
               "of the robot's clock, also while it is held");
  knobs.number("lost_limit", o.lost_limit, {0.0, 1e6}, "s",
               "without localization that ends the mission");
  knobs.boolean("return_when_done", o.return_when_done, "back to the start once the task is over");
}

}  // namespace prospect
