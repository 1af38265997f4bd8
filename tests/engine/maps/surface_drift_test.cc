// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/surface_drift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "tests/engine/obstacle_worlds.h"

namespace prospect::surface_drift_test {
namespace {

using test::ObstacleWorld;

/// A room of 4 x 4 m with walls of one cell; the robot looks along its x axis from 0.45 m.
ObstacleWorld room() {
  ObstacleWorld world(0.1, 3.0);
  for (int a = -20; a < 20; ++a) {
    world.occupy_column(a, -20);
    world.occupy_column(a, 19);
    world.occupy_column(-20, a);
    world.occupy_column(19, a);
  }
  return world;
}

Belief belief_at(const ObstacleWorld& world, double x, double y, double yaw, double variance) {
  Belief belief = world.belief();
  belief.pose = {{x, y, 0.0}, yaw};
  belief.covariance(0, 0) = belief.covariance(1, 1) = variance;
  return belief;
}

constexpr Cell kEast{19, 0}, kWest{-20, 0}, kNorth{0, 19};

TEST(SurfaceDrift, IsTheGrowthOfTheVarianceSinceASurfaceWasInView) {
  const ObstacleWorld world = room();
  const RobotDescription robot;
  SurfaceDrift drift;
  EXPECT_EQ(drift.sigma(kEast), 0.0);
  EXPECT_EQ(drift.sigma_near({0.0, 0.0}, 3.0), 0.0);

  drift.update(belief_at(world, 0.0, 0.0, 0.0, 0.01), robot);
  EXPECT_EQ(drift.sigma(kEast), 0.0);
  drift.update(belief_at(world, 0.0, 0.0, M_PI, 0.0344), robot);
  // Off by what came since, not by what was there before.
  EXPECT_NEAR(drift.sigma(kEast), std::sqrt(0.0244), 1e-6);
  EXPECT_EQ(drift.sigma(kWest), 0.0);
  EXPECT_EQ(drift.sigma(kNorth), 0.0) << "never in view: counts as seen now";

  // Looked at again, it is where the map has it.
  drift.update(belief_at(world, 0.0, 0.0, 0.0, 0.05), robot);
  EXPECT_EQ(drift.sigma(kEast), 0.0);
  EXPECT_NEAR(drift.sigma(kWest), std::sqrt(0.05 - 0.0344), 1e-6);
}

// What was measured has moved in W: what is known of how far it may be off goes with it.
TEST(SurfaceDrift, FollowsACorrection) {
  const ObstacleWorld world = room();
  const RobotDescription robot;
  for (const double told : {-1.0, 0.0004}) {
    SurfaceDrift drift;
    drift.update(belief_at(world, 0.0, 0.0, 0.0, 0.01), robot);
    drift.update(belief_at(world, 0.0, 0.0, M_PI, 0.05), robot);
    ASSERT_NEAR(drift.sigma(kEast), 0.2, 1e-6);
    const PlanarMove up{Eigen::Vector2d(0.0, 0.3), 0.0};
    drift.follow(PlaceMoves(std::vector<PlaceMoves::Known>{{Eigen::Vector2d(0.0, 0.0), up, told}}));
    // The covariance falls at the same belief.
    drift.update(belief_at(world, 0.0, 0.0, M_PI, 0.002), robot);
    const double expected = told < 0.0 ? 0.2 : 0.02;
    EXPECT_NEAR(drift.sigma({19, 3}), expected, 1e-6) << "now there";
    EXPECT_EQ(drift.sigma(kWest), 0.0) << "in view";
    drift.update(belief_at(world, 0.0, 0.0, M_PI, 0.0029), robot);
    EXPECT_NEAR(drift.sigma({19, 3}), std::hypot(expected, 0.03), 1e-6) << "grows on";
  }
}

// A map that follows the robot, or is projected anew, must not make all that it holds seem seen.
TEST(SurfaceDrift, AMapThatShrinksOrMovesKeepsWhatWasSeenWhen) {
  const ObstacleWorld world = room();
  const RobotDescription robot;
  const auto cut = [](Belief belief, GridFrame frame) {
    auto ground = std::make_shared<GroundMap>(frame);
    for (int k = 0; k < frame.size(); ++k) {
      const Cell c = frame.at(k);
      ground->set(c, belief.ground->state(c), belief.ground->see_through(c));
    }
    belief.ground = std::move(ground);
    return belief;
  };
  SurfaceDrift drift;
  drift.update(belief_at(world, 0.0, 0.0, 0.0, 0.01), robot);
  for (const int shift : {0, 16, -32, 5}) {
    drift.update(cut(belief_at(world, 0.0, 0.0, M_PI, 0.05), {0.1, shift - 40, -48, 96, 96}),
                 robot);
    EXPECT_NEAR(drift.sigma(kEast), 0.2, 1e-6) << shift;
  }
}

TEST(SurfaceDrift, AllRoundEverythingIsInView) {
  const ObstacleWorld world = room();
  for (const auto& [fov, behind] : {std::pair{2.0 * M_PI, true}, {1.5 * M_PI, false}}) {
    RobotDescription robot;
    robot.depth.horizontal_fov = fov;
    SurfaceDrift drift;
    drift.update(belief_at(world, 0.0, 0.0, M_PI, 0.0), robot);
    drift.update(belief_at(world, 0.0, 0.0, 0.0, 0.0), robot);
    drift.update(belief_at(world, 0.0, 0.0, 0.0, 0.04), robot);
    EXPECT_EQ(drift.sigma(kEast), 0.0);
    EXPECT_EQ(drift.sigma(kNorth), 0.0);
    EXPECT_NEAR(drift.sigma(kWest), behind ? 0.0 : 0.2, 1e-6);
  }
}

TEST(SurfaceDrift, WhatWasMappedWhileLostIsOffOnceThePoseIsFoundAgain) {
  const ObstacleWorld world = room();
  const RobotDescription robot;
  SurfaceDrift drift;
  drift.update(belief_at(world, 0.0, 0.0, 0.0, 0.09), robot);
  drift.update(belief_at(world, 0.0, 0.0, M_PI, 0.01), robot);
  EXPECT_NEAR(drift.sigma(kEast), std::sqrt(0.08), 1e-6);
}

TEST(SurfaceDrift, FreeSpaceIsRememberedAsSurfacesAre) {
  ObstacleWorld world = room();
  for (int j = -5; j <= 5; ++j) world.occupy_column(10, j);  // a screen
  const RobotDescription robot;
  constexpr Cell kAhead{8, 0}, kBefore{1, 0}, kShadow{15, 0}, kBehind{-8, 0};
  SurfaceDrift drift;
  for (const double yaw : {0.0, M_PI}) {
    drift.update(belief_at(world, 1.5, 0.0, yaw, 0.0), robot);
    drift.update(belief_at(world, 0.0, 0.0, yaw, 0.0), robot);
  }
  drift.update(belief_at(world, 0.0, 0.0, 0.0, 0.04), robot);
  EXPECT_EQ(drift.sigma(kAhead), 0.0);
  EXPECT_LT(0.1, robot.depth.min_range);
  EXPECT_EQ(drift.sigma(kBefore), 0.0) << "what is seen behind it shows that nothing is there";
  EXPECT_NEAR(drift.sigma(kShadow), 0.2, 1e-6);
  EXPECT_NEAR(drift.sigma(kBehind), 0.2, 1e-6);
}

// The covariance that odometry reports is against the start of the mission. With a yaw that is off
// by what it was off at first, the position's grows with every metre, while the map near the robot,
// turned as it is, stays where it is.
TEST(SurfaceDrift, AnErrorThatTheMapSharesIsNoDrift) {
  const ObstacleWorld world = room();
  const RobotDescription robot;
  const double yaw_variance = 0.04;
  const auto at = [&](double x, double y, double yaw, const Eigen::Matrix3d& added) {
    Belief belief = world.belief();
    belief.pose = {{x, y, 0.0}, yaw};
    Eigen::Matrix3d F = Eigen::Matrix3d::Identity();  // from the origin
    F(0, 2) = -y;
    F(1, 2) = x;
    const Eigen::Matrix3d P =
        F * Eigen::Vector3d(0.0, 0.0, yaw_variance).asDiagonal() * F.transpose() + added;
    const Eigen::Vector3i planar(0, 1, 3);
    belief.covariance(planar, planar) = P;
    return belief;
  };
  SurfaceDrift drift;
  drift.update(at(-1.0, 0.3, M_PI, Eigen::Matrix3d::Zero()), robot);
  drift.update(at(-1.5, 0.3, 0.0, Eigen::Matrix3d::Zero()), robot);
  drift.update(at(1.5, -0.5, 0.0, Eigen::Matrix3d::Zero()), robot);
  for (const Cell c : {kEast, kWest, kNorth, Cell{0, 0}}) EXPECT_NEAR(drift.sigma(c), 0.0, 1e-6);
  // A turn on the spot that adds to the error of the yaw: what is far off is displaced.
  const double turned = 0.0025;
  drift.update(at(1.5, -0.5, 0.5, Eigen::Vector3d(0.0, 0.0, turned).asDiagonal()), robot);
  const auto distance = [&](Cell c) {
    return (world.ground.frame().center(c) - Eigen::Vector2d(1.5, -0.5)).norm();
  };
  for (const Cell c : {kWest, Cell{13, -8}}) {
    EXPECT_NEAR(drift.sigma(c), std::sqrt(0.5 * turned) * distance(c), 1e-6);
  }
}

TEST(SurfaceDrift, NearCountsOccupiedCellsWithinTheRadius) {
  const ObstacleWorld world = room();
  const RobotDescription robot;
  SurfaceDrift drift;
  drift.update(belief_at(world, 0.0, 0.0, 0.0, 0.0), robot);
  drift.update(belief_at(world, 0.0, 0.0, M_PI, 0.01), robot);
  // The wall's cells have their centres at x = 1.95.
  EXPECT_NEAR(drift.sigma_near({1.45, 0.05}, 0.51), 0.1, 1e-6);
  EXPECT_EQ(drift.sigma_near({1.45, 0.05}, 0.49), 0.0);
  EXPECT_EQ(drift.sigma_near({-1.45, 0.05}, 0.51), 0.0);
  EXPECT_EQ(drift.sigma_near({500.0, -500.0}, 0.51), 0.0) << "beyond the map";
}

TEST(SurfaceDrift, WhatIsHiddenOrOutOfTheFieldOfViewIsNotInView) {
  ObstacleWorld world = room();
  for (int j = -5; j <= 5; ++j) world.occupy_column(10, j);  // a screen before the east wall
  const RobotDescription robot;
  SurfaceDrift drift;
  for (const double yaw : {0.0, M_PI}) {  // all but the screen's shadow is in view once
    drift.update(belief_at(world, 1.5, 0.0, yaw, 0.0), robot);
  }
  drift.update(belief_at(world, 0.0, 0.0, 0.0, 0.04), robot);
  EXPECT_EQ(drift.sigma({10, 0}), 0.0);
  EXPECT_NEAR(drift.sigma(kEast), 0.2, 1e-6) << "behind the screen";
  EXPECT_NEAR(drift.sigma(kWest), 0.0, 1e-6) << "hidden by the screen from the first place, too";
  // At 1.95 m, half the field of view of 1.22 rad ends 1.36 m to the side.
  const Cell beside{19, 15};
  ASSERT_GT(std::atan2(1.55, 1.95), 0.5 * robot.depth.horizontal_fov);
  drift.update(belief_at(world, 1.5, 1.55, 0.0, 0.04), robot);
  ASSERT_EQ(drift.sigma(beside), 0.0);
  drift.update(belief_at(world, 0.0, 0.0, 0.0, 0.08), robot);
  EXPECT_NEAR(drift.sigma(beside), 0.2, 1e-6);
}

TEST(SurfaceDrift, ALowObstacleIsSeenFromAfarOnlyAndOverIt) {
  ObstacleWorld world = room();
  world.voxels.set(8, 0, 1, CellState::kOccupied);
  world.ground.set({8, 0}, CellState::kOccupied, true);
  const RobotDescription robot;
  const double near = 0.45 / std::tan(0.5 * robot.depth.vertical_fov);  // where the floor comes in
  SurfaceDrift drift;
  drift.update(belief_at(world, 0.85 - near - 0.1, 0.05, 0.0, 0.01), robot);
  drift.update(belief_at(world, 0.85 - near + 0.1, 0.05, 0.0, 0.02), robot);
  EXPECT_NEAR(drift.sigma({8, 0}), 0.1, 1e-6);
  EXPECT_EQ(drift.sigma(kEast), 0.0) << "seen over it";
  drift.update(belief_at(world, 0.85 - near - 0.1, 0.05, 0.0, 0.03), robot);
  EXPECT_EQ(drift.sigma({8, 0}), 0.0);
}

TEST(SurfaceDrift, FollowsTheGrowingMap) {
  const RobotDescription robot;
  SurfaceDrift drift;
  drift.update(belief_at(room(), 0.0, 0.0, 0.0, 0.0), robot);
  ObstacleWorld wide = room();
  for (int i = 30; i < 80; ++i) wide.ground.set({i, 0}, CellState::kFree);
  ASSERT_GT(wide.ground.frame().width, room().ground.frame().width);
  drift.update(belief_at(wide, 0.0, 0.0, M_PI, 0.01), robot);
  EXPECT_NEAR(drift.sigma(kEast), 0.1, 1e-6);
  // Another map begins anew.
  ObstacleWorld other(0.05, 1.0);
  other.occupy_column(10, 0);
  drift.update(belief_at(other, 0.0, 0.0, 0.0, 0.04), robot);
  EXPECT_EQ(drift.sigma_near({0.0, 0.0}, 2.0), 0.0);
}

// A covariance that was no number counted as zero growth: walls that nobody looked at were exact.
TEST(SurfaceDrift, WithoutACovarianceNothingOutOfViewIsWhereItWas) {
  const ObstacleWorld world = room();
  const RobotDescription robot;
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity, -1.0}) {
    SurfaceDrift drift;
    drift.update(belief_at(world, 0.0, 0.0, 0.0, 0.01), robot);
    drift.update(belief_at(world, 0.0, 0.0, M_PI, bad), robot);
    EXPECT_EQ(drift.sigma(kEast), infinity);
    EXPECT_EQ(drift.sigma(kNorth), infinity) << "never in view";
    EXPECT_EQ(drift.sigma(kWest), 0.0) << "in view now";
    EXPECT_EQ(drift.sigma_near({0.0, 0.0}, 3.0), infinity);
    // With a covariance again, what was seen before is off by what came since.
    drift.update(belief_at(world, 0.0, 0.0, M_PI, 0.05), robot);
    EXPECT_NEAR(drift.sigma(kEast), 0.2, 1e-6);
    EXPECT_EQ(drift.sigma(kWest), 0.0);
    // Not so what was seen without one.
    drift.update(belief_at(world, 0.0, 0.0, 0.0, bad), robot);
    drift.update(belief_at(world, 0.0, 0.0, M_PI, 0.05), robot);
    EXPECT_EQ(drift.sigma(kEast), infinity);
    drift.update(belief_at(world, 0.0, 0.0, 0.0, 0.05), robot);
    EXPECT_EQ(drift.sigma(kEast), 0.0);
  }
}

}  // namespace
}  // namespace prospect::surface_drift_test
