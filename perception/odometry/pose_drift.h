#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <set>
#include <vector>

namespace prospect {

/// Covariance of a pose that is measured against landmarks of several earlier poses, their anchors,
/// against the first pose of all.
///
/// A pose is fixed by what it sees of each anchor's landmarks, and inherits the anchors' errors.
/// With xi = (t, omega) in each camera's own frame, true T_CW = exp(e_C) T_CW, and H = sum_A H_A
/// the information of the observations, H_A of those whose landmarks were made at A,
///   e_C = H^-1 (sum_A H_A Ad(T_CA) e_A - b e_d) + n,    n ~ N(0, noise),
/// e_d the error of the disparity offset (disparity_offset.h), which all landmarks share, and b =
/// sum J^T W j, j = dr/dd. So errors of anchors that go on being seen do not add up from keyframe
/// to keyframe, and one of the disparities, which stretches every motion alike, does. To first
/// order this is exact but for one thing: that the errors of landmarks which several poses see are
/// the same each time counts within a pose only.
///
/// The joint covariance of e_d and all anchors kept is a matrix of 1 + 6 (number of anchors) rows.
/// Deterministic. Not thread-safe.
class PoseDrift {
 public:
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  /// What a pose owes to one anchor.
  struct Reference {
    std::uint64_t anchor = 0;
    Eigen::Isometry3d T_CA = Eigen::Isometry3d::Identity();
    Matrix6d information = Matrix6d::Zero();  ///< H_A
  };

  /// `offset_variance`: of e_d now [px^2], >= 0.
  explicit PoseDrift(double offset_variance = 0.0);

  /// A map begins: only this anchor, with a covariance that owes nothing to what was before.
  void begin(std::uint64_t anchor, const Matrix6d& covariance);

  /// A new pose; returns the covariance of e_C. Anchors that are not kept count as exact. The sum
  /// of the references' information must be positive definite.
  Matrix6d measure(const std::vector<Reference>& references, const Vector6d& b,
                   const Matrix6d& noise);
  /// Covariance of the motion from an anchor to the pose measured last, of e_C - Ad(T_CA) e_A:
  /// errors that both share do not count. The pose's own if the anchor is not kept.
  Matrix6d since(std::uint64_t anchor, const Eigen::Isometry3d& T_CA) const;
  /// The pose measured last becomes an anchor.
  void add(std::uint64_t anchor);
  /// Forgets all other anchors.
  void keep(const std::set<std::uint64_t>& anchors);

  /// The offset was updated: its variance before, what it may have wandered included, and now.
  void update_offset(double predicted_variance, double variance);

  std::size_t anchors() const { return anchors_.size(); }

 private:
  std::vector<std::uint64_t> anchors_;
  Eigen::MatrixXd P_;     ///< of (e_d, e_A for all anchors in order)
  Eigen::MatrixXd last_;  ///< cov(e_C, (e_d, e_A...)) of the pose measured last
  Matrix6d last_covariance_ = Matrix6d::Zero();
};

}  // namespace prospect
