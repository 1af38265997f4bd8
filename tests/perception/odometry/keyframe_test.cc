#include "perception/odometry/keyframe.h"

#include <gtest/gtest.h>

#include <vector>

namespace prospect::keyframe_test {
namespace {

TEST(Keyframe, EvidenceIsWhatChangedSince) {
  Keyframe keyframe;
  std::vector<Track> tracks(4);
  for (int i = 0; i < 4; ++i) {
    tracks[i].inlier = true;
    tracks[i].left = {50.0f + 100.0f * static_cast<float>(i), 50.0f};
    keyframe.see(tracks[i]);
  }
  EXPECT_EQ(keyframe.points, 4);
  // Two move by 10 px; one moves into the cell of one that is lost, and leaves its own empty.
  tracks[0].left.x() += 10.0f;
  tracks[1].left.x() += 10.0f;
  tracks[2].left.x() += 60.0f;
  tracks[3].inlier = false;
  FrameLocation location;
  location.tracked = 3;
  location.pose.covariance = 1e-4 * Eigen::Matrix<double, 6, 6>::Identity();
  location.pose.T_CW.translation().x() = 0.2;
  const auto evidence =
      keyframe_evidence(keyframe, location, tracks, ImageGrid(400.0, 100.0, 100.0), 400.0);
  EXPECT_EQ(evidence.points, 3);
  EXPECT_EQ(evidence.points_at_keyframe, 4);
  EXPECT_EQ(evidence.width, 400.0);
  EXPECT_NEAR(evidence.occupied_cells, 0.75, 1e-12);  // of four the third's is empty
  EXPECT_NEAR(evidence.shift, 10.0, 1e-4);
  EXPECT_NEAR(evidence.significance, 20.0, 1e-9);
}

}  // namespace
}  // namespace prospect::keyframe_test
