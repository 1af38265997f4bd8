// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "runtime/driver.h"

namespace prospect {

void describe(Knobs& knobs, DriverOptions& o) {
  knobs.group("command", [&] { describe(knobs, o.command); });
  knobs.group("mode", [&] { describe(knobs, o.mode); });
  knobs.group("watch", [&] { describe(knobs, o.watch); });
  knobs.group("following", [&] { describe(knobs, o.following); });
  knobs.number("replan_period", o.replan_period, {0.01, 10.0}, "s",
               "from the start of one plan to that of the next");
  knobs.number("least_latency", o.least_latency, {0.0, 10.0}, "s",
               "least that a plan is made ahead of its start");
  knobs.number("most_latency", o.most_latency, {0.0, 10.0}, "s",
               "most that a plan is made ahead of its start");
  knobs.require(o.least_latency <= o.most_latency, "least_latency",
                "more than most_latency; expected at most that");
  knobs.number("perception_limit", o.perception_limit, {0.01, 60.0}, "s",
               "longest time without an answer of the perception thread");
  knobs.number("planner_limit", o.planner_limit, {0.01, 60.0}, "s",
               "longest time without an answer of the planner thread");
  knobs.number("command_limit", o.command_limit, {0.01, 60.0}, "s",
               "longest time without an answer of the command thread");
  knobs.integer("priority", o.priority, {0, 99}, "1",
                "of commands by SCHED_FIFO, where the system allows it; 0: as all other threads");
}

}  // namespace prospect
