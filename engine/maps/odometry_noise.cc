// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/odometry_noise.h"

#include "models/knobs.h"

namespace prospect {

void describe_random_walk(Knobs& knobs, OdometryNoise& o) {
  knobs.number("position_per_metre", o.position_per_metre, {0.0, 1000.0}, "m/sqrt(m)",
               "error of the position from driving");
  knobs.number("position_per_radian", o.position_per_radian, {0.0, 1000.0}, "m/sqrt(rad)",
               "error of the position from turning");
  knobs.number("yaw_per_metre", o.yaw_per_metre, {0.0, 1000.0}, "rad/sqrt(m)",
               "error of the heading from driving");
  knobs.number("yaw_per_radian", o.yaw_per_radian, {0.0, 1000.0}, "rad/sqrt(rad)",
               "error of the heading from turning");
  knobs.number("reference_count", o.reference_count, {0.0, 1e6}, "1",
               "points in view at which these errors hold");
  knobs.number("floor_count", o.floor_count, {0.001, 1e6}, "1",
               "points that are added to both counts: bounds the errors where none is in view");
}

void describe(Knobs& knobs, OdometryNoise& o) {
  describe_random_walk(knobs, o);
  knobs.number("scale", o.scale, {0.0, 10.0}, "1",
               "error of the scale, which is the same on the whole path");
}

}  // namespace prospect
