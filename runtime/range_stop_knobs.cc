// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "models/knobs.h"
#include "models/robot_description.h"
#include "models/robot_shape.h"
#include "runtime/range_stop.h"

namespace prospect {

void describe(Knobs& knobs, RangeStopOptions& o) {
  knobs.number("front", o.front, {0.01, 10.0}, "m", "of the body, ahead of B's origin");
  knobs.number("rear", o.rear, {0.01, 10.0}, "m", "of the body, behind it");
  knobs.number("left", o.left, {0.01, 10.0}, "m", "of the body, to its left");
  knobs.number("right", o.right, {0.01, 10.0}, "m", "of the body, to its right");
  knobs.number("corner_radius", o.corner_radius, {0.0, 10.0}, "m",
               "of the body's outline; the half of its shorter side: a disc");
  knobs.number("lowest", o.lowest, {-10.0, 10.0}, "m", "height in B below which all is floor");
  knobs.number("highest", o.highest, {-10.0, 10.0}, "m",
               "height in B above which the body passes under");
  knobs.number("floor", o.floor, {-10.0, 10.0}, "m", "height in B of the floor");
  knobs.number("drop", o.drop, {0.0, 1000.0}, "m",
               "below the floor, from which on it is no ground");
  knobs.number("margin", o.margin, {0.0, 1.0}, "m", "kept from what is seen");
  knobs.number("reaction_time", o.reaction_time, {0.0, 10.0}, "s",
               "from a decision until the base brakes");
  knobs.number("deceleration", o.deceleration, {0.01, 100.0}, "m/s^2", "that the base keeps");
  knobs.number("yaw_deceleration", o.yaw_deceleration, {0.01, 100.0}, "rad/s^2",
               "that the base keeps");
  knobs.number("max_age", o.max_age, {0.0, 60.0}, "s", "of a frame");
  knobs.integer("least_points", o.least_points, {1, 10000}, "1",
                "in the way that are more than noise");
  knobs.number("least_valid", o.least_valid, {0.0, 1.0}, "1",
               "share of the rays in the driven direction that must be valid");
  knobs.number("blind_speed", o.blind_speed, {0.0, 10.0}, "m/s",
               "of the body's fastest point where no ray looks");
  knobs.require(o.lowest < o.highest, "highest", "not above lowest; expected more");
  knobs.require(2.0 * o.corner_radius <= std::min(o.front + o.rear, o.left + o.right) + 1e-9,
                "corner_radius", "more than half of a side; expected at most that");
}

RangeStopOptions range_stop_options(const RobotDescription& robot) {
  constexpr double kFloor = 0.05, kLeast = 0.01;  // [m]
  RangeStopOptions options;
  if (is_round(robot.shape)) {
    const double radius = std::max(kLeast, circumscribed_radius(robot.shape));
    options.front = options.rear = options.left = options.right = options.corner_radius = radius;
  } else {
    options.front = options.rear = options.left = options.right = kLeast;
    options.corner_radius = 0.0;
    for (const OutlinePart& part : ground_outline(robot.shape)) {
      for (const Eigen::Vector2d& corner : part.corners) {
        options.front = std::max(options.front, corner.x() + part.radius);
        options.rear = std::max(options.rear, part.radius - corner.x());
        options.left = std::max(options.left, corner.y() + part.radius);
        options.right = std::max(options.right, part.radius - corner.y());
      }
    }
  }
  const VerticalExtent slice = robot.slice();
  const double base = robot.base_height();
  options.floor = 0.0 - base;  // not -0
  options.lowest = std::max(slice.z_min, kFloor) - base;
  options.highest = std::max(slice.z_max - base, options.lowest + kLeast);
  options.deceleration = robot.model->max_deceleration();
  return options;
}

}  // namespace prospect
