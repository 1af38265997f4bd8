// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "perception/odometry/image_pyramid.h"

namespace prospect {

/// The newest pose that was trusted, and how the camera moved when it was taken.
struct TrustedPose {
  Eigen::Isometry3d T_CW = Eigen::Isometry3d::Identity();
  double stamp = 0.0;   ///< [s]
  PyramidLevel coarse;  ///< the coarsest level of its left image
  /// xi per second, T_CW <- exp(velocity dt) T_CW, xi = (t, omega) in C; empty: not known.
  std::optional<Eigen::Matrix<double, 6, 1>> velocity;
  PyramidLevel middle;  ///< a quarter of its left image's width, to see whether the view is still

  /// The newest pose of all, at `now` [s]. After more than a second the motion counts as not known.
  void take(const Eigen::Isometry3d& pose, double now, const PyramidLevel& image);

  /// The pose at `now` if the camera goes on as it did for `longest` [s] at most: a motion does not
  /// go on for ever. The velocity must be known.
  Eigen::Isometry3d continued(double now, double longest = kLikely) const;

  static constexpr double kLikely = 0.5;  ///< [s] for which a motion is likely to go on
};

}  // namespace prospect
