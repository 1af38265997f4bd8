// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "perception/odometry/odometry.h"

namespace prospect {

/// Frames whose position is off by more than is claimed: by more than 5 cm and by more than four of
/// the standard deviations claimed, the root of the trace.
struct WrongFrames {
  static constexpr double kError = 0.05, kSigmas = 4.0;  // [m], [1]
  int ok = 0, other = 0;
  double worst = 0.0;  ///< error over claim, of all that are off by more than kError

  void add(const OdometryFrame& frame, const Eigen::Isometry3d& truth) {
    if (frame.state == Localization::kLost) return;
    const double error = (frame.T_WC.translation() - truth.translation()).norm();
    if (!(error > kError)) return;
    const double ratio = error / std::sqrt(frame.covariance.topLeftCorner<3, 3>().trace());
    worst = std::max(worst, ratio);
    if (ratio > kSigmas) ++(frame.state == Localization::kOk ? ok : other);
  }
};

}  // namespace prospect
