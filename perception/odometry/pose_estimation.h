// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "models/camera.h"
#include "perception/odometry/point_observation.h"
#include "perception/odometry/se3.h"

namespace prospect {

class Knobs;

struct PoseEstimatorOptions {
  /// [px] of a tracked position, each coordinate, and of its column in the right image: what all
  /// have in common, to which each point's texture adds its own (PointObservation).
  double sigma_left = 0.1;
  double sigma_right = 0.1;
  int ransac_hypotheses = 200;
  double ransac_confidence = 0.999;
  /// Gates, squared and in whitened units: of RANSAC (two coordinates) and of the last solution
  /// (two or three).
  double ransac_gate = 13.8;  ///< chi^2_2, 0.999
  double final_gate = 11.3;   ///< chi^2_3, 0.99
  double huber = 1.5;         ///< [standard deviations]
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, PoseEstimatorOptions& options);

struct PoseEstimate {
  bool solved = false;
  Eigen::Isometry3d T_CW = Eigen::Isometry3d::Identity();
  /// H = sum d_pose^T S^-1 d_pose over the inliers, for xi = (t, omega) in C.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  /// max(1, chi^2/dof) H^-1; infinite diagonal if H's smallest eigenvalue (metres and radians) does
  /// not fix the pose.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<char> inlier;  ///< parallel to the observations
  /// m of every observation given both views: the measurement, corrected by what is seen now.
  std::vector<Eigen::Vector3d> measured;
  int inliers = 0;
  double chi2_per_dof = 0.0;
  int degrees = 0;  ///< of freedom of chi^2

  double sigma_position() const;  ///< sqrt of the largest eigenvalue of the position's block [m]
  double sigma_rotation() const;  ///< likewise [rad]
};

/// RANSAC (Fischler and Bolles 1981) on the left image: each hypothesis is the pose that three
/// points fix, by Gauss-Newton from `prior`; residuals are whitened by tracking noise and the
/// point's covariance (S below), seen from the prior; each new best is refined on the points that
/// agree. `solved` if at least max(6, a fifth) agree; then T_CW, inlier and inliers are set. The
/// generator starts at `seed`: same input, same bits.
PoseEstimate ransac_pose(const StereoCamera& camera,
                         const std::vector<PointObservation>& observations,
                         const Eigen::Isometry3d& prior, std::uint64_t seed,
                         const PoseEstimatorOptions& options = {});

/// Maximum likelihood of pose and points with Huber's loss over the observations flagged in `use`
/// (empty: all): what was measured then, m_i, and what is seen now are both noisy,
///   min over T, m_i   sum rho(r_i(T, m_i)^T R^-1 r_i + (m_i - measured_i)^T M_i^-1 (m_i -
///   measured_i)),
/// R = diag(sigma_left^2, sigma_left^2, sigma_right^2), M = diag(sigma^2). By Gauss-Newton; m_i is
/// eliminated, which leaves 6 unknowns, the residual r + dr/dm (measured - m) and its covariance
///   S = R + dr/dm M dr/dm^T.
/// That m_i moves along matters: derivatives at the noisy measurement would draw the motion towards
/// zero (errors in variables). Then gated by chi^2 and solved again without loss over the inliers,
/// until the set settles (three times at most). Not solved if fewer than six inliers remain or the
/// normal equations are singular.
PoseEstimate refine_pose(const StereoCamera& camera,
                         const std::vector<PointObservation>& observations,
                         const std::vector<char>& use, const Eigen::Isometry3d& start,
                         const PoseEstimatorOptions& options = {});

}  // namespace prospect
