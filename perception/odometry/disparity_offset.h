// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace prospect {

class Knobs;

/// How the error of the disparities' zero is estimated on the way (drift_measurement.h).
struct DisparityOffsetOptions {
  /// [px] of a calibration: that of three real cameras is wrong by 0.6 px RMS. 0: the offset is
  /// not estimated.
  double prior_sigma = 0.6;
  /// [px] by which it may wander from one update to the next.
  double walk_sigma = 0.01;
  /// A landmark speaks once the camera has moved by this share of its depth since it was made. So
  /// many must speak together.
  double min_baseline = 0.1;
  int min_points = 25;
  double max_offset = 2.0;  ///< [px]
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, DisparityOffsetOptions& options);

}  // namespace prospect
