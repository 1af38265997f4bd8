// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "perception/odometry/calibration_error.h"

namespace prospect {

/// Covariance of poses that are measured against landmarks of several earlier poses, their anchors,
/// against the first pose of all.
///
/// What makes a pose wrong is of four kinds. With xi = (t, omega) in each camera's own frame, true
/// T_CW = exp(e_C) T_CW, and a landmark i of the anchor A(i) that is seen with the residual r_i,
/// its derivatives J_i (pose), and weight W_i,
///   e_C = H^-1 ( sum_A H_A Ad(T_CA) e_A  +  sum_k G_k x_k  -  B c )  +  n,
///   H = sum_A H_A,   H_A = sum of J_i^T W_i J_i over the landmarks of A,   n ~ N(0, noise):
/// * e_A, the errors of the anchors' poses, so errors of anchors that go on being seen do not add
///   up from pose to pose;
/// * x_k, errors that last, each of three numbers of variance 1 and independent of all others, and
///   G_k what this pose owes to it (shared_errors.h): the motion between two frames does not owe to
///   what both share, and the pose itself gains nothing from seeing it again;
/// * c, the errors of the calibration (calibration_error.h), the same in all frames: they bend and
///   stretch all motions alike, and so grow with the way;
/// * n, what is new in every frame.
/// To first order this is exact for errors that are independent otherwise.
///
/// One of c is estimated on the way, the zero of the disparities, from what a frame says about it:
///   s = c_d + sum_A a_A e_A + sum_k g_k x_k + b c + n_s,
/// b without c_d. It is corrected by K s, K = cov(c_d, s) / var(s), and all else is considered: it
/// is not corrected, but what it shares with s is counted (Schmidt 1966). So what was said before,
/// by the same landmarks or at poses that owe to it, is not taken for news.
///
/// The joint covariance of c, of all anchors kept and of the errors that last is kept, but for the
/// latter's own block, which never changes. Deterministic. Not thread-safe.
class PoseDrift {
 public:
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  using Calibration = CalibrationMatrix;

  /// What a pose owes to one anchor.
  struct Reference {
    std::uint64_t anchor = 0;
    Eigen::Isometry3d T_CA = Eigen::Isometry3d::Identity();
    Matrix6d information = Matrix6d::Zero();  ///< H_A
  };
  /// What it owes to one error that lasts.
  struct Share {
    std::uint64_t error = 0;
    Eigen::Matrix<double, 6, 3> gain = Eigen::Matrix<double, 6, 3>::Zero();  ///< G_k
  };
  struct Measurement {
    std::vector<Reference> references;
    std::vector<Share> shares;  ///< of an error one at most
    Eigen::Matrix<double, 6, kCalibrationErrors> by_calibration =
        Eigen::Matrix<double, 6, kCalibrationErrors>::Zero();  ///< B
    Matrix6d noise = Matrix6d::Zero();
  };
  /// What a frame says about the disparities' zero.
  struct Evidence {
    double value = 0.0;  ///< s, by how much more the zero is off than was assumed [px]
    std::vector<std::pair<std::uint64_t, Eigen::Matrix<double, 1, 6>>> anchors;  ///< a_A
    std::vector<std::pair<std::uint64_t, Eigen::RowVector3d>> errors;            ///< g_k
    Eigen::Matrix<double, 1, kCalibrationErrors> by_calibration =
        Eigen::Matrix<double, 1, kCalibrationErrors>::Zero();  ///< b, 1 for c_d itself
    double noise = 0.0;                                        ///< variance of n_s [px^2]
  };

  /// `calibration`: covariance of c.
  explicit PoseDrift(const Calibration& calibration = Calibration::Zero());

  /// A map begins: only this anchor, with a covariance that owes nothing to what was before.
  void begin(std::uint64_t anchor, const Matrix6d& covariance);

  /// A new pose; returns the covariance of e_C. Anchors that are not kept count as exact. The sum
  /// of the references' information must be positive definite.
  Matrix6d measure(const Measurement& measurement);
  /// Covariance of the motion from an anchor to the pose measured last, of e_C - Ad(T_CA) e_A:
  /// errors that both share do not count. The pose's own if the anchor is not kept.
  Matrix6d since(std::uint64_t anchor, const Eigen::Isometry3d& T_CA) const;
  /// The pose measured last becomes an anchor.
  void add(std::uint64_t anchor);
  /// From now on x of these errors is kept x + sqrt(1 - kept^2) x', x' new and of variance 1 (Gauss
  /// and Markov). Those that no pose owes to are passed over. 0 <= kept <= 1.
  void fade(const std::vector<std::uint64_t>& errors, double kept);
  /// Forgets all other anchors and errors. An error that counts again afterwards counts as a new
  /// one. Both lists in ascending order.
  void keep(const std::vector<std::uint64_t>& anchors, const std::vector<std::uint64_t>& errors);

  /// By how much to correct the disparities' zero [px], after it has wandered by `wandered`
  /// [px^2], up to the variance `most`.
  double estimate(const Evidence& evidence, double wandered, double most);

  /// Variance of an error of the calibration.
  double calibration_variance(int error) const { return P_(error, error); }
  std::size_t anchors() const { return anchors_.size() - free_rows_.size(); }

 private:
  Eigen::Index row_of(std::uint64_t anchor) const;  ///< -1: not kept
  Eigen::Index column_of(std::uint64_t error);      ///< made if it is new

  // Places of anchors and errors, by their numbers; those that are free are used again.
  std::vector<std::uint64_t> anchors_, errors_;
  std::vector<std::size_t> free_rows_, free_columns_;
  std::unordered_map<std::uint64_t, Eigen::Index> columns_;
  // z = (c, e_A for all anchors), x = (x_k for all errors).
  Eigen::MatrixXd P_;                      ///< cov(z, z)
  Eigen::MatrixXd to_errors_;              ///< cov(z, x)
  Eigen::MatrixXd last_, last_to_errors_;  ///< cov(e_C, z), cov(e_C, x) of the pose measured last
  Matrix6d last_covariance_ = Matrix6d::Zero();
};

}  // namespace prospect
