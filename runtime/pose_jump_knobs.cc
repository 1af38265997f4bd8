// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "runtime/pose_jump.h"

namespace prospect {

void describe(Knobs& knobs, PoseJumpOptions& o) {
  knobs.number("distance", o.distance, {0.0, 100.0}, "m",
               "of a pose from outside beyond what the robot can have driven: it has jumped");
  knobs.number("turn", o.turn, {0.0, 7.0}, "rad", "likewise of its yaw");
}

}  // namespace prospect
