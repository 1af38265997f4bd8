// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/walkers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/simulator.h"
#include "tests/adapters/box_room.h"

namespace prospect::walkers_test {
namespace {

TEST(Walkers, WalkOnTheFloorAndKeepFromTheRobot) {
  World world = test::box_room(10.0, 8.0, 2.4);
  test::fill(world, {4.0, 0.0, 0.0}, {4.4, 5.0, 2.4});
  world.start.position = {1.0, 1.0, 0.0};
  constexpr double kDensity = 4.0;
  const WalkersOptions two{.count = 2};
  Walkers walkers(world, two, kDensity, world.start, 3),
      again(world, two, kDensity, world.start, 3);
  Walkers others(world, two, kDensity, world.start, 4);
  ASSERT_GE(walkers.walkers().size(), 4U);
  double walked = 0.0;
  for (const Walker& walker : walkers.walkers()) {
    EXPECT_GE((walker.at - world.start.position.head<2>()).norm(), 2.0);
  }
  // The robot crosses the room while they walk.
  Pose robot = world.start;
  for (int n = 1; n <= 600; ++n) {
    const std::vector<Walker> before(walkers.walkers().begin(), walkers.walkers().end());
    robot.position.y() = 1.0 + 3.0 * (1.0 - std::cos(0.01 * n));
    const Eigen::Vector2d middle = robot.position.head<2>();
    for (Walkers* all : {&walkers, &again, &others}) all->advance(0.1 * n, robot);
    for (std::size_t k = 0; k < before.size(); ++k) {
      const Eigen::Vector2d at = walkers.walkers()[k].at;
      const double step = (at - before[k].at).norm();
      EXPECT_LE(step, 0.121);
      walked += step;
      EXPECT_TRUE(walkers.walkable(at)) << at.transpose();
      if ((at - middle).norm() < 0.9) {
        EXPECT_GE((at - middle).norm(), (before[k].at - middle).norm() - 1e-9)
            << "so near, nobody comes nearer";
      }
    }
  }
  EXPECT_GT(walked, 20.0 * static_cast<double>(walkers.walkers().size()));
  EXPECT_EQ(walkers.walkers()[0].at, again.walkers()[0].at);
  EXPECT_NE(walkers.walkers()[0].at, others.walkers()[0].at);
  EXPECT_TRUE(Walkers(world, {}, 0.0, world.start, 3).walkers().empty());
}

TEST(Walkers, RaysMeetTheirBodies) {
  const std::vector<Walker> two = {{{3.0, 0.0}, 0.0}, {{5.0, 0.05}, M_PI / 2.0}};
  const auto ahead = [&](double y, double z) {
    return distance_to_walkers(two, {0.0, y, z}, Eigen::Vector3d::UnitX());
  };
  EXPECT_NEAR(ahead(0.0, 1.2), 3.0 - 0.12, 1e-6) << "the trunk";
  EXPECT_NEAR(ahead(0.1, 0.4), 3.0 - 0.09, 1e-6) << "a leg";
  EXPECT_NEAR(ahead(0.0, 0.4), 5.0 - 0.18, 1e-6) << "between the legs of one, a leg of the next";
  EXPECT_TRUE(std::isinf(ahead(0.0, 1.9))) << "above them";
  EXPECT_TRUE(std::isinf(ahead(1.0, 0.4))) << "beside them";
  EXPECT_TRUE(std::isinf(distance_to_walkers(two, {6.0, 0.0, 1.2}, Eigen::Vector3d::UnitX())));
}

TEST(Walkers, ADepthSensorSeesThemAndNotWhatIsBehind) {
  World world = test::box_room(8.0, 6.0, 2.4);
  world.start.position = {1.0, 3.0, 0.0};
  DepthCameraOptions options;
  options.dropout = 0.0;
  const std::vector<Walker> somebody = {{{3.0, 3.0}, 0.0}};
  const auto nearest = [&](std::span<const Walker> walkers, int* free) {
    DepthCamera camera(world, options, CameraMount(), 1);
    std::vector<CellState> seen(world.voxels.data().size(), CellState::kUnknown);
    const DepthScan scan = camera.sense(world.start, &seen, nullptr, walkers);
    *free = static_cast<int>(std::count(seen.begin(), seen.end(), CellState::kFree));
    double least = 10.0;
    for (const Eigen::Vector3d& hit : scan.hits) {
      if (hit.z() > 0.1 && std::abs(hit.y()) < 0.1) least = std::min(least, hit.x());
    }
    return least;
  };
  int free = 0, free_with = 0;
  EXPECT_GT(nearest({}, &free), 3.0);
  EXPECT_NEAR(nearest(somebody, &free_with), 2.0 - 0.12, 0.05);
  EXPECT_LT(free_with, 0.95 * free);
}

/// In a corridor 1 m wide, where nobody passes anybody.
std::shared_ptr<const World> corridor() {
  World world = test::box_room(9.0, 1.2, 2.4);
  world.start.position = {1.0, 0.6, 0.0};
  return std::make_shared<const World>(world);
}

SimulatorOptions with_walkers(double keep) {
  SimulatorOptions options;
  options.walkers = {.count = 1, .keep = keep};
  options.seed = 2;
  return options;
}

TEST(Walkers, WhoMovesIntoTheOtherIsToBlame) {
  // The robot drives on, whoever stands before it.
  Simulator drives(corridor(), with_walkers(1.0));
  Twist ahead;
  ahead.linear.x() = 0.8;
  drives.apply(ahead, 9.0);
  EXPECT_EQ(drives.collisions(), 1);
  EXPECT_EQ(drives.bumps(), 0) << "who keeps a metre runs into nobody";
  ASSERT_EQ(drives.walkers().size(), 1U);
  EXPECT_LT(drives.true_pose().position.x(), drives.walkers()[0].at.x());
  // The robot stands, and they do not care.
  Simulator stands(corridor(), with_walkers(0.0));
  stands.apply(Twist(), 60.0);
  EXPECT_EQ(stands.collisions(), 0);
  EXPECT_GE(stands.bumps(), 1);
  EXPECT_GT((stands.walkers()[0].at - stands.true_pose().position.head<2>()).norm(), 0.3);
  Simulator again(corridor(), with_walkers(0.0));
  again.apply(Twist(), 60.0);
  EXPECT_EQ(again.walkers()[0].at, stands.walkers()[0].at);
}

}  // namespace
}  // namespace prospect::walkers_test
