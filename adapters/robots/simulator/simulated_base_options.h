// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace prospect {

class Knobs;

struct SimulatedBaseOptions {
  double dead_man = 0.4;        ///< [s] after which it stops by itself, > 0
  double delay = 0.0;           ///< [s] from a command to when it acts, >= 0
  double belief_period = 0.05;  ///< [s] from one belief to the next, > 0
};
/// The knobs (models/knobs.h).
void describe(Knobs& knobs, SimulatedBaseOptions& options);

}  // namespace prospect
