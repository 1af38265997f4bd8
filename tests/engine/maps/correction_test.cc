// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/correction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "models/body_transform.h"

namespace prospect::correction_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Correction moved_by(double stamp, double x, double y, double yaw) {
  Correction c;
  c.stamp = stamp;
  c.T_new_old = body_transform({{x, y, 0.0}, yaw});
  return c;
}

TEST(Correction, MovesTheMapAndNotTheRobot) {
  Corrections corrections;
  EXPECT_EQ(corrections.frame(), nullptr);
  const Pose robot{{4.0, 1.0, 0.1}, 0.3};
  Correction first = moved_by(1.0, 3.0, 0.0, M_PI / 6);
  first.covariance.diagonal() << 0.04, 0.01, 0.0, 0.01;
  first.why = "a loop\nwas closed";
  EXPECT_EQ(corrections.take(first, robot).why, "");
  const MapFrame one = *corrections.frame();
  // p_new = T p_old, of the robot as of any place.
  const Eigen::Isometry3d told = first.T_new_old * body_transform(robot);
  EXPECT_LT((one.to_map(robot).position - told.translation()).norm(), 1e-12);
  EXPECT_NEAR(one.to_map(robot).yaw, 0.3 + M_PI / 6, 1e-12);
  EXPECT_NEAR(one.newest->distance, (told.translation() - robot.position).norm(), 1e-12);
  EXPECT_NEAR(one.newest->turn, M_PI / 6, 1e-12);
  EXPECT_NEAR(one.newest->sigma, 0.2, 1e-12);
  EXPECT_EQ(one.newest->why, "a loop was closed");
  EXPECT_EQ(to_text({0.0, 3.004, M_PI / 6, 0.0, "SLAM"}),
            "the map was corrected by 3.00 m and 30.0 degrees: SLAM");
  // A second one is of the map as it is by then; both ways lead back.
  EXPECT_EQ(corrections.take(moved_by(2.0, -1.0, 2.0, -1.0), robot).why, "");
  const MapFrame two = *corrections.frame();
  EXPECT_EQ(two.taken, 2);
  const Eigen::Vector2d p(-7.0, 3.0);
  EXPECT_LT((two.to_W(two.to_map(p)) - p).norm(), 1e-12);
  EXPECT_LT((two.to_W(two.to_map(robot)).position - robot.position).norm(), 1e-12);
  EXPECT_LT((two.to_map(two.map_in_W()).position).norm(), 1e-12);
  // Back again: W is where it was.
  EXPECT_EQ(corrections.take(moved_by(3.0, 0.0, 0.0, 0.0), robot).why, "");
  EXPECT_NEAR(corrections.frame()->newest->distance, 0.0, 1e-12);
}

TEST(Correction, WhatCannotBeIsRefusedWithALineAndChangesNothing) {
  struct Case {
    Correction correction;
    const char* line;
  };
  const auto with = [](auto change) {
    Correction c = moved_by(5.0, 0.1, 0.0, 0.0);
    change(c);
    return c;
  };
  const Case cases[] = {
      {with([](Correction& c) { c.stamp = kNaN; }), "its stamp is not finite"},
      {with([](Correction& c) { c.T_new_old.translation().x() = kNaN; }),
       "it is no rotation and translation, finite"},
      {with([](Correction& c) { c.T_new_old.linear() *= 2.0; }), "it is no rotation"},
      {with([](Correction& c) { c.T_new_old.translation().y() = 1e6; }),
       "it moves the robot by 1e+06 m in the map; expected at most 100 m"},
      // Small at the origin, large where the robot is.
      {moved_by(5.0, 0.0, 0.0, 2.0), "it moves the robot by 1683 m"},
      {with([](Correction& c) {
         c.T_new_old.linear() =
             Eigen::AngleAxisd(-M_PI_2, Eigen::Vector3d::UnitX()).toRotationMatrix();
       }),
       "it tilts the map by 90.0 degrees"},
      {with([](Correction& c) { c.covariance(0, 0) = -1.0; }), "its covariance is none"},
      {with([](Correction& c) { c.covariance(3, 1) = kNaN; }), "its covariance is none"},
  };
  const Pose robot{{1000.0, 0.0, 0.0}, 0.0};
  for (const Case& c : cases) {
    Corrections corrections;
    const Corrections::Answer answer = corrections.take(c.correction, robot);
    EXPECT_EQ(answer.verdict, CorrectionVerdict::kRefused);
    EXPECT_NE(answer.why.find(c.line), std::string::npos) << answer.why << " // " << c.line;
    EXPECT_EQ(answer.why.find('\n'), std::string::npos);
    EXPECT_TRUE(corrections.frame()->origin.position.isZero(0.0));
    EXPECT_EQ(corrections.frame()->refused, 1);
    EXPECT_EQ(corrections.frame()->refusal, answer.why);
  }
  // What was drawn cannot move.
  Corrections corrections;
  for (const CorrectionKind kind : {CorrectionKind::kRobot, CorrectionKind::kAnchors}) {
    Correction c = moved_by(5.0, 0.1, 0.0, 0.0);
    c.kind = kind;
    EXPECT_EQ(corrections.take(c, robot).verdict, CorrectionVerdict::kCannotFollow);
  }
  EXPECT_EQ(corrections.frame()->cannot_follow, 2);
  EXPECT_EQ(corrections.frame()->taken, 0);
}

