// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "models/imu_sample.h"
#include "models/types.h"

namespace prospect {

class Knobs;

/// How the IMU of a simulated robot errs. The defaults are those of data sheets of small MEMS
/// sensors, at the rate that drivers read them.
struct SimulatedImuOptions {
  double rate = 0.0;                 ///< [Hz] of its samples; 0: the robot has none
  double gyro_bias = 0.01;           ///< [rad/s] standard deviation, each axis, drawn once
  double gyro_noise = 0.005;         ///< [rad/s] likewise, of each sample
  double acceleration_bias = 0.1;    ///< [m/s^2] standard deviation, each axis, drawn once
  double acceleration_noise = 0.05;  ///< [m/s^2] likewise, of each sample
};
/// The knobs (models/knobs.h).
void describe(Knobs& knobs, SimulatedImuOptions& options);

/// The IMU of a robot in the plane, at B's origin, along B's axes.
///
/// Between two poses the true robot moves with a constant velocity v (in B) and yaw rate w. Samples
/// are due at k / rate; the one at t_k measures
///   angular velocity   (0, 0, w) + bias + noise,
///   specific force     (v - v')/dt + w x v + (0, 0, 9.81) + bias + noise,
/// v' being the velocity at the sample before, dt = 1 / rate: the simulator's robot changes its
/// velocity at once, which is measured as one sample's.
///
/// Thread-safety: one thread. Deterministic in options, seed and calls. Throws nothing.
class SimulatedImu {
 public:
  SimulatedImu(const SimulatedImuOptions& options, std::uint64_t seed);

  /// What is due after `from` up to `until` [s], while the robot went from one pose to the other.
  std::vector<ImuSample> moved(const Pose& before, double from, const Pose& after, double until);

 private:
  Eigen::Vector3d drawn(double sigma);

  SimulatedImuOptions options_;
  std::mt19937_64 noise_;
  std::normal_distribution<double> normal_;
  Eigen::Vector3d gyro_bias_, acceleration_bias_;
  std::int64_t count_ = 0;                              // of samples so far
  Eigen::Vector2d velocity_ = Eigen::Vector2d::Zero();  // in B, at the newest [m/s]
};

}  // namespace prospect
