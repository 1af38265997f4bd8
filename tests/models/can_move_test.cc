// SPDX-License-Identifier: Apache-2.0
#include "models/can_move.h"

#include <gtest/gtest.h>

#include "models/make_model.h"

namespace prospect::can_move_test {
namespace {

const Eigen::Vector2d kAhead(1.0, 0.0), kBack(-1.0, 0.0), kLeft(0.0, 1.0);

TEST(CanMove, OnlyAheadByDefaultOfWheeledBases) {
  for (const char* name : {"unicycle", "unicycle_accel"}) {
    const auto model = make_model(name);
    EXPECT_TRUE(can_move(*model, kAhead)) << name;
    EXPECT_FALSE(can_move(*model, kBack)) << name;
    EXPECT_FALSE(can_move(*model, kLeft)) << name;
    const auto reverses = make_model(name, {{"v_min", -0.3}});
    EXPECT_TRUE(can_move(*reverses, kBack)) << name;
    EXPECT_FALSE(can_move(*reverses, kLeft)) << name;
    // Slower than a twentieth of the largest speed is not a way to move.
    EXPECT_FALSE(can_move(*make_model(name, {{"v_min", -0.001}}), kBack)) << name;
  }
}

TEST(CanMove, HolonomicBasesMoveAllWaysThatTheirLimitsLeave) {
  const auto model = make_model("holonomic");
  EXPECT_TRUE(can_move(*model, kLeft));
  EXPECT_TRUE(can_move(*model, -kLeft));
  const auto ahead_only = make_model("holonomic", {{"vx_min", 0.0}, {"vy_max", 0.3}});
  EXPECT_FALSE(can_move(*ahead_only, kBack));
  EXPECT_TRUE(can_move(*ahead_only, kLeft));
}

}  // namespace
}  // namespace prospect::can_move_test
