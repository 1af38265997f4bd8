// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/pose_history.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace prospect {

void PoseHistory::add(double stamp, const BodyPose& pose) {
  poses_.emplace_back(stamp, pose);
  while (poses_.size() > 2 && poses_[1].first <= stamp - span_) poses_.pop_front();
}

std::optional<BodyPose> PoseHistory::at(double stamp) const {
  const auto after =
      std::find_if(poses_.begin(), poses_.end(), [&](const auto& p) { return p.first >= stamp; });
  if (after == poses_.end()) return std::nullopt;
  if (after->first == stamp) return after->second;
  if (after == poses_.begin()) return std::nullopt;
  const auto& [t, from] = *std::prev(after);
  const BodyPose& to = after->second;
  const double share = (stamp - t) / (after->first - t);
  BodyPose between;
  between.pose = {from.pose.position + share * (to.pose.position - from.pose.position),
                  from.pose.yaw + share * std::remainder(to.pose.yaw - from.pose.yaw, 2.0 * M_PI)};
  between.T_WB.linear() = Eigen::Quaterniond(from.T_WB.linear())
                              .slerp(share, Eigen::Quaterniond(to.T_WB.linear()))
                              .toRotationMatrix();
  between.T_WB.translation() =
      from.T_WB.translation() + share * (to.T_WB.translation() - from.T_WB.translation());
  between.state = std::max(from.state, to.state);
  between.motion = share < 0.5 ? from.motion : to.motion;
  return between;
}

std::optional<double> PoseHistory::newest() const {
  if (poses_.empty()) return std::nullopt;
  return poses_.back().first;
}

}  // namespace prospect
