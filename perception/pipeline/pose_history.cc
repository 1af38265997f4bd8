#include "perception/pipeline/pose_history.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace prospect {

void PoseHistory::add(double stamp, const Pose& pose) {
  poses_.emplace_back(stamp, pose);
  while (poses_.size() > 2 && poses_[1].first <= stamp - span_) poses_.pop_front();
}

std::optional<Pose> PoseHistory::at(double stamp) const {
  const auto after =
      std::find_if(poses_.begin(), poses_.end(), [&](const auto& p) { return p.first >= stamp; });
  if (after == poses_.end()) return std::nullopt;
  if (after->first == stamp) return after->second;
  if (after == poses_.begin()) return std::nullopt;
  const auto& [t, from] = *std::prev(after);
  const Pose& to = after->second;
  const double share = (stamp - t) / (after->first - t);
  return Pose{from.position + share * (to.position - from.position),
              from.yaw + share * std::remainder(to.yaw - from.yaw, 2.0 * M_PI)};
}

std::optional<double> PoseHistory::newest() const {
  if (poses_.empty()) return std::nullopt;
  return poses_.back().first;
}

}  // namespace prospect
