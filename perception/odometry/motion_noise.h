#pragma once

#include <Eigen/Geometry>
#include <deque>
#include <optional>
#include <utility>

#include "engine/maps/odometry_noise.h"
#include "perception/odometry/odometry.h"

namespace prospect {

/// How an odometry's motions err, in the planner's words: an OdometryNoise fitted to the
/// covariances that the odometry claims of its own motions over the newest frames, up to 20 of
/// them. So the planner's prediction knows what those covariances know: the texture of patches, the
/// errors that landmarks keep, the calibration, the noise in the residuals, and how often keyframes
/// are made.
///
/// A claim is of the motion of B in the plane of its x and y axes: y = mean variance of x and y,
/// and variance of yaw, after s metres and a radians with N points in view on average. With m the
/// variance that `assumed` gives and f the mean of y / m, the two terms of each variance are
/// f (u p s + v q a), p and q those of `assumed`, where (u, v) minimise
///   sum_k (y_k / (f m_k) - (u p s_k + v q a_k) / m_k)^2 + k n ((u - 1)^2 + (v - 1)^2),  u, v >= 0,
/// n claims that count, k = 0.05: a robot that has not turned learns nothing of turning, and the
/// ratio stays as assumed. reference_count and floor_count are as assumed. Older claims count less
/// and less, 1/e after 100 frames.
///
/// Claims that grow faster than the way, as those of a wrong calibration do, are met over the spans
/// that are measured: a quarter of the span is claimed up to twice too uncertain, twice the span up
/// to half. Deterministic. Not thread-safe.
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
  /// Sums over the claims, r = y / m, with the share `driven` of m that comes from driving.
  struct Sums {
    double count = 0.0, r = 0.0, r_driven = 0.0, driven = 0.0, driven_squared = 0.0;
    void add(double ratio, double driven_share);
    void forget();
    /// The variances a metre and a radian over those that are assumed.
    std::pair<double, double> factors() const;
  };
  struct Frame {
    Eigen::Isometry3d T_WB;
    double driven = 0.0, turned = 0.0, tracked = 0.0;  ///< so far [m], [rad], points
  };

  Eigen::Isometry3d T_BC_;
  OdometryNoise assumed_;
  std::deque<Frame> frames_;  ///< the newest in a row whose pose was measured
  Sums position_, yaw_;
};

}  // namespace prospect
