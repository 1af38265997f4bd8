// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "adapters/missions/recordings/pose_consistency.h"
#include "engine/support/quantile.h"
#include "perception/odometry/odometry.h"
#include "perception/odometry/se3.h"

namespace prospect {

/// How far poses of frames are off, in what is claimed. With xi = (t, omega) of the error in C and
/// C its covariance claimed:
///   position |t| / sqrt(tr C_t),   rotation |omega| / sqrt(tr C_omega),
///   both     sqrt(xi^T C^-1 xi / 6).
class ClaimRatios {
 public:
  struct Ratios {
    double position = 0.0, rotation = 0.0, both = 0.0;
  };
  static Ratios of(const OdometryFrame& frame, const Eigen::Isometry3d& truth) {
    const Eigen::Matrix<double, 6, 1> xi = log_se3(frame.T_WC.inverse() * truth);
    const Eigen::Matrix<double, 6, 6>& C = frame.covariance;
    return {xi.head<3>().norm() / std::sqrt(C.topLeftCorner<3, 3>().trace()),
            xi.tail<3>().norm() / std::sqrt(C.bottomRightCorner<3, 3>().trace()),
            std::sqrt(normalised_error_squared(xi, C) / 6.0)};
  }

  /// The first pose is the truth's own and says nothing.
  void add(const Ratios& ratios) {
    if (!std::isfinite(ratios.position)) return;
    all_[0].push_back(ratios.position);
    all_[1].push_back(ratios.rotation);
    if (std::isfinite(ratios.both)) all_[2].push_back(ratios.both);
  }
  /// What a share q of the frames does not exceed; NaN without any.
  Ratios quantiles(double q) const {
    return {quantile(all_[0], q), quantile(all_[1], q), quantile(all_[2], q)};
  }
  bool empty() const { return all_[0].empty(); }

 private:
  std::vector<double> all_[3];
};

}  // namespace prospect
