// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "perception/mapping/ground_plane.h"

namespace prospect {

void describe(Knobs& knobs, GroundPlaneOptions& o) {
  knobs.integer("stride", o.stride, {1, 64}, "px", "between pixels that are used");
  knobs.integer("score_stride", o.score_stride, {1, 64}, "px",
                "between pixels that score a plane, rounded down to a multiple of stride");
  knobs.number("noise_constant", o.noise_constant, {0.0, 1.0}, "m", "deviation of a depth");
  knobs.number("noise_quadratic", o.noise_quadratic, {0.0, 1.0}, "1/m",
               "the same, times the squared depth");
  knobs.number("unevenness", o.unevenness, {0.0, 1.0}, "m", "deviation of the floor itself");
  knobs.number("gate", o.gate, {0.1, 100.0}, "1",
               "standard deviations within which a point is of the ground");
  knobs.number("confidence", o.confidence, {0.1, 0.999999}, "1",
               "that some draw had all its points on the ground");
  knobs.integer("most_draws", o.most_draws, {1, 10000000}, "1", "of three points");
  knobs.integer("patch", o.patch, {1, 100000}, "px", "within which errors of depth are as one");
  knobs.number("min_share", o.min_share, {0.0, 1.0}, "1",
               "of the points that must be of the ground");
  knobs.number("most_below", o.most_below, {0.0, 100.0}, "1",
               "points below the ground, of those on it");
  knobs.number("most_sigma_tilt", o.most_sigma_tilt, {0.0, 1.5}, "rad",
               "deviation of its tilt; more: not found");
  knobs.number("most_sigma_height", o.most_sigma_height, {0.0, 100.0}, "m",
               "deviation of its height; more: not found");
}

}  // namespace prospect