// W goes on with the robot: what others are told of it moves, and what was measured in W.
TEST(Correction, OneOfAnchorsThatWasFollowedMovesWInTheMap) {
  Corrections corrections;
  EXPECT_EQ(corrections.take(moved_by(1.0, 2.0, 1.0, 0.5), {}).why, "");
  const Pose robot{{3.0, -1.0, 0.2}, 0.7};
  const Pose before = corrections.frame()->to_map(robot);
  Correction c = moved_by(5.0, 0.3, -0.2, 0.1);
  c.kind = CorrectionKind::kAnchors;
  EXPECT_EQ(corrections.refuse(c, robot), "");
  EXPECT_EQ(corrections.frame()->taken, 1);
  const auto how = std::make_shared<const PlaceMoves>(std::vector<PlaceMoves::Known>{});
  corrections.followed(c, robot, how);
  const MapFrame& now = *corrections.frame();
  EXPECT_EQ(now.taken, 2);
  ASSERT_EQ(now.moved_places.size(), 1U);
  EXPECT_EQ(now.moved_places[0].taken, 2);
  EXPECT_EQ(now.moved_places[0].how, how);
  // The robot as it is corrected in W, in the map as it was.
  MapFrame then;
  then.origin = {{2.0, 1.0, 0.0}, 0.5};
  const Pose told = then.to_map(planar_move(c.T_new_old)(robot));
  EXPECT_LT((now.to_map(robot).position - told.position).norm(), 1e-9);
  EXPECT_NEAR(now.newest->distance, (told.position - before.position).head<2>().norm(), 1e-9);
  EXPECT_NEAR(now.newest->turn, 0.1, 1e-9);
  for (int n = 0; n < 20; ++n) {
    c.stamp += 1.0;
    corrections.followed(c, robot, how);
  }
  EXPECT_EQ(corrections.frame()->moved_places.size(), MapFrame::kMostMoved);

  c.stamp += 1.0;
  c.anchors = {{3, Eigen::Isometry3d(Eigen::Scaling(2.0))}};
  EXPECT_NE(corrections.refuse(c, robot).find("moves an anchor by no rotation"), std::string::npos);
  c = moved_by(c.stamp, 5000.0, 0.0, 0.0);
  c.kind = CorrectionKind::kRobot;
  EXPECT_NE(corrections.refuse(c, robot), "");
  EXPECT_EQ(corrections.frame()->refused, 2);
  EXPECT_EQ(corrections.frame()->taken, 22);
}

TEST(Correction, AThousandASecondAreTenASecond) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Corrections corrections;
  Pose before;
  for (int n = 0; n < 3000; ++n) {
    const double wild = n % 7 == 0 ? kNaN : n % 5 == 0 ? 1e6 : 0.3;
    const bool taken =
        corrections.take(moved_by(1e-3 * n, wild * unit(random), 0.1, unit(random)), {}).verdict ==
        CorrectionVerdict::kTaken;
    const MapFrame& now = *corrections.frame();
    ASSERT_TRUE(now.origin.position.allFinite());
    ASSERT_TRUE(std::isfinite(now.origin.yaw));
    if (!taken) {
      ASSERT_EQ(now.origin.position, before.position);
      ASSERT_EQ(now.origin.yaw, before.yaw);
    }
    before = now.origin;
  }
  EXPECT_GE(corrections.frame()->taken, 25);
  EXPECT_LE(corrections.frame()->taken, 30);
  EXPECT_EQ(corrections.frame()->refused, 3000 - corrections.frame()->taken);
}

}  // namespace
}  // namespace prospect::correction_test
