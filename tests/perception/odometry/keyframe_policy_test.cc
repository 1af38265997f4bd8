#include "perception/odometry/keyframe_policy.h"

#include <gtest/gtest.h>

namespace prospect::keyframe_policy_test {
namespace {

KeyframeEvidence calm() {
  KeyframeEvidence e;
  e.points = 190;
  e.points_at_keyframe = 200;
  e.shift = 3.0;
  e.significance = 50.0;
  return e;
}

TEST(KeyframePolicy, EachReasonAndNoneWithout) {
  EXPECT_EQ(keyframe_reason(calm()), "");
  auto e = calm();
  e.points = 140;
  EXPECT_EQ(keyframe_reason(e), "points lost");
  e = calm();
  e.occupied_cells = 0.7;
  EXPECT_EQ(keyframe_reason(e), "image not covered");
  e = calm();
  e.shift = 25.0;
  EXPECT_EQ(keyframe_reason(e), "view changed");
  e = calm();
  e.points = 35;
  EXPECT_EQ(keyframe_reason(e), "few points");
}

TEST(KeyframePolicy, NoneAtRest) {
  auto e = calm();
  e.significance = 2.0;
  e.points = 120;
  e.occupied_cells = 0.5;
  EXPECT_EQ(keyframe_reason(e), "");
  e.points = 30;  // somebody stands in the way: new points are needed
  EXPECT_EQ(keyframe_reason(e), "few points");
  e.points_at_keyframe = 35;  // and there are no more
  EXPECT_EQ(keyframe_reason(e), "");
}

}  // namespace
}  // namespace prospect::keyframe_policy_test
