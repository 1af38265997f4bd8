// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "models/camera.h"
#include "perception/odometry/point_observation.h"

namespace prospect {

class Knobs;

/// Errors of a stereo calibration, true minus assumed, that all frames share:
///   c = (c_x, c_y [px], focal length, baseline [of themselves], disparity [px]),
/// the principal point of both cameras, the focal length of both, and the zero of the disparities
/// (disparity_offset.h), which is the turn of the cameras towards each other.
inline constexpr int kCalibrationErrors = 5;
inline constexpr int kDisparityError = 4;  ///< place of the disparity's zero in c
using CalibrationMatrix = Eigen::Matrix<double, kCalibrationErrors, kCalibrationErrors>;

/// How far a calibration may be off, as standard deviations: those of a usual one with a board.
struct CalibrationErrorOptions {
  double principal_point = 0.5;  ///< [px], each coordinate
  double focal_length = 0.001;   ///< of itself
  double baseline = 0.001;       ///< of itself
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, CalibrationErrorOptions& options);

/// Covariance of c. `disparity`: standard deviation of the disparities' zero [px].
CalibrationMatrix calibration_covariance(const CalibrationErrorOptions& options, double disparity);

/// dr/dc of an observation's residual, from its linearisation at m. Rows of what the right image
/// does not see are zero.
Eigen::Matrix<double, 3, kCalibrationErrors> by_calibration(const StereoCamera& camera,
                                                            const PointObservation& observation,
                                                            const ObservationResidual& residual,
                                                            const Eigen::Vector3d& m);

}  // namespace prospect
