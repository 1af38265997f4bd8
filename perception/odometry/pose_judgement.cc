// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/pose_judgement.h"

#include <Eigen/Core>
#include <algorithm>

#include "models/reason.h"
#include "perception/odometry/se3.h"

namespace prospect {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

bool possible(const Eigen::Isometry3d& T_CW, const TrustedPose& last, double now,
              const StereoOdometryOptions& options) {
  const Vector6d motion = log_se3(T_CW * last.T_CW.inverse());
  const double dt = std::max(now - last.stamp, 1e-3);
  if (!(motion.head<3>().norm() <= options.max_speed * dt &&
        motion.tail<3>().norm() <= options.max_turn_rate * dt)) {
    return false;
  }
  if (!last.velocity) return true;
  const Vector6d change = motion - *last.velocity * dt;
  return change.head<3>().norm() <= 0.05 + options.max_acceleration * dt * dt &&
         change.tail<3>().norm() <= 0.05 + options.max_turn_acceleration * dt * dt;
}

/// Names each half of the image on which nothing is found any more, in either image.
void judge_halves(const FrameLocation& location, const std::vector<Track>& tracks,
                  const PinholeCamera& camera, std::string& reason) {
  int expected[4] = {0, 0, 0, 0}, found[4] = {0, 0, 0, 0}, confirmed[4] = {0, 0, 0, 0};
  for (const Track& t : tracks) {
    if (!t.in_view) continue;
    const Eigen::Vector3d Y = location.pose.T_CW * t.position;
    if (!(Y.z() > 0.1)) continue;
    const Eigen::Vector2d p = camera.project(Y);
    const int halves[2] = {p.x() < 0.5 * camera.width ? 0 : 1, p.y() < 0.5 * camera.height ? 2 : 3};
    for (int h : halves) {
      ++expected[h];
      found[h] += t.inlier;
      confirmed[h] += t.inlier && t.has_right;
    }
  }
  static const char* const kHalf[4] = {"left", "right", "upper", "lower"};
  for (int h = 0; h < 4; ++h) {
    if (expected[h] >= 15 && found[h] < 0.15 * expected[h]) {
      add_reason(reason, std::string("nothing is found in the ") + kHalf[h] + " half");
    } else if (found[h] >= 15 && confirmed[h] < 0.15 * found[h]) {
      add_reason(reason,
                 std::string("the right image confirms nothing in the ") + kHalf[h] + " half");
    }
  }
}

}  // namespace

PoseJudgement judge_pose(const FrameLocation& location, const std::vector<Track>& tracks,
                         const TrustedPose& last, double now, const PinholeCamera& camera,
                         const StereoOdometryOptions& options) {
  const auto lost = [](const char* reason) { return PoseJudgement{Localization::kLost, reason}; };
  if (!location.pose.solved || location.tracked < options.lost_points) {
    return lost("too few points agree on a pose");
  }
  if (location.tracked < options.lost_share * location.expected) {
    return lost("most points are not found");
  }
  if (location.confirmed < options.lost_right_share * location.tracked) {
    return lost("the right image does not fit the left one");
  }
  if (!(location.pose.sigma_position() <= options.max_sigma_position)) {
    return lost("the pose is not fixed by the points");
  }
  if (!possible(location.pose.T_CW, last, now, options)) return lost("the motion is impossible");

  PoseJudgement judgement;
  if (location.tracked < options.degraded_points) add_reason(judgement.reason, "few points");
  if (location.tracked < options.degraded_share * location.expected) {
    add_reason(judgement.reason, "many points are lost");
  }
  if (location.confirmed < options.degraded_right_share * location.tracked) {
    add_reason(judgement.reason, "the right image confirms few points");
  }
  judge_halves(location, tracks, camera, judgement.reason);
  if (!judgement.reason.empty()) judgement.state = Localization::kDegraded;
  return judgement;
}

}  // namespace prospect
