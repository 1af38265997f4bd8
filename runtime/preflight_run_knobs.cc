// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "runtime/preflight_run.h"

namespace prospect {

void describe(Knobs& knobs, PreflightRunOptions& o) {
  knobs.group("checks", [&] { describe(knobs, o.checks); });
  knobs.number("patience", o.patience, {0.0, 600.0}, "s", "that streams may take to become live");
  knobs.number("turn", o.turn, {0.0, 1.5}, "rad",
               "to turn on the spot before the mission; 0: none");
  knobs.number("turn_rate", o.turn_rate, {0.01, 3.0}, "rad/s",
               "of that turn, at most half of what the model allows");
  knobs.number("distance", o.distance, {0.0, 1.0}, "m",
               "to drive straight ahead before the mission; 0: none");
  knobs.number("speed", o.speed, {0.01, 1.0}, "m/s",
               "of that, at most half of what the model allows");
  knobs.number("settle", o.settle, {0.0, 10.0}, "s", "of rest after each of these motions");
}

}  // namespace prospect
