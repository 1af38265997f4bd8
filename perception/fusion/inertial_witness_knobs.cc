// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "perception/fusion/inertial_witness.h"

namespace prospect {

void describe(Knobs& knobs, InertialOptions& o) {
  knobs.number("gyro_bias", o.gyro_bias, {0.0, 10.0}, "rad/s", "of the gyro before any image");
  knobs.number("bias_walk", o.bias_walk, {0.0, 10.0}, "rad/s/sqrt(s)", "by which it wanders");
  knobs.number("gyro_noise", o.gyro_noise, {0.0, 10.0}, "rad/s",
               "of the gyro's mean between two images");
  knobs.number("gyro_share", o.gyro_share, {0.0, 10.0}, "1",
               "of a turn: scale, axes askew, late stamps");
  knobs.number("acceleration", o.acceleration, {1e-3, 1e3}, "m/s2",
               "left in the accelerometer without gravity and bias");
  knobs.number("gate", o.gate, {0.1, 1e6}, "1", "chi squared up to which vision agrees with it");
  knobs.number("max_gap", o.max_gap, {1e-4, 10.0}, "s",
               "between samples; longer: nothing is measured");
}

}  // namespace prospect
