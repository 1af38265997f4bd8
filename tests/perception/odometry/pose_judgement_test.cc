// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/pose_judgement.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace prospect::pose_judgement_test {
namespace {

using Eigen::Isometry3d;

/// A located frame, 0.1 s after the last trusted pose: 200 landmarks over the image at 2 m.
class PoseJudgementTest : public testing::Test {
 protected:
  PoseJudgementTest() {
    for (int i = 0; i < 200; ++i) {
      Track t;
      t.position = {(0.05 * (i % 20) - 0.475), 0.1 * (i / 20) - 0.45, 2.0};
      t.in_view = t.tracked = t.inlier = t.has_right = true;
      tracks_.push_back(t);
    }
    location_.pose.solved = true;
    location_.pose.covariance = 1e-6 * Eigen::Matrix<double, 6, 6>::Identity();
    location_.pose.T_CW.translation().z() = -0.05;
    count();
  }

  void count() {
    location_.expected = location_.tracked = location_.confirmed = 0;
    for (const Track& t : tracks_) {
      location_.expected += t.in_view;
      location_.tracked += t.inlier;
      location_.confirmed += t.inlier && t.has_right;
    }
  }
  void expect(Localization state, const std::string& reason) const {
    const PoseJudgement judgement = judge_pose(location_, tracks_, last_, 0.1, camera_, options_);
    EXPECT_EQ(judgement.state, state) << judgement.reason;
    EXPECT_EQ(judgement.reason, reason);
  }

  StereoOdometryOptions options_;
  PinholeCamera camera_;
  TrustedPose last_;
  std::vector<Track> tracks_;
  FrameLocation location_;
};

TEST_F(PoseJudgementTest, EnoughPointsThatAgree) { expect(Localization::kOk, ""); }

TEST_F(PoseJudgementTest, LostByCounts) {
  location_.tracked = 11;
  expect(Localization::kLost, "too few points agree on a pose");
  location_.tracked = 29;
  expect(Localization::kLost, "most points are not found");
  count();
  location_.confirmed = 39;
  expect(Localization::kLost, "the right image does not fit the left one");
  count();
  location_.pose.solved = false;
  expect(Localization::kLost, "too few points agree on a pose");
}

TEST_F(PoseJudgementTest, LostByThePose) {
  location_.pose.covariance(1, 1) = 0.26 * 0.26;
  expect(Localization::kLost, "the pose is not fixed by the points");
  location_.pose.covariance(1, 1) = 1e-6;
  location_.pose.T_CW.translation().z() = -5.1;  // 51 m/s
  expect(Localization::kLost, "the motion is impossible");
  location_.pose.T_CW.translation().z() = -0.05;
  location_.pose.T_CW.rotate(Eigen::AngleAxisd(0.61, Eigen::Vector3d::UnitY()));
  expect(Localization::kLost, "the motion is impossible");
}

TEST_F(PoseJudgementTest, LostByAJerkOnceTheMotionIsKnown) {
  location_.pose.T_CW.translation().z() = -0.5;
  count();
  expect(Localization::kOk, "");
  last_.velocity = Eigen::Matrix<double, 6, 1>::Zero();
  expect(Localization::kLost, "the motion is impossible");
}

TEST_F(PoseJudgementTest, DegradedByCounts) {
  location_.tracked = location_.confirmed = 39;
  location_.expected = 60;
  expect(Localization::kDegraded, "few points");
  count();
  location_.expected = 501;
  expect(Localization::kDegraded, "many points are lost");
  count();
  location_.confirmed = 99;
  expect(Localization::kDegraded, "the right image confirms few points");
}

TEST_F(PoseJudgementTest, DegradedByAHalfOfAnImage) {
  for (Track& t : tracks_) t.inlier = t.position.x() > 0.0;
  count();
  expect(Localization::kDegraded, "nothing is found in the left half");
  for (Track& t : tracks_) {
    t.inlier = true;
    t.has_right = t.position.y() < 0.0;
  }
  count();
  expect(Localization::kDegraded, "the right image confirms nothing in the lower half");
}

}  // namespace
}  // namespace prospect::pose_judgement_test
