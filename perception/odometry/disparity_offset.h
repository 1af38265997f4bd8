// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace prospect {

class Knobs;

/// How the error of the disparities' zero is estimated on the way (drift_measurement.h).
struct DisparityOffsetOptions {
  /// [mrad] by which the cameras may have turned towards each other since their calibration: three
  /// real pairs by 0.9 RMS. An angle, for one rig's pixels are not another's. 0: the offset is not
  /// estimated.
  double prior_angle = 0.9;
  /// [px] by which it may wander from one update to the next.
  double walk_sigma = 0.01;
  /// A landmark speaks once the camera has moved by this share of its depth since it was made. So
  /// many must speak together.
  double min_baseline = 0.1;
  int min_points = 25;
  double max_offset = 2.0;  ///< [px]

  /// Of the disparities before any motion was seen [px]; `focal_length` [px].
  double prior_sigma(double focal_length) const { return 1e-3 * prior_angle * focal_length; }
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, DisparityOffsetOptions& options);

}  // namespace prospect
