// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <deque>
#include <optional>

#include "engine/maps/odometry_noise.h"
#include "perception/odometry/odometry.h"

namespace prospect {

/// How an odometry's motions err, in the planner's words: an OdometryNoise fitted to the
/// covariances that the odometry claims of its own motions over the newest 5 frames, and over all
/// of the newest up to 20. So the planner's prediction knows what those covariances know: the
/// texture of patches, the errors that landmarks keep, the calibration, the noise in the residuals,
/// and how often keyframes are made.
///
/// A claim is of the motion of B in the plane of its x and y axes, over s metres and a radians to
/// the displacement d, with N points in view on average: the variances y of the position along d
/// and across it, and of yaw. Errors of a random walk show in both directions and grow with s and
/// a; one of the scale shows along d alone and grows with |d|^2. With m the variance that `assumed`
/// gives its random walk, p s and q a the two parts of it, the factors (u, v) of those and the
/// square w of the scale's error minimise
///   sum ((u p s + v q a + w |d|^2 [along d]) / m - y / m)^2 + k n ((u - f)^2 + (v - f)^2),
///   u, v, w >= 0,
/// n claims that count, f the mean of y / m across d, k = 0.01: a robot that has not turned learns
/// nothing of turning, and the ratio stays as assumed. Of yaw the same without w. reference_count
/// and floor_count are as assumed. Older claims count less and less, 1/e after 100 frames.
///
/// Deterministic. Not thread-safe.
class MotionNoise {
 public:
  /// T_BC: of the camera on the body.
  explicit MotionNoise(const Eigen::Isometry3d& T_BC, const OdometryNoise& assumed = {})
      : T_BC_(T_BC), assumed_(assumed) {}

  /// After each frame that `odometry` has processed, in order.
  void add(const OdometryFrame& frame, const Odometry& odometry);

  /// None before five claims count, or if the odometry makes none.
  std::optional<OdometryNoise> noise() const;

 private:
  /// The normal equations of (u, v, w), w in squares of a thousandth.
  struct Fit {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double count = 0.0, ratios = 0.0;  ///< of y / m without w, and their sum
    void add(const Eigen::Vector3d& shares, double ratio);
    void forget();
    Eigen::Vector3d solved() const;
  };
  struct Frame {
    Eigen::Isometry3d T_WB;
    double driven = 0.0, turned = 0.0, tracked = 0.0;  ///< so far [m], [rad], points
  };
  void enter(std::size_t span, const Odometry& odometry);

  Eigen::Isometry3d T_BC_;
  OdometryNoise assumed_;
  std::deque<Frame> frames_;  ///< the newest in a row whose pose was measured
  Fit position_, yaw_;
};

}  // namespace prospect
