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
/// square w of the scale's error make the claims likeliest as variances (gamma deviance):
///   minimise  sum D(y / m, x) + k n (D(f, u) + D(f, v)),   D(y, x) = y / x - ln(y / x) - 1,
///   x = (u p s + v q a + w |d|^2 [along d]) / m,
/// n claims that count, f the mean of y / m across d, k = 0.01: a robot that has not turned learns
/// nothing of turning, and the ratio stays as assumed. What counts is by which factor a claim is
/// missed: variances along d are a thousand times those across it where the scale is not known, and
/// must not drown them. Of yaw the same without w. reference_count and floor_count are as assumed.
/// Older claims count less and less, 1/e after 100 frames, and not at all after 300.
///
/// Before five claims count, the walk is as assumed, and w what the odometry would claim of a
/// motion that is to come (Odometry::motion_ahead): one that begins in motion knows the scale as
/// well as its calibration does, and no better.
///
/// Deterministic. Not thread-safe.
class MotionNoise {
 public:
  /// T_BC: of the camera on the body.
  explicit MotionNoise(const Eigen::Isometry3d& T_BC, const OdometryNoise& assumed = {})
      : T_BC_(T_BC), assumed_(assumed) {}

  /// After each frame that `odometry` has processed, in order.
  void add(const OdometryFrame& frame, const Odometry& odometry);

  /// None if the odometry claims nothing, neither of what was nor of what is to come.
  std::optional<OdometryNoise> noise() const;

 private:
  /// Claims, and the (u, v, w) that fit them best, w in squares of a thousandth.
  class Fit {
   public:
    /// `shares` of m that u, v and w have; `ratio` y / m.
    void add(const Eigen::Vector3d& shares, double ratio);
    /// A frame's claims are entered.
    void finish();
    double count() const { return count_; }
    const Eigen::Vector3d& solved() const { return x_; }

   private:
    struct Claim {
      Eigen::Vector3d shares;
      double ratio, weight;
    };
    /// What is not zero of x, from there; returns what w, if it is zero, would gain [any unit].
    double fit(Eigen::Vector3d& x, double f) const;
    std::deque<Claim> claims_;
    Eigen::Vector3d x_ = Eigen::Vector3d::Zero();
    double count_ = 0.0;  ///< of those without w
  };
  struct Frame {
    Eigen::Isometry3d T_WB;
    double driven = 0.0, turned = 0.0, tracked = 0.0;  ///< so far [m], [rad], points
  };
  struct Fits {
    Fit position, yaw;
  };
  static double claims(const Fits& fits);
  /// A motion, from and in B then, of the covariance `claimed`, with so many points in view.
  void enter(Fits& fits, const Frame& over, const Eigen::Matrix<double, 6, 6>& claimed) const;
  void enter_since(std::size_t span, const Odometry& odometry);
  void enter_ahead(const Odometry& odometry);

  Eigen::Isometry3d T_BC_;
  OdometryNoise assumed_;
  std::deque<Frame> frames_;  ///< the newest in a row whose pose was measured
  Fits measured_, ahead_;
};

}  // namespace prospect
