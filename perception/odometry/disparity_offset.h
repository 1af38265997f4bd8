#pragma once

#include <vector>

#include "models/camera.h"
#include "perception/odometry/pose_estimation.h"

namespace prospect {

class Knobs;

/// What one frame says about a constant error of the disparity: the true one is d + delta.
///
/// A pair whose cameras have turned towards each other by 0.3 mrad since calibration (heat is
/// enough) measures all disparities off by a fifth of a pixel, hence far points much too near or
/// too far, and near ones hardly. Motion shows it: seen from elsewhere, points at all depths agree
/// with one pose only for the right delta. With the observations of one frame, linearised at its
/// pose, at its points and at the present delta,
///   minimise over (xi, delta)  sum (r + J xi + j delta)^T W (r + J xi + j delta),
///   j = dr/dm e_3 - e_3 [seen in the right image],
/// xi is eliminated (Schur complement), which leaves information [1/px^2] and the increment's
/// right-hand side. Both are divided by max(1, chi^2/dof) of the pose: noisier images say less.
struct DisparityOffsetEvidence {
  double information = 0.0;  ///< Lambda [1/px^2], >= 0; zero while the camera stands still
  double gradient =
      0.0;  ///< of half the cost at the present delta [1/px]: delta += -gradient/Lambda
};

/// From those inliers of a solved estimate of the same observations that are flagged in `use`.
DisparityOffsetEvidence disparity_offset_evidence(const StereoCamera& camera,
                                                  const std::vector<PointObservation>& observations,
                                                  const PoseEstimate& estimate,
                                                  const std::vector<char>& use,
                                                  const PoseEstimatorOptions& options);

struct DisparityOffsetOptions {
  double prior_sigma = 0.3;  ///< [px] of a calibration; 0: the offset is not estimated
  /// [px] by which it may wander from one update to the next.
  double walk_sigma = 0.01;
  /// Evidence is worth this share of what it says: errors of neighbouring patches are alike.
  double trust = 0.5;
  /// A landmark speaks once only, as its own disparity's error is the same ever after: when the
  /// camera has moved by this share of its depth. So many must speak together.
  double min_baseline = 0.1;
  int min_points = 25;
  double max_offset = 2.0;  ///< [px]
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, DisparityOffsetOptions& options);

/// Kalman filter of delta: a random walk that starts at zero, updated once a keyframe.
class DisparityOffset {
 public:
  explicit DisparityOffset(const DisparityOffsetOptions& options = {})
      : options_(options), variance_(options.prior_sigma * options.prior_sigma) {}

  double value() const { return value_; }  ///< delta [px]
  double sigma() const;                    ///< its standard deviation [px]
  bool estimated() const { return options_.prior_sigma > 0.0; }
  /// Evidence linearised at value(). Returns the increment.
  double update(const DisparityOffsetEvidence& evidence);

 private:
  DisparityOffsetOptions options_;
  double value_ = 0.0;
  double variance_;
};

}  // namespace prospect
