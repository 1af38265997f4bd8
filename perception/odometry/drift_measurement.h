// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "perception/odometry/pose_drift.h"
#include "perception/odometry/pose_estimation.h"
#include "perception/odometry/shared_errors.h"
#include "perception/odometry/track.h"

namespace prospect {

/// What a pose that was estimated from these observations of the tracks owes to the errors that
/// pose_drift.h keeps, and what it says about the zero of the disparities, linearised at it. Keeps
/// references to what it is made from; made for a pose and thrown away. No state besides.
class DriftMeasurement {
 public:
  /// `noise_variance`: of all noise over what is assumed (residual_noise.h); all errors of
  /// observations are scaled by it.
  DriftMeasurement(const StereoCamera& camera, const std::vector<Track>& tracks,
                   const TrackObservations& observations, const PoseEstimate& pose,
                   const PoseEstimatorOptions& options, const SharedErrorOptions& shared,
                   double noise_variance)
      : camera_(camera),
        tracks_(tracks),
        observations_(observations),
        pose_(pose),
        options_(options),
        shared_(shared),
        noise_variance_(noise_variance) {}

  /// With the errors L x + n of each observation (shared_errors.h), an error that lasts has the
  /// gain sum J^T W L over the observations that share it, and what is new in this frame makes the
  /// noise H^-1 (sum J^T W F W J) H^-1, F of n.
  ///
  /// Points that slide along an edge, lie on a thing that moves or are found in a wrong place err
  /// by more. Where they do so together, a part of the image asks for another pose than the rest.
  /// Without the part k of K (the areas of shared_errors.h) the pose would be another one by
  ///   e_k = (H - H_k)^-1 sum_k J^T W r,
  /// and D = (K - 1)/K sum e_k e_k^T is its covariance by what the parts say (delete-a-group
  /// jackknife, Miller 1974). With C the one by the errors above, along each v of D v = lambda C v,
  /// v^T C v = 1, with lambda > 9, three standard deviations, the noise is larger by
  ///   (lambda - 1) C v v^T C.
  PoseDrift::Measurement of_pose() const;

  /// What the frame says of a constant error of the disparities: the true ones are d + delta.
  ///
  /// A pair whose cameras have turned towards each other by 0.3 mrad since calibration (heat is
  /// enough) measures all disparities off by a fifth of a pixel, hence far points much too near or
  /// too far, and near ones hardly. Motion shows it: seen from elsewhere, points at all depths
  /// agree with one pose only for the right delta. With the observations of one frame, linearised
  /// at its pose, at its points and at the present delta,
  ///   minimise over (xi, delta)  sum (r + J xi + j delta)^T W (r + J xi + j delta),
  ///   j = dr/dm e_3 - e_3 [seen in the right image].
  /// The minimum is s = -sum q^T r / Lambda with q = W (j - J H^-1 sum J^T W j) and
  /// Lambda = sum q^T j, so each error of a residual is in s by its share of -q / Lambda. Over
  /// those inliers that are flagged in `use`. Nothing while the camera stands still.
  std::optional<PoseDrift::Evidence> of_disparity_zero(const std::vector<char>& use) const;

 private:
  /// An inlier, linearised at the pose and the point given both views; r is as if m were measured.
  struct Linearised {
    const Track* track;
    ErrorNumbers numbers;
    ObservationResidual residual;
    Eigen::Matrix3d W;
    Eigen::Matrix<double, 3, kCalibrationErrors> by_calibration;
    ObservationErrors errors;
  };
  bool linearise(std::size_t k, Linearised& at) const;

  const StereoCamera& camera_;
  const std::vector<Track>& tracks_;
  const TrackObservations& observations_;
  const PoseEstimate& pose_;
  const PoseEstimatorOptions& options_;
  const SharedErrorOptions& shared_;
  double noise_variance_;
};

}  // namespace prospect
