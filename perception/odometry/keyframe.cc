// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/keyframe.h"

#include <Eigen/Core>
#include <algorithm>

#include "perception/odometry/median.h"
#include "perception/odometry/se3.h"

namespace prospect {

void Keyframe::see(Track& track) {
  track.seen_at_keyframe = track.inlier;
  track.at_keyframe = track.left;
}

KeyframeEvidence Keyframe::evidence(const FrameLocation& location, const std::vector<Track>& tracks,
                                    const ImageGrid& coarse, double width) {
  KeyframeEvidence evidence;
  KeyframeView& now = evidence.now;
  now.points = location.tracked;
  now.cells.assign(coarse.cells(), 0);
  now.sigma_position = location.pose.sigma_position();
  now.sigma_rotation = location.pose.sigma_rotation();
  std::vector<double> shifts;
  for (const Track& t : tracks) {
    if (!t.inlier) continue;
    now.cells[coarse.cell(t.left)] = 1;
    if (t.seen_at_keyframe) shifts.push_back((t.left - t.at_keyframe).norm() / width);
  }
  if (!shifts.empty()) evidence.shift = median(shifts);
  const Eigen::Matrix<double, 6, 1> motion = log_se3(location.pose.T_CW * T_CW.inverse());
  evidence.significance = std::max(motion.head<3>().norm() / std::max(now.sigma_position, 1e-9),
                                   motion.tail<3>().norm() / std::max(now.sigma_rotation, 1e-9));
  if (now.points > best.points) best = now;
  evidence.best = best;
  return evidence;
}

}  // namespace prospect
