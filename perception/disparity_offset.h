#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "models/camera.h"
#include "perception/pose_estimation.h"

namespace prospect {

/// What one frame says about a constant error of the disparity: the true one is d + delta.
///
/// A pair whose cameras have turned towards each other by 0.3 mrad since calibration (heat is
/// enough) measures all disparities off by a fifth of a pixel, hence far points much too near or
/// too far, and near ones hardly. Motion shows it: seen from elsewhere, points at all depths agree
/// with one pose only for the right delta. With the observations of one frame, linearised at its
/// pose and at the present delta,
///   minimise over (xi, delta)  sum (r + J xi + j delta)^T W (r + J xi + j delta),
///   j = d_point dl/ddelta - e_3 [seen in the right image],
/// xi is eliminated (Schur complement), which leaves information [1/px^2] and the increment's
/// right-hand side.
struct DisparityOffsetEvidence {
  double information = 0.0;  ///< Lambda [1/px^2], >= 0; zero while the camera stands still
  double gradient =
      0.0;  ///< of half the cost at the present delta [1/px]: delta += -gradient/Lambda
};

/// `sensitivity`: dl/ddelta of every observation's point, in W [m/px]. Observations with a zero in
/// `use` do not count.
DisparityOffsetEvidence disparity_offset_evidence(const StereoCamera& camera,
                                                  const std::vector<PointObservation>& observations,
                                                  const std::vector<Eigen::Vector3d>& sensitivity,
                                                  const std::vector<char>& use,
                                                  const Eigen::Isometry3d& T_CW,
                                                  const PoseEstimatorOptions& options);

struct DisparityOffsetOptions {
  double prior_sigma = 0.3;  ///< [px] of a calibration; 0: the offset is not estimated
  /// [px] by which it may wander from one update to the next.
  double walk_sigma = 0.01;
  /// Evidence is worth this share of what it says: the same patches speak again and again.
  double trust = 0.25;
  double max_offset = 2.0;  ///< [px]
};

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
