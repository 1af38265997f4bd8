// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "runtime/event_log.h"

namespace prospect {

void describe(Knobs& knobs, EventLogOptions& o) {
  knobs.integer("capacity", o.capacity, {16, 1000000}, "1", "events that are kept");
  knobs.number("repeat_gap", o.repeat_gap, {0.0, 3600.0}, "s",
               "an event that comes again within it is counted, not repeated");
  knobs.integer("longest_text", o.longest_text, {16, 100000}, "1",
                "characters of an event's text; what is longer is cut");
}

}  // namespace prospect
