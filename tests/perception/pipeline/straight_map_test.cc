// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/straight_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "perception/pipeline/perception_pipeline.h"
#include "tests/perception/mapping/drawn_room.h"

namespace prospect::straight_map_test {
namespace {

PerceptionOptions options_with(bool loops) {
  PerceptionOptions options;
  options.loops = loops;
  options.wheel_fusion.noise.sigma_scale = 0.0;
  options.start = on_the_way(0);
  return options;
}

/// What wheels tell of the motion between two poses, that turn too little by `bias` [rad].
WheelSample wheels_between(const Pose& from, const Pose& to, double stamp, double dt, double bias) {
  WheelSample sample;
  sample.stamp = stamp;
  const double turn = to.yaw - from.yaw;
  const double half = 0.5 * turn;
  sample.velocity = Eigen::Rotation2Dd(-(from.yaw + half)) *
                    (to.position - from.position).head<2>() / dt *
                    (half == 0.0 ? 1.0 : half / std::sin(half));
  sample.yaw_rate = (turn - bias) / dt;
  return sample;
}

/// A robot that wheels alone localize goes round a room, and sees it by depth.
struct Drive {
  PerceptionPipeline perception;
  std::mt19937_64 generator{11};
  double stamp = 1.0;
  int at = 1;  // places so far

  explicit Drive(bool loops) : perception(options_with(loops)) { rest(1); }
  void go(int steps, double bias) {
    for (const int end = at + steps; at < end; ++at) {
      look(on_the_way(at - 1), on_the_way(at), bias);
    }
  }
  /// It stands and looks, which leaves time to follow what is known.
  void rest(int times) {
    for (int n = 0; n < times; ++n) look(on_the_way(at - 1), on_the_way(at - 1), 0.0);
  }
  void look(const Pose& before, const Pose& now, double bias) {
    constexpr double kPeriod = 0.2;
    perception.wheels(wheels_between(before, now, stamp, kPeriod, bias));
    const DepthScan in_W = room_scan(now, 0.01, generator, 0.0, 80, 20);
    const Eigen::Isometry3d T_BW = body_transform(now).inverse();
    DepthScan in_B;
    in_B.origin = T_BW * in_W.origin;
    for (const Eigen::Vector3d& p : in_W.hits) in_B.hits.push_back(T_BW * p);
    for (const Eigen::Vector3d& p : in_W.misses) in_B.misses.push_back(T_BW * p);
    perception.scan(stamp, in_B);
    stamp += kPeriod;
  }
  /// In the map's frame.
  double error() {
    const auto belief = perception.belief();
    const Pose pose = belief->map_frame ? belief->map_frame->to_map(belief->pose) : belief->pose;
    return (pose.position - on_the_way(at - 1).position).head<2>().norm();
  }
};

TEST(StraightMap, KeepsThePlaceOfARobotThatWheelsAloneLocalize) {
  constexpr int kSteps = 400;
  constexpr double kBias = 0.0005;
  Drive with(true), without(false);
  for (Drive* drive : {&with, &without}) {
    drive->go(kSteps, kBias);
    drive->rest(100);
  }
  const auto corrected = with.perception.belief(), drawn = without.perception.belief();
  std::printf("%.3f m without, %.3f m with; sigma %.3f and %.3f rad\n", without.error(),
              with.error(), std::sqrt(drawn->covariance(3, 3)),
              std::sqrt(corrected->covariance(3, 3)));
  EXPECT_GT(without.error(), 0.15);
  EXPECT_LT(with.error(), 0.3 * without.error());
  ASSERT_TRUE(corrected->map_frame);
  EXPECT_GT(corrected->map_frame->taken, 0);
  EXPECT_EQ(corrected->map_frame->refused, 0);
  EXPECT_FALSE(drawn->map_frame);
  EXPECT_LT(corrected->covariance(3, 3), 0.25 * drawn->covariance(3, 3)) << "it is told";
  EXPECT_EQ(corrected->pose.position, drawn->pose.position) << "W goes on without a jump";
}

TEST(StraightMap, TheRobotsPlaceInItsMapIsCorrectedWhereItCanMove) {
  Drive drive(true);
  drive.go(60, 0.0);
  Correction correction;
  correction.stamp = drive.stamp;
  correction.kind = CorrectionKind::kRobot;
  correction.T_new_old.translation().x() = 0.3;
  correction.why = "as told";
  EXPECT_EQ(drive.perception.correct(correction).state, InputState::kTaken);
  drive.go(20, 0.0);
  const auto belief = drive.perception.belief();
  ASSERT_TRUE(belief->map_frame);
  Eigen::Vector2d wall(4.0, 0.0);
  for (const MovedPlaces& moved : belief->map_frame->moved_places) wall = moved.how->now(wall);
  EXPECT_NEAR(wall.x(), 3.7, 0.03) << "the robot is nearer to it";
}

TEST(StraightMap, IsLeftToWhoeverElseMeasuresPoses) {
  PerceptionOptions options = options_with(true);
  EXPECT_NE(PerceptionPipeline(options).straight_map(), nullptr);
  options.wheels = false;
  EXPECT_EQ(PerceptionPipeline(options).straight_map(), nullptr);
}

}  // namespace
}  // namespace prospect::straight_map_test
