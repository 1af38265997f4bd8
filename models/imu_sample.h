// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace prospect {

/// What an inertial sensor measures: angular velocity by its gyro, and specific force (gravity
/// included: +9.8 upwards at rest) by its accelerometer, along the axes of its frame S.
struct ImuSample {
  double stamp = 0.0;                                             ///< [s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();     ///< in S [rad/s]
  Eigen::Vector3d linear_acceleration = Eigen::Vector3d::Zero();  ///< in S [m/s^2]
  Eigen::Quaterniond R_BS = Eigen::Quaterniond::Identity();       ///< the axes of S in B

  /// About B's z [rad/s], to the left.
  double yaw_rate() const { return (R_BS * angular_velocity).z(); }
  bool finite() const {
    return angular_velocity.allFinite() && linear_acceleration.allFinite() &&
           R_BS.coeffs().allFinite();
  }
};

}  // namespace prospect
