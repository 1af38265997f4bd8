// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "models/knobs.h"
#include "perception/pipeline/perception_options.h"

namespace prospect {

void describe(Knobs& knobs, PerceptionOptions& o) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  knobs.boolean("wheels", o.wheels, "wheel odometry, fused with what the images say");
  knobs.group("wheel_fusion", [&] { describe(knobs, o.wheel_fusion); });
  knobs.group("inertial", [&] { describe(knobs, o.inertial); });
  knobs.group("odometry", [&] { describe(knobs, o.odometry); });
  knobs.group("mapping", [&] { describe(knobs, o.mapping); });
  knobs.group("depth_mapping", [&] { describe(knobs, o.depth_mapping); });
  knobs.group("scan_mapping", [&] { describe(knobs, o.scan_mapping); });
  knobs.group("movers", [&] { describe(knobs, o.movers); });
  knobs.group("feature_density", [&] { describe(knobs, o.feature_density); });
  knobs.boolean("loops", o.loops, "places that are seen again keep the map straight");
  knobs.number("same_time", o.same_time, {0.0, 1.0}, "s",
               "between stamps that are of one time: of a pair, of a pair and a depth image");
  knobs.number("max_age", o.max_age, {1e-3, 1000.0}, "s",
               "of an input behind the newest one; older: left out as late");
  knobs.require(!o.wheels || o.max_age <= o.wheel_fusion.max_wait, "max_age",
                "max_age > wheel_fusion.max_wait, up to which the fusion can go back; expected at "
                "most that");
  knobs.number("max_leap", o.max_leap, {1e-3, kInfinite}, "s",
               "of an input ahead of the newest one; more: of another clock, refused");
  knobs.number("max_ahead", o.max_ahead, {0.0, kInfinite}, "s",
               "of a depth image or scan ahead of the newest pose; more: it waits for one");
  knobs.number("pose_degraded", o.pose_degraded, {0.0, 1000.0}, "m",
               "of a pose from outside: standard deviation a metre ahead; more: it is degraded");
  knobs.number("pose_lost", o.pose_lost, {0.0, 1000.0}, "m", "likewise; more: it is lost");
  knobs.number("start_floor", o.start_floor, {0.0, 10.0}, "m",
               "about the start, where there is floor as a person states; 0: nobody does");
  knobs.integer("most_waiting", o.most_waiting, {0, 100000}, "1",
                "depth images and scans that wait");
}

OccupancyMapperOptions mapping_of(const PerceptionOptions& options) {
  OccupancyMapperOptions mapping = options.mapping;
  mapping.slopes = mapping.slopes && options.start_in_space.has_value();
  return mapping;
}

}  // namespace prospect
