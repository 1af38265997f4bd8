#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <set>
#include <vector>

#include "perception/odometry/calibration_error.h"

namespace prospect {

/// Covariance of poses that are measured against landmarks of several earlier poses, their anchors,
/// against the first pose of all.
///
/// What makes a pose wrong is of four kinds. With xi = (t, omega) in each camera's own frame, true
/// T_CW = exp(e_C) T_CW, and a landmark i of the anchor A(i) that is seen with the residual r_i,
/// its derivatives J_i (pose) and D_i (what the anchor measured), and weight W_i,
///   e_C = H^-1 ( sum_A H_A Ad(T_CA) e_A  +  sum_i J_i^T W_i D_i m_i  -  B c )  +  n,
///   H = sum_A H_A,   H_A = sum of J_i^T W_i J_i over the landmarks of A,   n ~ N(0, noise):
/// * e_A, the errors of the anchors' poses, so errors of anchors that go on being seen do not add
///   up from pose to pose;
/// * m_i, the error of what the anchor measured of the landmark, the same in every frame that sees
///   it: the motion between two frames does not owe to what both see, and the pose itself gains
///   nothing from seeing it again;
/// * c, the errors of the calibration (calibration_error.h), the same in all frames: they bend and
///   stretch all motions alike, and so grow with the way;
/// * n, what is new in every frame.
/// To first order this is exact for errors that are independent otherwise.
///
/// The joint covariance of c, of all anchors kept and of their landmarks' errors is kept, but for
/// the landmarks' own block, which never changes. Deterministic. Not thread-safe.
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
  /// What it owes to the error of one landmark.
  struct Sight {
    std::uint64_t landmark = 0;
    Eigen::Matrix<double, 6, 3> gain = Eigen::Matrix<double, 6, 3>::Zero();  ///< J^T W D
    /// Variances of m_i [px^2], taken when it is seen for the first time.
    Eigen::Vector3d variance = Eigen::Vector3d::Zero();
  };
  struct Measurement {
    std::vector<Reference> references;
    std::vector<Sight> sights;
    Eigen::Matrix<double, 6, kCalibrationErrors> by_calibration =
        Eigen::Matrix<double, 6, kCalibrationErrors>::Zero();  ///< B
    Matrix6d noise = Matrix6d::Zero();
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
  /// Forgets all other anchors and landmarks. A landmark that is seen again afterwards counts as a
  /// new one.
  void keep(const std::set<std::uint64_t>& anchors, const std::set<std::uint64_t>& landmarks);

  /// One error of the calibration was estimated anew: its variance before, what it may have
  /// wandered included, and now.
  void update_calibration(int error, double predicted_variance, double variance);

  std::size_t anchors() const { return anchors_.size(); }

 private:
  Eigen::Index row_of(std::uint64_t anchor) const;  ///< -1: not kept

  std::vector<std::uint64_t> anchors_, landmarks_;  ///< landmarks in ascending order
  // z = (c, e_A for all anchors in order), l = (m_i for all landmarks in order).
  Eigen::MatrixXd P_;             ///< cov(z, z)
  Eigen::MatrixXd to_landmarks_;  ///< cov(z, l)
  Eigen::VectorXd variances_;     ///< var(l)
  Eigen::MatrixXd last_,
      last_to_landmarks_;  ///< cov(e_C, z), cov(e_C, l) of the pose measured last
  Matrix6d last_covariance_ = Matrix6d::Zero();
};

}  // namespace prospect
