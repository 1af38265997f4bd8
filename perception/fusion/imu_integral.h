// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <deque>
#include <optional>
#include <string>

#include "models/imu_sample.h"

namespace prospect {

/// What an IMU has measured from one time to another, in B at the first of them, B0.
struct ImuMotion {
  double dt = 0.0;                                            ///< [s]
  Eigen::Quaterniond R_B0B = Eigen::Quaterniond::Identity();  ///< the turn
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();         ///< integral of R f [m/s]
  Eigen::Vector3d way = Eigen::Vector3d::Zero();              ///< its integral [m]
  bool has_force = false;  ///< there is an accelerometer; else velocity and way are zero
};

/// The newest samples of an IMU, and their integrals. With omega and f in B, each the mean of two
/// neighbouring samples over the time between them (trapezoids), b the bias of the gyro:
///   R(t + dt) = R(t) exp((omega - b) dt),
///   velocity(t + dt) = velocity(t) + R(t + dt/2) f dt,   way(t + dt) = way + velocity dt + ...
/// Gravity is in f: who stands gains 9.8 m/s upwards in a second.
///
/// Thread-safety: one thread. Never throws. Deterministic.
class ImuIntegral {
 public:
  /// keep: how much of the past [s]; max_gap: longest time between two samples [s].
  ImuIntegral(double keep, double max_gap) : keep_(keep), max_gap_(max_gap) {}

  /// Samples in order. Why it is refused; empty: it is taken. Refused: not finite, what no body
  /// does (100 rad/s, 1000 m/s^2), and what repeats the sample before in all six numbers: noise
  /// does not, a sensor that hangs does.
  std::string add(const ImuSample& sample);

  /// None: the samples do not cover that time. The newest holds for max_gap.
  std::optional<ImuMotion> between(double from, double until, const Eigen::Vector3d& bias) const;

 private:
  struct Sample {
    double stamp = 0.0;
    Eigen::Vector3d omega, force;  // in B
  };
  double keep_, max_gap_;
  std::optional<ImuSample> newest_;  // as it came
  std::deque<Sample> samples_;
};

}  // namespace prospect
