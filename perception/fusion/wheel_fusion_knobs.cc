// SPDX-License-Identifier: Apache-2.0
// The descriptions of options, in a library of their own: reading a configuration builds nothing
// that acts on them.

#include "models/knobs.h"
#include "perception/fusion/scale_agreement.h"
#include "perception/fusion/wheel_fusion.h"

namespace prospect {

void describe(Knobs& knobs, ScaleAgreementOptions& o) {
  knobs.number("least", o.least, {0.0, 10.0}, "1", "logarithm of a ratio of lengths that matters");
  knobs.number("significance", o.significance, {0.0, 1e3}, "1", "standard deviations");
  knobs.integer("least_samples", o.least_samples, {1, 100000}, "1", "fewer say nothing");
}

void describe(Knobs& knobs, WheelNoise& o) {
  knobs.number("along", o.along, {0.0, 10.0}, "m/sqrt(m)", "error of the distance");
  knobs.number("across", o.across, {0.0, 10.0}, "m/sqrt(m)", "error to the side");
  knobs.number("turn", o.turn, {0.0, 10.0}, "rad/sqrt(rad)", "error of the heading from turning");
  knobs.number("heading", o.heading, {0.0, 10.0}, "rad/sqrt(m)",
               "error of the heading from driving");
  knobs.number("sigma_scale", o.sigma_scale, {0.0, 10.0}, "1",
               "error of the scales of speed and yaw rate");
}

void describe(Knobs& knobs, WheelFusionOptions& o) {
  describe(knobs, o.noise);
  knobs.number("scale_walk", o.scale_walk, {0.0, 10.0}, "1/sqrt(m)", "by which the scales wander");
  knobs.number("gate", o.gate, {0.1, 1e6}, "1", "chi squared up to which vision agrees with them");
  knobs.integer("slips", o.slips, {1, 10000}, "1",
                "visual frames in a row beyond the gate: the wheels have slipped");
  knobs.number("max_wheel_gap", o.max_wheel_gap, {0.001, 1e3}, "s",
               "without a sample, after which nothing is known of the motion");
  knobs.number("unknown_speed", o.unknown_speed, {0.001, 100.0}, "m/sqrt(s)",
               "of the motion that the robot may make then, and rad/sqrt(s) of the turn");
  knobs.number("max_wait", o.max_wait, {0.001, 1e3}, "s", "that a visual frame may arrive late");
  knobs.number("max_dead_reckoning", o.max_dead_reckoning, {0.001, 1e6}, "m",
               "deviation of the path made on wheels alone above which the robot is lost");
  knobs.number("piece", o.piece, {0.001, 1e3}, "m",
               "of the path, over which lengths by vision and by wheels are compared");
  knobs.integer("pieces", o.pieces, {1, 100000}, "1", "of them that are kept");
  knobs.group("agreement", [&] { describe(knobs, o.agreement); });
}

}  // namespace prospect
