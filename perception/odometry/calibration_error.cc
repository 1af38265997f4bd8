// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/calibration_error.h"

namespace prospect {

CalibrationMatrix calibration_covariance(const CalibrationErrorOptions& options, double disparity) {
  Eigen::Matrix<double, kCalibrationErrors, 1> sigma;
  sigma << options.principal_point, options.principal_point, options.focal_length, options.baseline,
      disparity;
  return sigma.cwiseAbs2().asDiagonal();
}

Eigen::Matrix<double, 3, kCalibrationErrors> by_calibration(const StereoCamera& camera,
                                                            const PointObservation& o,
                                                            const ObservationResidual& residual,
                                                            const Eigen::Vector3d& m) {
  // The point that was measured is X = b/d (u - cx, v - cy, f) for equal focal lengths; each error
  // moves it as some change of m would, and moves where the images show it besides.
  const double right = o.sees_right() ? 1.0 : 0.0;
  const PinholeCamera& left = camera.left;
  const Eigen::Vector3d from_centre(m.x() - left.cx, m.y() - left.cy, m.z());
  // Where the images would show the point: what they do show less the residual.
  const double u = o.left.x() - residual.r[0], v = o.left.y() - residual.r[1];
  const double u_right = right > 0.0 ? o.right - residual.r[2] : 0.0;
  Eigen::Matrix<double, 3, kCalibrationErrors> J;
  J.col(0) = -residual.d_measured.col(0) - Eigen::Vector3d(1.0, 0.0, right);
  J.col(1) = -residual.d_measured.col(1) - Eigen::Vector3d(0.0, 1.0, 0.0);
  J.col(2) = -residual.d_measured * from_centre -
             Eigen::Vector3d(u - left.cx, v - left.cy, right * (u_right - left.cx));
  J.col(3) = -m.z() * residual.d_measured.col(2) + Eigen::Vector3d(0.0, 0.0, right * (u - u_right));
  J.col(4) = residual.d_measured.col(2) - Eigen::Vector3d(0.0, 0.0, right);
  return J;
}

}  // namespace prospect
