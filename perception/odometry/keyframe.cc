#include "perception/odometry/keyframe.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

#include "perception/odometry/median.h"
#include "perception/odometry/se3.h"

namespace prospect {

void Keyframe::see(Track& track) {
  track.seen_at_keyframe = track.inlier;
  track.at_keyframe = track.left;
  points += track.inlier;
}

KeyframeEvidence keyframe_evidence(const Keyframe& keyframe, const FrameLocation& location,
                                   const std::vector<Track>& tracks, const ImageGrid& coarse,
                                   double width) {
  KeyframeEvidence evidence;
  evidence.points = location.tracked;
  evidence.points_at_keyframe = keyframe.points;
  evidence.width = width;
  std::vector<char> before(coarse.cells(), 0), now = before;
  std::vector<double> shifts;
  for (const Track& t : tracks) {
    if (t.seen_at_keyframe) before[coarse.cell(t.at_keyframe)] = 1;
    if (!t.inlier) continue;
    now[coarse.cell(t.left)] = 1;
    if (t.seen_at_keyframe) shifts.push_back((t.left - t.at_keyframe).norm());
  }
  int held = 0, were = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    were += before[i];
    held += before[i] && now[i];
  }
  evidence.occupied_cells = were > 0 ? static_cast<double>(held) / were : 0.0;
  if (!shifts.empty()) evidence.shift = median(shifts);
  const Eigen::Matrix<double, 6, 1> motion = log_se3(location.pose.T_CW * keyframe.T_CW.inverse());
  evidence.significance =
      std::max(motion.head<3>().norm() / std::max(location.pose.sigma_position(), 1e-9),
               motion.tail<3>().norm() / std::max(location.pose.sigma_rotation(), 1e-9));
  return evidence;
}

}  // namespace prospect
