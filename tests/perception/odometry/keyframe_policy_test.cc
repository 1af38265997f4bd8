// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/keyframe_policy.h"

#include <gtest/gtest.h>

namespace prospect::keyframe_policy_test {
namespace {

KeyframeEvidence calm() {
  KeyframeEvidence e;
  e.best.points = 200;
  e.best.cells.assign(20, 1);
  e.best.sigma_position = 0.001;
  e.best.sigma_rotation = 0.0005;
  e.now = e.best;
  e.now.points = 190;
  e.shift = 0.2;
  e.significance = 50.0;
  return e;
}

TEST(KeyframePolicy, EachReasonAndNoneWithout) {
  EXPECT_EQ(keyframe_reason(calm()), "");
  auto e = calm();
  e.now.points = 139;
  EXPECT_EQ(keyframe_reason(e), "points lost");
  e = calm();
  for (int i = 0; i < 6; ++i) e.now.cells[i] = 0;
  EXPECT_EQ(keyframe_reason(e), "image not covered");
  // Cells that were empty in the best view count neither way.
  for (int i = 0; i < 6; ++i) e.best.cells[i] = 0;
  EXPECT_EQ(keyframe_reason(e), "");
  e = calm();
  e.now.sigma_position = 0.0021;
  EXPECT_EQ(keyframe_reason(e), "pose less certain");
  e = calm();
  e.now.sigma_rotation = 0.0011;
  EXPECT_EQ(keyframe_reason(e), "pose less certain");
}

TEST(KeyframePolicy, FewPointsAreAReasonOnlyIfTheViewChanges) {
  auto e = calm();
  e.now.points = e.best.points = 35;
  e.shift = 0.04;
  EXPECT_EQ(keyframe_reason(e), "few points");
  e.shift = 0.02;
  EXPECT_EQ(keyframe_reason(e), "");
}

TEST(KeyframePolicy, NoneAtRest) {
  auto e = calm();
  e.significance = 2.0;
  e.now.points = 120;
  e.now.cells.assign(20, 0);
  EXPECT_EQ(keyframe_reason(e), "");
  e.now.points = 30;  // somebody stands in the way: new points are needed
  EXPECT_EQ(keyframe_reason(e), "few points");
  e.best.points = 35;  // and there are no more
  EXPECT_EQ(keyframe_reason(e), "");
}

}  // namespace
}  // namespace prospect::keyframe_policy_test
