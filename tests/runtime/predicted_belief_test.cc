// SPDX-License-Identifier: Apache-2.0
#include "runtime/predicted_belief.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "models/unicycle.h"
#include "tests/engine/obstacle_worlds.h"

namespace prospect::predicted_belief_test {
namespace {

Twist twist(double v, double w) { return {{v, 0.0, 0.0}, w}; }

TEST(PredictedPose, FollowsTheCommandsAsTheModelDoes) {
  const Unicycle model;
  const Pose start{{1.0, 2.0, 0.0}, 0.3};
  const std::vector<SentCommand> sent = {
      {9.0, twist(0.4, 0.5)}, {10.1, twist(0.5, -0.8)}, {10.3, twist(0.2, 0.0)}};
  Eigen::VectorXd x = model.state(start, {}), next(3);
  const auto drive = [&](double v, double w, double dt) {
    model.step(x, Eigen::Vector2d(v, w), dt, next);
    x.swap(next);
  };
  drive(0.4, 0.5, 0.1);
  drive(0.5, -0.8, 0.2);
  drive(0.2, 0.0, 0.25);
  const Pose pose = predicted_pose(start, 10.0, sent, 10.55, {});
  EXPECT_NEAR(pose.position.x(), x[0], 1e-12);
  EXPECT_NEAR(pose.position.y(), x[1], 1e-12);
  EXPECT_NEAR(pose.yaw, x[2], 1e-12);
}

TEST(PredictedPose, CommandsActLater) {
  // Straight at 0.4 m/s since long, told to stand at 10.1: until 10.3 it goes on.
  const std::vector<SentCommand> sent = {{5.0, twist(0.4, 0.0)}, {10.1, twist(0.0, 0.0)}};
  const Pose pose = predicted_pose({}, 10.0, sent, 10.5, {.linear = 0.2, .angular = 0.0});
  EXPECT_NEAR(pose.position.x(), 0.4 * 0.3, 1e-12);
  // What was sent before `until` is rolled to its end.
  const Pose going_on = predicted_pose({}, 10.0, {{{5.0, twist(0.4, 0.0)}}}, 10.5, {0.2, 0.2});
  EXPECT_NEAR(going_on.position.x(), 0.4 * 0.7, 1e-12);
}

TEST(PredictedPose, LinearAndAngularDelaysAreApart) {
  // Turns on the spot from 10.0 on, told to stop at 10.5, and to drive from then on.
  const std::vector<SentCommand> sent = {{10.0, twist(0.0, 1.0)}, {10.5, twist(0.3, 0.0)}};
  const Pose pose = predicted_pose({}, 10.0, sent, 11.0, {.linear = 0.0, .angular = 0.1});
  EXPECT_NEAR(pose.yaw, 0.5, 1e-12);
  // 0.1 s of the drive are on an arc from 0.4 to 0.5 rad, 0.4 s straight.
  const double chord = 0.03 * std::sin(0.05) / 0.05;
  EXPECT_NEAR(pose.position.x(), chord * std::cos(0.45) + 0.12 * std::cos(0.5), 1e-12);
  EXPECT_NEAR(pose.position.y(), chord * std::sin(0.45) + 0.12 * std::sin(0.5), 1e-12);
}

// Each velocity goes on for its own delay, and no longer.
TEST(PredictedPose, EachVelocityEndsAfterItsOwnDelay) {
  const std::vector<SentCommand> sent = {{5.0, {{0.0, 0.0, 0.3}, 1.0}}};
  const Pose turned = predicted_pose({}, 10.0, sent, 10.5, {.linear = 0.0, .angular = 0.2});
  EXPECT_NEAR(turned.yaw, 0.7, 1e-12);
  EXPECT_NEAR(turned.position.z(), 0.15, 1e-12);
  const Pose risen = predicted_pose({}, 10.0, sent, 10.5, {.linear = 0.2, .angular = 0.0});
  EXPECT_NEAR(risen.yaw, 0.5, 1e-12);
  EXPECT_NEAR(risen.position.z(), 0.21, 1e-12);
}

TEST(PredictedPose, NothingSentOrNoTimePassed) {
  const Pose start{{1.0, 2.0, 3.0}, 0.5};
  EXPECT_EQ(predicted_pose(start, 10.0, {}, 12.0, {}).position, start.position);
  const std::vector<SentCommand> sent = {{9.0, twist(0.4, 0.5)}};
  EXPECT_EQ(predicted_pose(start, 10.0, sent, 10.0, {}).yaw, 0.5);
  EXPECT_EQ(predicted_pose(start, 10.0, sent, 9.5, {}).yaw, 0.5);
}

TEST(PredictedBelief, HasTheStateAtItsStartAndTheStampsOfItsSources) {
  Belief belief = test::ObstacleWorld().belief();
  belief.set_stamps(10.0);
  belief.stamps.map = 9.8;
  belief.twist = twist(0.37, 0.01);  // noise
  const std::vector<SentCommand> sent = {
      {9.5, twist(0.4, 0.0)}, {10.05, twist(0.5, 0.2)}, {10.1, twist(0.6, 0.2)}};
  const Belief predicted = predicted_belief(belief, sent, 10.1, {});
  EXPECT_EQ(predicted.stamp, 10.1);
  EXPECT_EQ(predicted.stamps.map, 9.8);
  EXPECT_EQ(predicted.stamps.pose, 10.0);
  EXPECT_EQ(predicted.twist.linear.x(), 0.5);
  ASSERT_TRUE(predicted.command);
  EXPECT_EQ(predicted.command->linear.x(), 0.5);
  EXPECT_NEAR(predicted.pose.position.x(), 0.4 * 0.05 + 0.5 * 0.05, 1e-5);
  EXPECT_EQ(predicted.voxels, belief.voxels);
  // Never back.
  EXPECT_EQ(predicted_belief(belief, sent, 9.0, {}).stamp, 10.0);
  EXPECT_EQ(predicted_belief(belief, sent, 9.0, {}).pose.position, belief.pose.position);
}

}  // namespace
}  // namespace prospect::predicted_belief_test
