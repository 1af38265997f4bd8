// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "runtime/predicted_belief.h"

namespace prospect {

void describe(Knobs& knobs, ActuationDelay& d) {
  knobs.number("linear", d.linear, {0.0, 2.0}, "s",
               "from a command to when its linear velocity begins to act");
  knobs.number("angular", d.angular, {0.0, 2.0}, "s",
               "from a command to when its yaw rate begins to act");
}

}  // namespace prospect
