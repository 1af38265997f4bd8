// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "runtime/drive_options.h"

namespace prospect {

void describe(Knobs& knobs, DriveOptions& o) {
  describe(knobs, o.driver);
  knobs.group("preflight", [&] { describe(knobs, o.preflight); });
  knobs.group("inbox", [&] { describe(knobs, o.inbox); });
  knobs.group("ranges", [&] { describe(knobs, o.ranges); });
}

}  // namespace prospect
