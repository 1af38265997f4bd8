// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "perception/mapping/depth_mapper.h"

namespace prospect {

void describe(Knobs& knobs, DepthMapperOptions& o) {
  knobs.group("ground", [&] { describe(knobs, o.ground); });
  knobs.number("tilt_tolerance", o.tilt_tolerance, {1e-3, 1.5}, "rad",
               "between the ground and what the pose says of it");
  knobs.number("height_tolerance", o.height_tolerance, {1e-3, 100.0}, "m",
               "between the ground and what the pose says of it");
  knobs.number("pose_sigma_tilt", o.pose_sigma_tilt, {0.0, 1.5}, "rad",
               "deviation of the pose's tilt; 0: exact");
  knobs.number("pose_sigma_height", o.pose_sigma_height, {0.0, 100.0}, "m",
               "deviation of the pose's height; 0: exact");
  knobs.number("plane_sigma_tilt", o.plane_sigma_tilt, {0.0, 1.5}, "rad",
               "least deviation of a measured ground's tilt");
  knobs.number("plane_sigma_height", o.plane_sigma_height, {0.0, 100.0}, "m",
               "least deviation of a measured ground's height");
  knobs.number("floor_margin", o.floor_margin, {0.0, 1.0}, "m",
               "from the ground, within which a point is of the floor");
  knobs.number("most_margin", o.most_margin, {0.0, 1.0}, "m",
               "most that this grows to with the noise of the depth");
  knobs.require(o.most_margin >= o.floor_margin, "most_margin",
                "most_margin < floor_margin; expected at least that");
  knobs.number("ray_spacing", o.ray_spacing, {0.01, 10.0}, "1",
               "of neighbouring rays at the map's range, as a share of a voxel");
  knobs.number("edge", o.edge, {0.0, 1.0}, "1",
               "step to a neighbour, as a share of the depth, at the edge of a surface");
  knobs.number("least_valid", o.least_valid, {0.0, 1.0}, "1",
               "share of pixels with a depth; fewer: rejected");
  knobs.number("little_valid", o.little_valid, {0.0, 1.0}, "1",
               "share of pixels with a depth; fewer: degraded");
  knobs.number("most_rough", o.most_rough, {0.0, 1.0}, "1",
               "share of neighbours that differ by a tenth; more: noise, rejected");
  knobs.number("most_below_floor", o.most_below_floor, {0.0, 1.0}, "1",
               "share of points far below the floor; more: rejected");
  knobs.number("max_speed", o.max_speed, {0.01, 1e4}, "m/s", "of a possible motion");
  knobs.number("max_turn_rate", o.max_turn_rate, {0.01, 1000.0}, "rad/s", "of a possible motion");
  knobs.number("max_gap", o.max_gap, {1.0, 1000.0}, "1",
               "of the usual time between images; above: degraded");
}

}  // namespace prospect
