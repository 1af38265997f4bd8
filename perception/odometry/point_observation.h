// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "models/camera.h"

namespace prospect {

/// A landmark as it was measured when it was made, and where a stereo pair sees it now.
struct PointObservation {
  /// Pose of the left camera that made it, and what it measured: m = (u, v, d) [px], eq. (1).
  Eigen::Isometry3d T_WA = Eigen::Isometry3d::Identity();
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();          ///< standard deviations of m [px]
  Eigen::Vector2d left = Eigen::Vector2d::Zero();           ///< (u, v) in the left image now [px]
  double right = std::numeric_limits<double>::quiet_NaN();  ///< u in the right one; NaN: not seen
  /// Covariance of `left` and variance of `right` [px^2] that the patch's own texture gives, beside
  /// what all observations have in common.
  Eigen::Matrix2d left_covariance = Eigen::Matrix2d::Zero();
  double right_variance = 0.0;

  bool sees_right() const { return std::isfinite(right); }
};

/// Residual of one observation at the pose T_CW, if what was measured had been m, and derivatives:
///   r = (u, v, u_right) - (Pi(Y), Pi_u(Y - b e_x)),  Y = T_CW T_WA triangulate(m),
///   dr/dxi for T_CW <- exp(xi) T_CW, xi = (t, omega) in C;   dr/dm.
/// The third row is zero where the right image does not see the point.
struct ObservationResidual {
  Eigen::Vector3d r;
  Eigen::Matrix<double, 3, 6> d_pose;
  Eigen::Matrix3d d_measured;
};
/// False if the point is not in front of the camera (Y.z() <= 1 cm) or its disparity not positive.
bool observation_residual(const StereoCamera& camera, const Eigen::Isometry3d& T_CW,
                          const PointObservation& observation, const Eigen::Vector3d& m,
                          ObservationResidual& out);

/// W = S^-1 of such a residual, its covariance given what both views measured,
///   S = R + dr/dm M dr/dm^T,
///   R = diag(sigma_left^2, sigma_left^2, sigma_right^2),   M = diag(sigma^2)    [px^2];
/// zero in the third row and column where the right image does not see the point.
Eigen::Matrix3d observation_weight(const PointObservation& observation,
                                   const ObservationResidual& residual, double sigma_left,
                                   double sigma_right);

}  // namespace prospect
