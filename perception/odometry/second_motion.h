// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <vector>

#include "perception/odometry/motion_prior.h"
#include "perception/odometry/trusted_pose.h"

namespace prospect {

/// Landmarks that agree on a motion of the camera, one of several in a frame: as many things as
/// move, one of them the world.
struct MotionHypothesis {
  Eigen::Isometry3d T_CW = Eigen::Isometry3d::Identity();  ///< if they are the world
  std::vector<std::size_t> members;                        ///< places of their tracks
  double depth = 0.0;                                      ///< their median [m]
  int cells = 0;  ///< of the image, an eighth wide, that show one
};

/// What is expected of the motion to a frame.
struct MotionExpectation {
  Eigen::Isometry3d T_CW = Eigen::Isometry3d::Identity();  ///< as the camera moved before
  double dt = 0.0;                                         ///< [s] since the frame before
  const MotionPrior* prior = nullptr;                      ///< null: nothing is known
  const TrustedPose* before = nullptr;                     ///< the frame before; null: none
  /// What was found moving before: the pose of the camera if that were the world.
  std::optional<Eigen::Isometry3d> moving_T_CW;
};

/// Logarithm of the odds that the world is `a` and not `b`:
///   2 ln(c_a / c_b) + l_a - l_b + depth,
/// c the parts of the view that they cover, as of two things the larger one is the world, but
/// landmarks only count texture; l the log-likelihood of the motion that each implies; depth =
/// +-2.2, since nine times in ten it is the nearer one that moves, before the farther one (0 if the
/// medians differ by less than a tenth).
double world_log_odds(const MotionHypothesis& a, const MotionHypothesis& b,
                      const MotionExpectation& expected);

/// The pose if the landmarks that were found to move had been the world, and how likely that is.
///
/// As long as they are seen it goes on with them, afterwards it keeps its distance from the pose
/// that was taken. With T' the pose that it would be, e = log(T_CW^-1 T'_CW) in W, and its
/// probability w, the pose is off by e or by nothing; its covariance in C is larger by
///   w Ad(T_CW) e e^T Ad(T_CW)^T,
/// which covers both. Several, one after the other, are independent. Not thread-safe.
class SecondMotion {
 public:
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;

  /// One is found; it was at one with the pose before, which moved by `velocity` (trusted_pose.h).
  /// `log_odds` of the pose that was taken against it.
  void begin(const Eigen::Isometry3d& before_T_CW, double stamp,
             const std::optional<Vector6d>& velocity, double log_odds);
  /// It is seen: the pose that was taken, and the one by it.
  void see(const Eigen::Isometry3d& T_CW, const Eigen::Isometry3d& other_T_CW, double stamp);
  /// It is out of sight.
  void end();
  /// For `dt` [s] what was tracked may have been carried along, and what the camera did meanwhile
  /// is not known: it may have gone by kUnknownSpeed and turned by kUnknownTurn.
  void unknown(double dt) { unknown_ += dt; }
  static constexpr double kUnknownSpeed = 0.6, kUnknownTurn = 0.3;  ///< each axis [m/s], [rad/s]

  bool seen() const { return live_; }
  double stamp() const { return stamp_; }  ///< of the newest frame that saw it [s]
  /// The pose by it at `stamp` [s], if it goes on; none: it is not seen.
  std::optional<Eigen::Isometry3d> expected(double stamp) const;
  /// w of the one that is seen; 0: none is.
  double probability() const { return live_ ? probability_ : 0.0; }
  /// By what the covariance in C of the pose is larger.
  Matrix6d covariance(const Eigen::Isometry3d& T_CW) const;
  /// Sum of sqrt(w) e, in W, and of the times that are not known [s].
  struct Sum {
    Vector6d known = Vector6d::Zero();
    double unknown = 0.0;
  };
  Sum sum() const { return {ended_sum_ + newest_, unknown_}; }
  /// By what the covariance in C of the motion is larger, since the sum was `then`.
  Matrix6d covariance_since(const Sum& then, const Eigen::Isometry3d& T_CW) const;

 private:
  bool live_ = false;
  double probability_ = 0.0;
  Eigen::Isometry3d T_CW_ = Eigen::Isometry3d::Identity();
  double stamp_ = 0.0;
  std::optional<Vector6d> velocity_;
  Vector6d newest_ = Vector6d::Zero(), ended_sum_ = Vector6d::Zero();  // sqrt(w) e
  Matrix6d ended_ = Matrix6d::Zero();
  double unknown_ = 0.0;
};

}  // namespace prospect
