// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/recall.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace prospect::recall_test {
namespace {

Track track(std::uint64_t id, float u, bool inlier = true) {
  Track t;
  t.id = id;
  t.left = {u, 10.0f};
  t.inlier = inlier;
  return t;
}

TEST(RecallMemory, ShiftIsThatOfTheTracksThatWereAndAreInliers) {
  RecallMemory memory(2);
  EXPECT_TRUE(std::isinf(memory.shift({track(1, 0.0f)}))) << "there is none to compare with";
  memory.add({Eigen::Isometry3d::Identity(),
              {},
              {track(1, 0.0f), track(3, 0.0f), track(4, 0.0f, false), track(7, 0.0f)}});
  EXPECT_EQ(memory.shift({track(1, 5.0f), track(2, 90.0f), track(3, 7.0f), track(4, 90.0f),
                          track(7, 9.0f), track(8, 90.0f)}),
            7.0);
  EXPECT_EQ(memory.shift({track(1, 5.0f), track(3, 90.0f, false)}), 5.0);
  EXPECT_TRUE(std::isinf(memory.shift({track(2, 5.0f), track(4, 5.0f)}))) << "nothing in common";
}

TEST(RecallMemory, KeepsTheNewest) {
  RecallMemory memory(2);
  for (std::uint64_t id = 1; id <= 3; ++id) {
    memory.add({Eigen::Isometry3d::Identity(), {}, {track(id, 0.0f)}});
  }
  ASSERT_EQ(memory.all().size(), 2U);
  EXPECT_EQ(memory.all().front().tracks.front().id, 2U);
  EXPECT_EQ(memory.shift({track(3, 2.0f)}), 2.0);
}

}  // namespace
}  // namespace prospect::recall_test
