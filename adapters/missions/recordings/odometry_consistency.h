// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "adapters/missions/recordings/pose_consistency.h"
#include "perception/odometry/stereo_odometry.h"

namespace prospect {

/// The covariances that an odometry claims against its errors, where the true poses are known.
struct ConsistencyResult {
  PoseConsistency pose;  ///< of the pose against the first one
  struct Motion {
    int frames = 0;
    PoseConsistency consistency;  ///< of the motion over so many frames
  };
  std::vector<Motion> motions;  ///< over 5, 10 and 20 frames
};

/// Watches an odometry at work. Frames that are lost, or whose true pose is not known, are passed
/// over. Errors are those of xi = (t, omega) with T <- exp(xi) T for the pose T_CW and for the
/// motion of the camera: six degrees of freedom each. Errors of consecutive frames are nearly the
/// same, so of one recording the count says little about how sure the mean is. A truth with errors
/// of its own makes every odometry look too sure.
class OdometryConsistency {
 public:
  /// After each frame that `odometry` has processed, in order.
  void add(const StereoOdometry& odometry, const OdometryFrame& frame,
           const std::optional<Eigen::Isometry3d>& true_T_WC);
  /// Another recording begins, by a new odometry; what was found so far is kept.
  void begin_recording();

  ConsistencyResult result() const;

 private:
  struct Known {
    std::int64_t frame;
    Eigen::Isometry3d estimate, truth;  ///< T_WC
  };
  std::int64_t frames_ = 0;
  std::optional<Known> first_;
  std::deque<Known> known_;  ///< of the newest 21 frames
  std::vector<double> pose_;
  std::vector<double> motions_[3];
};

}  // namespace prospect
