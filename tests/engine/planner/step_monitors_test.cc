// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/step_monitors.h"

#include <gtest/gtest.h>

namespace prospect::step_monitors_test {
namespace {

Belief belief(double stamp, double x, int tracked, Localization localization = Localization::kOk) {
  Belief b;
  b.stamp = stamp;
  b.pose.position.x() = x;
  b.tracked_features = tracked;
  b.localization = localization;
  return b;
}

TEST(StepMonitors, RemembersWhereEnoughFeaturesWereTracked) {
  StepMonitors monitors;
  const double N_min = 20.0;
  Facts facts = monitors.update(belief(0.0, 0.0, 30), TaskKind::kExplore, {}, N_min);
  EXPECT_TRUE(facts.enough_features) << "1.5 times N_min";
  EXPECT_EQ(facts.tracked_at_retreat, 30);
  facts = monitors.update(belief(1.0, 0.8, 29), TaskKind::kExplore, {}, N_min);
  EXPECT_FALSE(facts.enough_features);
  EXPECT_EQ(facts.tracked_at_retreat, 30);
  EXPECT_NEAR(facts.retreat_distance, 0.8, 1e-12);
  ASSERT_EQ(monitors.trail().places().size(), 1U);
}

TEST(StepMonitors, HowFarItHasBeenFromWhereItBegan) {
  StepMonitors monitors;
  const auto at = [&](double stamp, double x, int tracked) {
    return monitors.update(belief(stamp, x, tracked), TaskKind::kExplore, {}, 20.0);
  };
  EXPECT_EQ(at(0.0, 2.0, 30).strayed, 0.0);
  EXPECT_EQ(at(1.0, 2.75, 5).strayed, 0.75);
  const Facts facts = at(2.0, 2.25, 5);
  EXPECT_EQ(facts.strayed, 0.75);
  EXPECT_EQ(facts.retreat_distance, 0.25) << "from where 30 were tracked";
}

TEST(StepMonitors, ARobotLocalizedOtherwiseNeedsNoFeatures) {
  StepMonitors monitors;
  Belief b = belief(0.0, 0.0, 0);
  b.localization_source = LocalizationSource::kExternal;
  const Facts facts = monitors.update(b, TaskKind::kHold, {}, 20.0);
  EXPECT_FALSE(facts.rests_on_features);
  EXPECT_TRUE(facts.enough_features);
  EXPECT_EQ(facts.task, TaskKind::kHold);
}

TEST(StepMonitors, SaysOnceThatLocalizationGotLost) {
  StepMonitors monitors;
  monitors.update(belief(0.0, 0.0, 50), TaskKind::kExplore, {}, 20.0);
  EXPECT_FALSE(monitors.got_lost());
  monitors.update(belief(1.0, 0.0, 0, Localization::kLost), TaskKind::kExplore, {}, 20.0);
  EXPECT_TRUE(monitors.got_lost());
  const Facts facts =
      monitors.update(belief(3.0, 0.0, 0, Localization::kLost), TaskKind::kExplore, {}, 20.0);
  EXPECT_FALSE(monitors.got_lost());
  EXPECT_EQ(facts.lost_for, 3.0);
}

TEST(StepMonitors, TellsWhereTheRobotDoesNotFollowItsCommandInThatStepOnly) {
  StepMonitors monitors;
  int noticed = 0;
  for (int k = 0; k < 8; ++k) {
    Belief b = belief(0.5 * k, 0.0, 50);
    b.command = Twist{Eigen::Vector3d(0.3, 0.0, 0.0), 0.0};
    const Facts facts = monitors.update(b, TaskKind::kExplore, {}, 20.0);
    if (!monitors.blocked()) continue;
    ++noticed;
    EXPECT_GT(monitors.blocked()->x(), 0.99);
    EXPECT_EQ(facts.not_following_at, b.stamp);
  }
  EXPECT_GT(noticed, 0);
  EXPECT_LT(noticed, 8);
}

TEST(StepMonitors, OnlyARobotThatPursuesItsTargetGetsStuck) {
  for (const bool pursues : {false, true}) {
    StepMonitors monitors;
    bool stuck = false;
    for (int k = 0; k < 30; ++k) stuck = monitors.update_stuck(belief(k, 0.0, 50), pursues);
    EXPECT_EQ(stuck, pursues);
  }
}

}  // namespace
}  // namespace prospect::step_monitors_test
