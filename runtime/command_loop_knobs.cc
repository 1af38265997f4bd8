// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "runtime/command_loop.h"

namespace prospect {

void describe(Knobs& knobs, CommandLoopOptions& o) {
  knobs.number("period", o.period, {0.005, 0.5}, "s", "from one command to the next");
  knobs.number("hold", o.hold, {0.005, 2.0}, "s", "after which a command expires");
  knobs.require(o.hold >= o.period, "hold", "less than a period; expected at least that");
  knobs.group("delay", [&] { describe(knobs, o.delay); });
}

}  // namespace prospect
