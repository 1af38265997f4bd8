// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_options.h"
#include "models/knobs.h"

namespace prospect {

void describe(Knobs& knobs, GazeboOptions& o) {
  knobs.integer("port", o.address.port, {1, 65535}, "1", "of Gazebo's master");
  knobs.number("timeout", o.address.timeout, {0.1, 600.0}, "s", "to wait for its greeting");
  knobs.integer("depth_width", o.depth_width, {16, 4096}, "px",
                "of the depth image; its height follows from the field of view");
  knobs.number("image_noise", o.image_noise, {0.0, 50.0}, "grey levels",
               "added to what Gazebo renders, one standard deviation; 0: the world's "
               "cameras have noise of their own");
  knobs.number("wheel_radius", o.wheel_radius, {0.001, 10.0}, "m", "of the driven wheels");
  knobs.number("wheel_separation", o.wheel_separation, {0.001, 10.0}, "m",
               "between the middles of the driven wheels");
  knobs.boolean("turned_yaw", o.turned_yaw,
                "the plug-in turns to the right for a positive yaw rate");
  knobs.number("dead_man", o.dead_man, {0.01, 10.0}, "s",
               "of silence after which the relay stops the base");
  knobs.number("period", o.period, {0.001, 1.0}, "s",
               "in which the relay looks, and repeats a stop");
  knobs.number("silence", o.silence, {0.1, 3600.0}, "s",
               "of the machine without an answer after which a world in lockstep is lost");
}

}  // namespace prospect
