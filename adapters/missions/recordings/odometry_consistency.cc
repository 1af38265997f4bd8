// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/odometry_consistency.h"

#include <algorithm>

#include "perception/odometry/se3.h"

namespace prospect {
namespace {

constexpr int kFrames[3] = {5, 10, 20};

}  // namespace

void OdometryConsistency::add(const StereoOdometry& odometry, const OdometryFrame& frame,
                              const std::optional<Eigen::Isometry3d>& true_T_WC) {
  const std::int64_t now = frames_++;
  while (!known_.empty() && known_.front().frame < now - kFrames[2]) known_.pop_front();
  if (!true_T_WC || frame.state == Localization::kLost) return;
  if (!first_) {
    first_ = {now, frame.T_WC, *true_T_WC};
  } else {
    const Eigen::Isometry3d truth = first_->estimate * first_->truth.inverse() * *true_T_WC;
    pose_.push_back(
        normalised_error_squared(log_se3(frame.T_WC.inverse() * truth).eval(), frame.covariance));
  }
  for (int h = 0; h < 3; ++h) {
    const auto then = std::find_if(known_.begin(), known_.end(),
                                   [&](const Known& k) { return k.frame == now - kFrames[h]; });
    const auto covariance = odometry.covariance_since(kFrames[h]);
    if (then == known_.end() || !covariance) continue;
    const Eigen::Isometry3d estimated = frame.T_WC.inverse() * then->estimate;
    const Eigen::Isometry3d motion = true_T_WC->inverse() * then->truth;
    motions_[h].push_back(
        normalised_error_squared(log_se3(motion * estimated.inverse()).eval(), *covariance));
  }
  known_.push_back({now, frame.T_WC, *true_T_WC});
}

void OdometryConsistency::begin_recording() {
  frames_ = 0;
  first_.reset();
  known_.clear();
}

ConsistencyResult OdometryConsistency::result() const {
  ConsistencyResult result;
  result.pose = pose_consistency(pose_, 6);
  for (int h = 0; h < 3; ++h) {
    result.motions.push_back({kFrames[h], pose_consistency(motions_[h], 6)});
  }
  return result;
}

}  // namespace prospect
