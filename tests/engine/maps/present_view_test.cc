// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/present_view.h"

#include <gtest/gtest.h>

#include "tests/engine/obstacle_worlds.h"

namespace prospect::present_view_test {
namespace {

using test::ObstacleWorld;

const RobotShape kBody = CylinderShape{{0.0, 0.0, 0.3}, 0.18, 0.4};

TEST(PresentView, IsWhatTheSensorMeetsNow) {
  ObstacleWorld world;
  for (int j = -5; j <= 5; ++j) world.occupy_column(15, j);
  const Belief belief = world.belief();
  const PresentView view(belief, {}, kBody, true);
  EXPECT_TRUE(view.shows(Cell{10, 0}));
  EXPECT_TRUE(view.shows(Cell{15, 0})) << "the wall itself";
  EXPECT_FALSE(view.shows(Cell{17, 0})) << "behind it";
  EXPECT_FALSE(view.shows(Cell{-5, 0})) << "behind the robot";
  EXPECT_FALSE(view.shows(Cell{5, 5})) << "beside the field of view";
  EXPECT_FALSE(view.shows(Cell{500, 0}));
  // Half the field of view is 0.61 rad: tan is 0.70.
  EXPECT_TRUE(view.shows(Cell{10, 6}));
  EXPECT_FALSE(view.shows(Cell{10, 9}));
}

TEST(PresentView, PassesByWhatIsBetweenTheBodyAndTheFieldOfView) {
  DepthSensor narrow;  // covers 0.15 m to the side from 0.48 m on
  narrow.footprint.horizontal_fov = 0.6;
  const Belief belief = ObstacleWorld().belief();
  const PresentView view(belief, narrow, kBody, true);
  EXPECT_FALSE(view.shows(Cell{1, 1}));
  EXPECT_TRUE(view.passes_by(Cell{1, 1})) << "beside the sensor, and driven through";
  EXPECT_TRUE(view.passes_by(Cell{2, -2}));
  EXPECT_FALSE(view.passes_by(Cell{1, 3})) << "beside the body";
  EXPECT_FALSE(view.passes_by(Cell{-3, 1})) << "behind it";
  // With nothing in view ahead of it nothing is.
  ObstacleWorld fog;
  for (int i = 4; i < 40; ++i) {
    for (int j = -40; j < 40; ++j) fog.forget_column(i, j);
  }
  const Belief blind = fog.belief();
  const PresentView none(blind, narrow, kBody, true);
  EXPECT_TRUE(none.shows(Cell{3, 0}));
  EXPECT_FALSE(none.passes_by(Cell{1, 1}));
  EXPECT_FALSE(none.shows(Cell{4, 0}));
  // A sensor that looks to the left looks there.
  narrow.mount.T_BC = CameraMount::forward_facing({0.0, 0.0, 0.45}, 0.5 * M_PI);
  const PresentView sideways(belief, narrow, kBody, true);
  EXPECT_TRUE(sideways.shows(Cell{0, 10}));
  EXPECT_TRUE(sideways.passes_by(Cell{1, 1}));
  EXPECT_FALSE(sideways.passes_by(Cell{3, 1}));
}

TEST(PresentView, ABodyKeepsToTheStripAhead) {
  const Belief belief = ObstacleWorld().belief();
  const PresentView view(belief, {}, kBody, true);
  const auto keeps = [&](double x, double y, double yaw) {
    return view.keeps_to({{x, y, 0.0}, yaw});
  };
  EXPECT_TRUE(keeps(0.0, 0.0, 0.0));
  EXPECT_TRUE(keeps(0.0, 0.0, 2.0)) << "round";
  EXPECT_TRUE(keeps(0.3, 0.0, 0.0));
  EXPECT_TRUE(keeps(0.3, 0.05, 0.1));
  EXPECT_FALSE(keeps(0.3, 0.07, 0.0));
  EXPECT_FALSE(keeps(0.0, 0.001, 0.0));
  EXPECT_FALSE(keeps(-0.1, 0.0, 0.0));
  const PresentView box(belief, {}, BoxShape{{0.0, 0.0, 0.3}, {0.6, 0.3, 0.3}}, true);
  EXPECT_TRUE(box.keeps_to({{0.3, 0.0, 0.0}, 0.0}));
  EXPECT_FALSE(box.keeps_to({{0.3, 0.0, 0.0}, 0.5})) << "its corners leave it";
}

TEST(PresentView, OfVoxelsHasAnUpperAndALowerEdge) {
  ObstacleWorld world(0.1, 4.0, 3.0);
  world.occupy_column(15, 0);
  Belief belief = world.belief();
  belief.pose.position.z() = 1.0;
  const PresentView view(belief, {}, kBody, false);  // eye at 1.45 m, half height 0.475 rad
  EXPECT_TRUE(view.shows(Eigen::Vector3i(10, 0, 14)));
  EXPECT_TRUE(view.shows(Eigen::Vector3i(10, 0, 17)));
  EXPECT_FALSE(view.shows(Eigen::Vector3i(10, 0, 22)));
  EXPECT_TRUE(view.shows(Eigen::Vector3i(15, 0, 14)));
  EXPECT_FALSE(view.shows(Eigen::Vector3i(18, 0, 14)));
  EXPECT_FALSE(view.shows(Eigen::Vector3i(-3, 0, 14)));
  EXPECT_TRUE(view.passes_by(Eigen::Vector3i(2, 1, 12))) << "ahead of the body";
  EXPECT_FALSE(view.passes_by(Eigen::Vector3i(2, 1, 8))) << "below it";
  EXPECT_FALSE(view.passes_by(Eigen::Vector3i(0, 0, 17))) << "above it";
  EXPECT_TRUE(view.keeps_to({{0.3, 0.0, 1.0}, 0.0}));
  EXPECT_FALSE(view.keeps_to({{0.0, 0.0, 1.01}, 0.0}));
}

}  // namespace
}  // namespace prospect::present_view_test
