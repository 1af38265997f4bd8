// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/keyframe.h"

#include <gtest/gtest.h>

#include <vector>

namespace prospect::keyframe_test {
namespace {

class KeyframeTest : public testing::Test {
 protected:
  KeyframeEvidence at(double x) {
    FrameLocation location;
    for (const Track& t : tracks_) location.tracked += t.inlier;
    location.pose.covariance = 1e-4 * Eigen::Matrix<double, 6, 6>::Identity();
    location.pose.T_CW.translation().x() = x;
    return keyframe_.evidence(location, tracks_, ImageGrid(400.0, 100.0, 100.0), 400.0);
  }

  Keyframe keyframe_;
  std::vector<Track> tracks_ = std::vector<Track>(4);
};

TEST_F(KeyframeTest, EvidenceIsWhatChangedSince) {
  for (int i = 0; i < 4; ++i) {
    tracks_[i].inlier = true;
    tracks_[i].left = {50.0f + 100.0f * static_cast<float>(i), 50.0f};
    Keyframe::see(tracks_[i]);
  }
  tracks_[3].inlier = false;  // never found again
  auto evidence = at(0.1);
  EXPECT_EQ(evidence.now.points, 3);
  EXPECT_EQ(evidence.best.points, 3);
  EXPECT_EQ(evidence.shift, 0.0);
  EXPECT_NEAR(evidence.significance, 10.0, 1e-9);
  // Two move by 10 px and one is lost.
  tracks_[0].left.x() += 10.0f;
  tracks_[1].left.x() += 10.0f;
  tracks_[2].inlier = false;
  evidence = at(0.2);
  EXPECT_EQ(evidence.now.points, 2);
  EXPECT_EQ(evidence.best.points, 3);
  EXPECT_EQ(evidence.now.cells, (std::vector<char>{1, 1, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(evidence.best.cells, (std::vector<char>{1, 1, 1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_NEAR(evidence.shift, 0.025, 1e-6);
  EXPECT_NEAR(evidence.now.sigma_position, 0.01, 1e-9);
  // A better view than all before.
  tracks_[2].inlier = tracks_[3].inlier = true;
  EXPECT_EQ(at(0.2).best.points, 4);
}

}  // namespace
}  // namespace prospect::keyframe_test
