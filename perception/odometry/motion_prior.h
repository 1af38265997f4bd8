// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace prospect {

class Knobs;

struct MotionPriorOptions {
  /// Standard deviations of the acceleration, each axis, before any motion was seen.
  double acceleration = 3.0;       ///< [m/s^2]
  double turn_acceleration = 6.0;  ///< [rad/s^2]
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, MotionPriorOptions& options);

/// How likely a motion is, given the one before it.
///
/// The velocity of a camera is a random walk: over a step of dt [s] it goes on as before but for an
/// acceleration a,
///   xi = v dt + a dt^2,   a ~ N(0, diag(s_t^2 I, s_r^2 I)),   xi = (t, omega) in C.
/// s_t and s_r are learned from the motions that were taken: with their mean squares m over n
/// motions, older ones counting less, and the stated s_0 for nu_0 = 3 motions more,
///   s^2 = (nu_0 s_0^2 + n m) / nu,   nu = nu_0 + n,
/// each of the two parts of a is Student's t with nu degrees of freedom: a robot that has driven
/// smoothly is not expected to jump, but it may.
///
/// Deterministic. Not thread-safe.
class MotionPrior {
 public:
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  explicit MotionPrior(const MotionPriorOptions& options = {});

  /// A motion that was taken; `change`: xi - v dt [m], [rad].
  void add(const Vector6d& change, double dt);
  /// Logarithm of the density of such a change over that of none: at most 0.
  double log_likelihood(const Vector6d& change, double dt) const;

 private:
  struct Level {
    double stated = 0.0;  // s_0^2
    double noise = 0.0;   // variance of a measured motion
    double sum = 0.0, count = 0.0;
    double variance() const;
    double degrees() const;
  };
  Level translation_, rotation_;
};

}  // namespace prospect
