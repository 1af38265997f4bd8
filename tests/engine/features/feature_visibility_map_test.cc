// SPDX-License-Identifier: Apache-2.0
#include "engine/features/feature_visibility_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "engine/features/landmark_selection.h"
#include "models/make_model.h"
#include "tests/engine/room_belief.h"

namespace prospect::feature_visibility_map_test {
namespace {

using test::Room;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

RobotDescription robot() {
  RobotDescription robot;
  robot.model = make_model("unicycle");
  return robot;
}

FeatureVisibilityMap visibility_map(const FeatureVisibilityMapOptions& options = {}) {
  return FeatureVisibilityMap(options, robot(), with_redetected_landmarks());
}

// One place and heading: every landmark's probability, and a ray to it.
double slow(const Belief& belief, Cell c, double yaw) {
  const RobotDescription r = robot();
  const std::vector<Landmark>& landmarks = belief.landmarks->landmarks;
  const VisibilityPrediction prediction(landmarks, r.stereo, r.stereo_mount, nullptr,
                                        with_redetected_landmarks());
  Pose pose = belief.pose;
  pose.position.head<2>() = belief.ground->frame().center(c);
  pose.yaw = yaw;
  const Eigen::VectorXd visible = prediction.probabilities(pose);
  Eigen::Vector3d eye = prediction.sensor_position(pose);
  eye.head<2>() = pose.position.head<2>();
  double sum = 0.0;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const VoxelGrid::Ray ray = belief.voxels->cast(eye, landmarks[i].position, 0.15);
    if (!ray.blocked) {
      sum += visible[static_cast<Eigen::Index>(i)] * std::exp(-0.3 * ray.unknown_length);
    }
  }
  return sum;
}

TEST(FeatureVisibilityMap, CountsWhatIsInViewFromTheMiddleOfABlock) {
  const Belief belief = Room{.landmarks_per_wall = 60}.belief();
  FeatureVisibilityMap seen = visibility_map({.blocks_per_update = 100000});
  seen.update(belief, 0.0);
  double least = kInfinity, most = 0.0;
  // Blocks of 5 cells: their middle is a cell.
  for (const Cell c : {Cell{2, 2}, Cell{-3, -8}, Cell{22, 12}, Cell{7, 7}, Cell{22, -13}}) {
    for (int k = 0; k < FeatureVisibilityMap::kHeadings; ++k) {
      const double yaw = 2.0 * std::numbers::pi * k / FeatureVisibilityMap::kHeadings;
      const double expected = slow(belief, c, yaw);
      EXPECT_NEAR(seen.count(c, yaw), expected, 1e-3 * expected + 0.7)
          << c.i << ' ' << c.j << ' ' << k;
      EXPECT_NEAR(seen.count(c, yaw - 4.0 * std::numbers::pi), seen.count(c, yaw), 1e-4);
      EXPECT_EQ(seen.count({c.i + 2, c.j - 2}, yaw), seen.count(c, yaw)) << "the same block";
      const double half = std::numbers::pi / FeatureVisibilityMap::kHeadings;
      EXPECT_NEAR(seen.count(c, yaw + half),
                  0.5 * (seen.count(c, yaw) + seen.count(c, yaw + 2.0 * half)), 1e-4);
      least = std::min(least, expected);
      most = std::max(most, expected);
    }
  }
  EXPECT_LT(least, 3.0);
  EXPECT_GT(most, 20.0);
}

TEST(FeatureVisibilityMap, UnknownGroundBearsFeaturesAheadOfAFrontier) {
  const Belief belief = Room{.landmarks_per_wall = 0}.belief();
  FeatureVisibilityMap seen = visibility_map({.blocks_per_update = 100000});
  seen.update(belief, 20.0);
  EXPECT_GT(seen.count({22, 2}, 0.0), 5.0);
  EXPECT_LT(seen.count({22, 2}, std::numbers::pi), 0.2 * seen.count({22, 2}, 0.0));
}

TEST(FeatureVisibilityMap, TakesTurnsAndTheNearComeFirst) {
  const Belief belief = Room{.landmarks_per_wall = 20}.belief();
  FeatureVisibilityMap seen = visibility_map({.blocks_per_update = 8});
  EXPECT_EQ(seen.count({2, 2}, 0.0), kInfinity) << "nothing was counted yet";
  seen.update(belief, 0.0);
  EXPECT_LT(seen.count({2, 2}, 0.0), kInfinity);
  EXPECT_EQ(seen.count({22, 12}, 0.0), kInfinity);
  for (int n = 0; n < 20; ++n) seen.update(belief, 0.0);
  FeatureVisibilityMap whole = visibility_map({.blocks_per_update = 100000}), shared = whole;
  whole.update(belief, 0.0);
  WorkerThreads workers(3);
  shared.update(belief, 0.0, nullptr, &workers);
  for (int i = -9; i < 29; ++i) {
    for (int j = -19; j < 19; ++j) {
      ASSERT_EQ(seen.count({i, j}, 1.0), whole.count({i, j}, 1.0)) << i << ' ' << j;
      ASSERT_EQ(shared.count({i, j}, 1.0), whole.count({i, j}, 1.0)) << i << ' ' << j;
    }
  }
  EXPECT_EQ(seen.count({200, 200}, 0.0), kInfinity) << "beyond the map";
  EXPECT_EQ(seen.count({2, 2}, std::nan("")), kInfinity);
}

TEST(FeatureVisibilityMap, FollowsTheMap) {
  FeatureVisibilityMap seen = visibility_map();
  seen.update(test::empty_belief(), 5.0);
  EXPECT_EQ(seen.count({2, 2}, 0.0), kInfinity);
  for (int n = 0; n < 5; ++n) seen.update(Room{.seen = 1.0}.belief(), 0.0);
  EXPECT_EQ(seen.count({2, 2}, M_PI / 2), 0.0);
  EXPECT_EQ(seen.count({22, 12}, 0.0), kInfinity);
  for (int n = 0; n < 10; ++n) {
    seen.update(Room{.seen = 3.0, .landmarks_per_wall = 60}.belief(), 0.0);
  }
  EXPECT_GT(seen.count({2, 2}, M_PI / 2), 5.0);
  EXPECT_LT(seen.count({22, 12}, 0.0), kInfinity);
}

TEST(FeatureVisibilityMap, RefusesOptionsOutOfRange) {
  EXPECT_THROW(visibility_map({.block = 0.0}), std::invalid_argument);
  EXPECT_THROW(visibility_map({.blocks_per_update = 0}), std::invalid_argument);
  EXPECT_THROW(visibility_map({.max_landmarks = 0}), std::invalid_argument);
  EXPECT_THROW(visibility_map({.prior_range = -1.0}), std::invalid_argument);
  EXPECT_THROW(visibility_map({.attenuation = std::nan("")}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::feature_visibility_map_test
