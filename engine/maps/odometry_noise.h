// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace prospect {

class Knobs;

/// Noise of the odometry: a random walk in distance and angle, and an error of the scale, which is
/// the same on the whole path (our choice of shape):
///   Cov position = (position_per_metre^2 s + position_per_radian^2 a) I + scale^2 d d^T   [m^2]
///   Var yaw      = yaw_per_metre^2 s + yaw_per_radian^2 a                               [rad^2]
/// after s metres travelled and a radians turned, to the displacement d [m], with `reference_count`
/// points in view. With N points the random walk's variances grow by
/// (reference_count + floor_count) / (N + floor_count): about 1/N, as the covariance of a
/// least-squares pose does, and bounded at N = 0.
struct OdometryNoise {
  double position_per_metre = 0.002;   ///< [m / sqrt(m)]
  double position_per_radian = 0.002;  ///< [m / sqrt(rad)]
  double yaw_per_metre = 0.0005;       ///< [rad / sqrt(m)]
  double yaw_per_radian = 0.001;       ///< [rad / sqrt(rad)]
  double reference_count = 200.0;      ///< points at which the values above hold
  double floor_count = 2.0;            ///< > 0
  double scale = 0.0;                  ///< of displacements, a standard deviation [-]
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, OdometryNoise& options);
/// Those of them that are of the random walk.
void describe_random_walk(Knobs& knobs, OdometryNoise& options);

}  // namespace prospect
