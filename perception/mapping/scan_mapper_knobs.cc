// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "perception/mapping/scan_mapper.h"

namespace prospect {

void describe(Knobs& knobs, ScanMapperOptions& o) {
  knobs.number("floor_margin", o.floor_margin, {0.0, 1.0}, "m",
               "from z = 0, within which a point is of the floor");
  knobs.number("point_spacing", o.point_spacing, {0.001, 10.0}, "1",
               "side of a cube of which one point counts, in voxels");
  knobs.number("most_below_floor", o.most_below_floor, {0.0, 1.0}, "1",
               "share of points far below the floor; more: rejected");
  knobs.number("max_speed", o.max_speed, {0.01, 1e4}, "m/s", "of a possible motion");
  knobs.number("max_turn_rate", o.max_turn_rate, {0.01, 1000.0}, "rad/s", "of a possible motion");
}

}  // namespace prospect
