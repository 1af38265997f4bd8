// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "perception/mapping/mover_tracker.h"

namespace prospect {

void describe(Knobs& knobs, MoverTrackerOptions& o) {
  knobs.boolean("enabled", o.enabled,
                "what moves is followed and is no obstacle of the map; false: whatever a ray meets "
                "is of the building");
  knobs.number("moved", o.moved, {0.01, 10.0}, "m",
               "from where it was; what has gone as far moves");
  knobs.number("stands_after", o.stands_after, {0.0, 1000.0}, "s",
               "for which what has come is not taken for the building");
  knobs.number("rests_after", o.rests_after, {0.0, 1000.0}, "s",
               "in which a mover has not moved as far; then it is of the building");
  knobs.number("largest", o.largest, {0.1, 10.0}, "m", "across; what is larger is no mover");
  knobs.number("acceleration", o.acceleration, {0.01, 100.0}, "m/s^2",
               "one sigma of how a mover's velocity changes in a second");
  knobs.number("spread", o.spread, {0.0, 10.0}, "m/s",
               "by which the place that is predicted for a mover grows at least");
  knobs.number(
      "keep", o.keep, {0.0, 60.0}, "s",
      "for which a mover that stood is remembered out of view, unless a ray passes through it");
}

}  // namespace prospect
