// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "runtime/clock_offset.h"

namespace prospect {

void describe(Knobs& knobs, ClockOffsetOptions& o) {
  knobs.boolean("own_clock", o.own_clock,
                "the source has a clock of its own; else its stamps are of the runtime's");
  knobs.number("drift", o.drift, {0.0, 0.2}, "1",
               "most that one clock runs faster than the other, seconds a second");
  knobs.number("jump", o.jump, {0.001, 10.0}, "s",
               "what a stamp is off by more is a jump of a clock");
  knobs.integer("settle_count", o.settle_count, {1, 1000}, "1",
                "stamps before a new estimate is used");
  knobs.number("settle_time", o.settle_time, {0.0, 60.0}, "s", "before a new estimate is used");
  knobs.number("least_delay", o.least_delay, {0.0, 10.0}, "s",
               "from capture to arrival of the quickest message, if known");
}

}  // namespace prospect
